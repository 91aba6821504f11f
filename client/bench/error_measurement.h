#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/bench/error_settings.h"
#include "client/bench/measured_frame.h"
#include "common/reference/dataset_heights.h"
#include "common/reference/ground_caster.h"

namespace terray {

/// What a setting came to.
struct ErrorResult {
    std::string curve;
    std::string name;
    std::vector<double> frameMs;  ///< of each repeat, the median over frames
    uint64_t pixels = 0;          ///< held against the truth
    uint64_t seeThrough = 0;
    uint64_t coversSky = 0;
    Spread errorPixels;  ///< see PixelError
    Spread depthMetres;
    Spread depthRelative;
    Spread flip;                 ///< over the frames' means
    std::optional<double> psnr;  ///< mean over frames that differ; none: all pictures are the reference's
    /// What changes in the picture from a frame to the next beside the motion: FLIP between the two, mean over the
    /// picture, less the same of the finest level. Over pairs; detail that pops in makes it greater, missing detail
    /// less.
    Spread popping;
    uint64_t nodes = 0;             ///< of all frames
    uint64_t lacking = 0;           ///< tiles that a frame wanted and memory did not hold, over all frames
    uint64_t gpuBytes = 0;          ///< allocated for tiles, at the end
    uint64_t pyramidBytes = 0;      ///< of these, maximum mipmaps
    uint64_t methodBytes = 0;       ///< of these, what the method keeps beside heights and pyramids
    double triangles = 0;           ///< drawn in a frame by methods that rasterise, mean
    double trianglesPerSecond = 0;  ///< of the timed frames, over their whole time
    double bytesPerTriangle = 0;    ///< that the method keeps; 0: of methods without a mesh of each tile's own
    double pyramidMs = 0;           ///< to make a height tile's maximum mipmap, mean
    double prepareMs = 0;           ///< to make what the method keeps of a tile, mean
};

/// The errors of a frame's pixels, for maps; all of its pixels.
using TakeErrors = std::function<void(const std::string& setting, int frame, const std::vector<PixelError>& errors)>;

/// Measures settings over frames of a flight: time, distance of each pixel from the finest samples (GroundCaster), and
/// of the picture from one of the same scene drawn with bilinear patches at a tolerance of 1/4 of a smaller pixel,
/// supersampled and averaged in linear light.
///
/// GL thread only; a context must be current. All references are borrowed.
class ErrorMeasurement {
  public:
    ErrorMeasurement(const TileSource& source, const ShaderLibrary& shaders, const Flight& flight,
                     const ErrorProtocol& protocol);

    /// Draws the reference pictures, and the finest level's pairs of frames; first of all, and again for other scenes
    /// (sun, photo). Throws as Engine does.
    void drawReferences(const EngineOptions& base);
    /// @param take  null: no maps. Not null: the protocol asks for all pixels.
    [[nodiscard]] ErrorResult measure(const ErrorSetting& setting, const TakeErrors& take);

  private:
    /// Of the frame that follows on the flight's clock; at its end, of the one before.
    [[nodiscard]] Camera cameraBeside(int frame) const;
    void time(Engine& engine, ErrorResult& result) const;

    const TileSource& source_;
    const ShaderLibrary& shaders_;
    const Flight& flight_;
    ErrorProtocol protocol_;
    DatasetHeights heights_;
    GroundCaster truth_;
    std::vector<Grid<Rgba>> references_;
    std::vector<double> finestChanges_;  ///< FLIP from each frame to the one beside it
};

}  // namespace terray
