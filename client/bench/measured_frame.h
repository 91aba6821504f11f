#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "client/engine/engine.h"
#include "client/stream/flight.h"
#include "common/reference/picture_error.h"
#include "common/reference/pixel_error.h"

namespace terray {

// What measurements of errors do with a frame.

/// How errors are measured; two measurements compare only when all of it is the same.
struct ErrorProtocol {
    int width = 640;
    int height = 360;
    int frames = 8;               ///< spread evenly over the flight, ends included
    int64_t pixels = 20'000;      ///< of each frame held against the truth; 0: all
    int repeats = 5;              ///< of the timed frames, after one untimed round
    int supersampling = 2;        ///< of reference pictures, samples along a pixel's side
    double framesPerSecond = 30;  ///< of the flight: how far apart frames are that follow each other

    /// SIZE_MAX: all.
    [[nodiscard]] size_t pixelsLookedAt() const;
};

/// The time and the camera of a frame, 0 .. frames - 1.
[[nodiscard]] double secondsOf(const Flight& flight, const ErrorProtocol& protocol, int frame);
[[nodiscard]] Camera cameraOf(const Flight& flight, const ErrorProtocol& protocol, int frame);

/// Draws a frame with all of its tiles. Throws Error(dataset) when one could not be had: the figures would describe
/// another scene.
FrameReport drawWhole(Engine& engine, const Camera& camera);

/// What the last frame shows at these pixels, row 0 at the top.
[[nodiscard]] std::vector<DrawnPixel> drawnPixels(const Engine& engine, std::span<const glm::ivec2> pixels);

/// For GroundCaster: metres, just below the lowest ground, so that rays along it do not end by rounding.
[[nodiscard]] double floorBelow(const DatasetMetadata& metadata);

/// FLIP between two pictures, mean over pixels.
[[nodiscard]] double meanFlip(GridView<const Rgba> reference, GridView<const Rgba> test);

/// A picture of supersampling^2 pixels for each, averaged in linear light.
[[nodiscard]] Grid<Rgba> averaged(GridView<const Rgba> picture, int supersampling);

/// FLIP and PSNR of all frames.
class PictureTotals {
  public:
    void add(GridView<const Rgba> reference, GridView<const Rgba> test);
    /// Over the frames' means.
    [[nodiscard]] Spread flip() const { return spreadOf(flips_); }
    /// Mean over frames that differ; none: no frame does.
    [[nodiscard]] std::optional<double> psnr() const;

  private:
    std::vector<float> flips_;
    std::vector<double> ratios_;
};

/// Nothing is left out that the finest samples hold: bilinear, by the pyramid, tolerance of heights as given (pixels).
[[nodiscard]] EngineOptions finestOf(const EngineOptions& base, double tolerance);

}  // namespace terray
