#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "common/reference/ground_caster.h"

namespace terray {

/// What a picture shows at a pixel.
struct DrawnPixel {
    bool ground = false;  ///< false: sky, the rest means nothing
    double depth = 0;     ///< metres along the view axis
    glm::dvec3 place{0};  ///< of the hit, world, metres; z a height, not exaggerated
};

/// A pixel against the truth of its centre.
struct PixelError {
    enum class Kind : uint8_t {
        ground,      ///< drawn and true: the numbers below are of these
        sky,         ///< drawn and true
        seeThrough,  ///< sky is drawn, there is ground
        coversSky,   ///< ground is drawn, there is none
        base,  ///< only one of both shows the side of the ground where it ends: how deep it is solid is a convention
    };
    Kind kind = Kind::sky;
    /// How far the drawn point is from the true surface, in pixels: the shorter of two ways, up or down to the ground
    /// at that place of the map, as it projects, and along the ray to where that meets the ground, at its full length.
    /// Beyond the ground's edge the first way goes to its side. (A point of a cliff, or of the ground's side, lies on
    /// the surface though the ground at its place is higher.)
    float pixels = 0;
    float depthMetres = 0;    ///< absolute difference of view depths
    float depthRelative = 0;  ///< the same over the true depth
    double trueDepth = 0;     ///< metres

    bool operator==(const PixelError&) const = default;
};

/// @param pixel  column and row from the top
[[nodiscard]] PixelError pixelError(const GroundCaster& truth, const View& view, const glm::ivec2& pixel,
                                    const DrawnPixel& drawn);

/// Of all those pixels, in their order, on all cores. @param drawn  one for each pixel
[[nodiscard]] std::vector<PixelError> pixelErrors(const GroundCaster& truth, const View& view,
                                                  std::span<const glm::ivec2> pixels,
                                                  std::span<const DrawnPixel> drawn);

/// The pixels of any number of pictures.
struct ErrorTotals {
    uint64_t pixels = 0;
    uint64_t seeThrough = 0;
    uint64_t coversSky = 0;
    std::vector<float> errorPixels;  ///< of those where ground is drawn and true; likewise the next two
    std::vector<float> depthMetres;
    std::vector<float> depthRelative;

    void add(std::span<const PixelError> errors);
};

}  // namespace terray
