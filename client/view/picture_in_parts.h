#pragma once

#include <filesystem>
#include <optional>

#include "client/engine/engine.h"
#include "client/output/picture.h"
#include "client/stream/camera.h"

namespace terray {

/// Pictures of more pixels, or of a longer side, are drawn in parts unless told otherwise.
inline constexpr int64_t kMostPixelsAtOnce = int64_t{1} << 22;
inline constexpr int kLongestSideAtOnce = 4096;
/// Then a part is no larger than this: 33 MB on the GPU at 32 bytes a pixel, and rows of 33 MB for 16384 pixels of
/// width.
inline constexpr glm::ivec2 kPartSize{2048, 512};

/// A PNG of a camera's view with all tiles loaded, of any size, drawn part by part: the GPU holds the pixels of one
/// part at a time, main memory those of one row of parts. Its pixels are those of the picture in one piece (see
/// Engine::resizeToPart).
///
/// Where memory for tiles is too small for some part at full detail, all parts are drawn with what that one must give
/// up, so that no seam shows: the picture is then begun again. A picture in one piece needs the tiles of all parts at
/// once, so it may have to give up more. Given up before finished(), it leaves no file.
class PictureInParts {
  public:
    struct Options {
        glm::ivec2 size{1};
        /// Largest one, each side > 0; where it divides the picture rounded down to a multiple of 16, or 16. None: as
        /// large as suits the picture.
        std::optional<glm::ivec2> part;
    };
    /// @param engine  outlives this object, is left with another size and perhaps leastCoarsening; draws srgb8
    PictureInParts(Engine& engine, const Camera& camera, const std::filesystem::path& path, const Options& options);

    /// Draws a part, and writes what is whole. Not after finished(). Throws Error(dataset) or Error(network) when tiles
    /// cannot be had, Error(output).
    void drawNext();
    /// The file is there.
    [[nodiscard]] bool finished() const { return drawn_ == parts(); }
    [[nodiscard]] int parts() const { return grid_.x * grid_.y; }
    [[nodiscard]] int drawn() const { return drawn_; }
    /// Greatest numbers of any part's frame, and what all of them gave up.
    [[nodiscard]] const FrameReport& report() const { return report_; }

  private:
    void begin();
    [[nodiscard]] GridRect rectOf(int part) const;

    Engine& engine_;
    Camera camera_;
    std::filesystem::path path_;
    glm::ivec2 size_;
    glm::ivec2 part_;
    glm::ivec2 grid_;  ///< columns and rows of parts
    EngineOptions options_;
    FrameReport report_;
    int drawn_ = 0;
    Grid<Rgba> rows_;
    std::optional<PngWriter> file_;
};

}  // namespace terray
