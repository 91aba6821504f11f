#pragma once

#include <filesystem>

#include "client/engine/engine.h"
#include "client/view/arguments.h"
#include "client/view/view_settings.h"
#include "common/grid.h"
#include "common/json.h"
#include "common/rgba.h"

namespace terray {

/// A picture of a viewer, and how terray-view draws the same again: `terray-view --reproduce FILE.json --out
/// AGAIN.png`.
struct Snapshot {
    Grid<Rgba> picture;
    Json json;  ///< documented in client/README.md
};

/// What a snapshot is taken of.
struct SnapshotScene {
    const TileSource& source;
    const Projection* projection = nullptr;
    Arguments arguments;  ///< of the program, as given
    ViewSettings settings;
    glm::ivec2 size{0};  ///< of the picture
};

/// Draws with all tiles loaded, as --headless does, from the camera as its text tells it; the engine is left with other
/// options and another size than before. Throws Error(dataset) or Error(network) when tiles cannot be had.
[[nodiscard]] Snapshot takeSnapshot(Engine& engine, const Camera& camera, const SnapshotScene& scene);

/// The arguments that draw a snapshot again, from its JSON, without --out. Throws Error(input) when the file is missing
/// or none of a snapshot.
[[nodiscard]] Arguments reproducingArguments(const std::filesystem::path& path);

}  // namespace terray
