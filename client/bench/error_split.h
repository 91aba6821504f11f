#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/bench/measured_frame.h"
#include "common/reference/dataset_heights.h"
#include "common/reference/ground_caster.h"

namespace terray {

/// What the ground of a picture is off by.
struct GroundError {
    uint64_t pixels = 0;  ///< held against the truth
    uint64_t seeThrough = 0;
    uint64_t coversSky = 0;
    Spread errorPixels;  ///< see PixelError
    Spread depthMetres;
};
[[nodiscard]] GroundError groundErrorOf(const ErrorTotals& totals);

/// What one cause of error does when all others are taken away. What is held against what for each cause is said in
/// client/README.md, "Causes of error".
struct CauseResult {
    std::string cause;
    std::optional<GroundError> ground;  ///< none: the cause leaves the ground alone
    std::optional<double> flip;         ///< mean over frames and pixels; none: not seen on pictures
    std::optional<double> psnr;         ///< dB; none: not measured, or no picture differs
};

/// Splits the error of a way to draw into its causes, over frames of a flight.
///
/// GL thread only; a context must be current. All references are borrowed.
class ErrorSplit {
  public:
    ErrorSplit(const TileSource& source, const ShaderLibrary& shaders, const Flight& flight,
               const ErrorProtocol& protocol, const EngineOptions& base);

    /// Takes as long as a dozen settings, and once the flight's duration for streaming. Throws as Engine does.
    [[nodiscard]] std::vector<CauseResult> measure();

  private:
    using Pictures = std::vector<Grid<Rgba>>;
    /// The base without any cause: bilinear patches of the finest level, best filter.
    [[nodiscard]] EngineOptions finest() const { return finestOf(base_, kFinestTolerance); }
    [[nodiscard]] Pictures supersampled(const EngineOptions& options) const;
    [[nodiscard]] std::vector<PixelError> errorsOf(const View& view, std::span<const DrawnPixel> drawn) const;
    void drawFinest(std::vector<CauseResult>& results);
    [[nodiscard]] CauseResult against(const Pictures& pictures, const std::string& cause,
                                      const EngineOptions& options) const;
    void stream(std::vector<CauseResult>& results) const;
    void compareSurfaces(std::vector<CauseResult>& results) const;

    static constexpr double kFinestTolerance = 0.01;  // pixels

    const TileSource& source_;
    const ShaderLibrary& shaders_;
    const Flight& flight_;
    ErrorProtocol protocol_;
    EngineOptions base_;
    std::vector<glm::ivec2> pixels_;
    DatasetHeights heights_;
    GroundCaster truth_;
    Pictures finestPictures_;
};

}  // namespace terray
