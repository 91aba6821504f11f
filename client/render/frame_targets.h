#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "client/render/feature_set.h"
#include "client/render/gl_objects.h"
#include "common/grid.h"

namespace terray {

/// What only the raster launch draws into.
struct RasterTargets {
    GlTexture id;  ///< R32UI; none without the ID pass
    GlTexture depth;
    GlFramebuffer idFramebuffer;       ///< {id | depth}
    GlFramebuffer marchFramebuffer;    ///< {hit, node | depth}
    GlFramebuffer resolveFramebuffer;  ///< {colour, normal}
    uint64_t bytes = 0;
};

/// What only shadows are drawn into.
struct ShadowTargets {
    GlTexture sunLight;         ///< R8: the part of the sun that the ground sees
    GlTexture steps;            ///< R32UI; none without statistics
    GlFramebuffer framebuffer;  ///< {sunLight}
    uint64_t bytes = 0;
};

/// What only overlays are drawn into.
struct OverlayTargets {
    GlTexture depth;
    GlFramebuffer framebuffer;  ///< {colour | depth}
    uint64_t bytes = 0;
};

/// How colours leave the resolve pass.
enum class ColourFormat : uint8_t {
    srgb8,        ///< 8-bit sRGB, for PNG and the screen: GL_RGBA8 whose bytes the resolve pass has encoded
    linearFloat,  ///< linear half floats, for EXR
};

/// What a cell of FrameTargets::readSteps holds: the number of steps, and whether the ray ran out of them.
inline constexpr uint32_t kStepCountMask = 0x7fffffff;
inline constexpr uint32_t kOutOfStepsBit = 0x80000000;

/// The textures that a frame is drawn into. Sizes in pixels; row 0 of every texture is the BOTTOM of the picture (GL),
/// the read-back functions turn that round: row 0 of their grids is the top.
///
/// Reading back waits for the GPU; asking for what the features or the format leave out is misuse. GL thread only.
/// Throws Error(graphics) when the driver cannot make the framebuffers.
class FrameTargets {
  public:
    FrameTargets(int width, int height, const FeatureSet& features, ColourFormat format = ColourFormat::srgb8);

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    /// As given; linearColour follows the format.
    [[nodiscard]] const FeatureSet& features() const { return features_; }
    [[nodiscard]] uint64_t bytes() const {
        return bytes_ + (raster_ ? raster_->bytes : 0) + (shadow_ ? shadow_->bytes : 0) +
               (overlay_ ? overlay_->bytes : 0);
    }

    /// sRGB bytes, alpha 255; needs ColourFormat::srgb8.
    [[nodiscard]] Grid<std::array<uint8_t, 4>> readSrgb() const;
    /// Linear colour; needs ColourFormat::linearFloat.
    [[nodiscard]] Grid<glm::vec4> readLinear() const;
    /// Hit in the node's tile frame (x, y, z) and view depth t in metres (w).
    [[nodiscard]] Grid<glm::vec4> readHits() const;
    /// Index of the node hit plus 1; 0 is sky.
    [[nodiscard]] Grid<uint32_t> readNodes() const;
    /// The same of one pixel; column and row from the upper-left corner, inside the picture.
    [[nodiscard]] glm::vec4 readHit(int column, int row) const;
    [[nodiscard]] uint32_t readNode(int column, int row) const;
    /// Steps of the pixel's ray over all nodes (kStepCountMask), and kOutOfStepsBit. Needs FeatureSet::statistics.
    [[nodiscard]] Grid<uint32_t> readSteps() const;
    /// Steps of the pixel's shadow rays. Needs FeatureSet::statistics, and that the last frame had shadows.
    [[nodiscard]] Grid<uint32_t> readShadowSteps() const;
    /// The part of the sun that each pixel's ground sees, 0 .. 1; 1 for the sky. The last frame must have had shadows.
    [[nodiscard]] Grid<float> readSunLight() const;
    /// World normals (east, north, up), unit length, 0 where there is sky. Needs FeatureSet::normals.
    [[nodiscard]] Grid<glm::vec3> readNormals() const;

    // For the renderer. Textures of features that are off have no name.
    GlTexture hit, node, steps, normal, colour;
    /// Made on first use, and again when `occlusion` changes; kept until dropRaster().
    const RasterTargets& raster(bool occlusion);
    void dropRaster() { raster_.reset(); }
    /// Made on first use; kept until dropShadow().
    const ShadowTargets& shadow();
    void dropShadow() { shadow_.reset(); }
    /// Made on first use and kept.
    const OverlayTargets& overlay();

  private:
    int width_;
    int height_;
    FeatureSet features_;
    ColourFormat format_;
    uint64_t bytes_ = 0;  ///< of what does not depend on the launch
    std::unique_ptr<RasterTargets> raster_;
    std::unique_ptr<ShadowTargets> shadow_;
    std::unique_ptr<OverlayTargets> overlay_;
};

}  // namespace terray
