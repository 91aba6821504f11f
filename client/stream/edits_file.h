#pragma once

#include <filesystem>

#include "common/json.h"
#include "common/projection.h"
#include "common/result.h"
#include "common/terrain_edit.h"

namespace terray {

/// A list of edits as client/README.md describes it. Fails with a sentence that names the edit and the member: missing,
/// unknown, of another kind or out of its range, a longitude and latitude that the projection does not have.
/// @param projection  of the dataset; null: only places in its own x and y can be read
[[nodiscard]] Result<EditList> editsFromJson(const Json& json, const Projection* projection);

/// Throws Error(input) when the file is missing or not as editsFromJson() asks.
[[nodiscard]] EditList loadEdits(const std::filesystem::path& path, const Projection* projection);

}  // namespace terray
