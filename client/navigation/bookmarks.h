#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "client/stream/camera.h"
#include "common/json.h"

namespace terray {

/// Cameras of one dataset under the keys 1 to 9.
struct Bookmarks {
    static constexpr int kCount = 9;
    std::array<std::optional<Camera>, kCount> cameras;  ///< bookmark n at n - 1
    bool operator==(const Bookmarks&) const = default;
};

/// JSON as documented in client/README.md: cameras in the dataset's coordinates, to 0.1 mm; in longitude and latitude
/// beside them, for people, when a projection is given.
[[nodiscard]] Json toJson(const Bookmarks& bookmarks, const Projection* projection);
/// Fails with a sentence on anything else.
[[nodiscard]] Result<Bookmarks> bookmarksFromJson(const Json& json);

/// None where there is no file. Throws Error(input) when it is no file of bookmarks.
[[nodiscard]] Bookmarks loadBookmarks(const std::filesystem::path& path);
/// Makes the folder when it is missing. Throws Error(output) when the file cannot be written.
void saveBookmarks(const Bookmarks& bookmarks, const std::filesystem::path& path, const Projection* projection);

}  // namespace terray
