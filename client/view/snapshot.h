#pragma once

#include <filesystem>
#include <optional>

#include "client/engine/engine.h"
#include "client/view/arguments.h"
#include "client/view/picture_in_parts.h"
#include "client/view/view_settings.h"
#include "common/json.h"

namespace terray {

/// What a snapshot is taken of.
struct SnapshotScene {
    const TileSource& source;
    const Projection* projection = nullptr;
    Arguments arguments;  ///< of the program, as given
    ViewSettings settings;
    glm::ivec2 size{0};              ///< of the picture
    std::optional<glm::ivec2> part;  ///< as in PictureInParts
};

/// A picture of a viewer as it is drawn part by part, and beside it the JSON by which terray-view draws the same again:
/// `terray-view --reproduce FILE.json --out AGAIN.png` (documented in client/README.md).
///
/// It is drawn with all tiles loaded, as --headless does, from the camera as its text tells it; the engine is left with
/// other options and another size than before. Given up before finished(), it leaves no file.
class Snapshot {
  public:
    /// @param path  of the PNG  @param engine  outlives this object
    Snapshot(Engine& engine, const Camera& camera, const SnapshotScene& scene, const std::filesystem::path& path);

    /// Draws a part; the last one writes the files. Throws as PictureInParts does.
    void drawNext();
    [[nodiscard]] bool finished() const { return picture_->finished(); }
    [[nodiscard]] int parts() const { return picture_->parts(); }
    [[nodiscard]] int drawn() const { return picture_->drawn(); }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
    Json json_;
    std::optional<PictureInParts> picture_;
};

/// The arguments that draw a snapshot again, from its JSON, without --out. Throws Error(input) when the file is missing
/// or none of a snapshot.
[[nodiscard]] Arguments reproducingArguments(const std::filesystem::path& path);

}  // namespace terray
