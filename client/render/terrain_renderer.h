#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "client/render/feature_set.h"
#include "client/render/frame_targets.h"
#include "client/render/gpu_tiles.h"
#include "client/render/gpu_timer.h"
#include "common/draw_node.h"
#include "common/tiling.h"
#include "common/view.h"

namespace terray {

/// Who filters photos anisotropically.
enum class PhotoFilter : uint8_t {
    automatic,  ///< probes on Mesa's software rasterisers, whose texture units take 10 times as long, else hardware
    hardware,   ///< the texture units: textureGrad with GL_TEXTURE_MAX_ANISOTROPY
    probes,     ///< the resolve shader, by the same formula
};

/// Light and filtering of a frame.
struct RenderOptions {
    /// Towards the sun, world frame, any length > 0. The default is 40 degrees high in the north-west, as maps are
    /// shaded.
    glm::dvec3 sunDirection{-0.5417, 0.5417, 0.6428};
    float anisotropy = 16;  ///< 1..16, of photo sampling
    PhotoFilter photoFilter = PhotoFilter::automatic;
    double nearMetres = 0.1;  ///< view depth that depth value 1 stands for; hits nearer count as it
    bool occlusion = true;    ///< the tile-ID pass (paper 001, section 3.4)
};

/// Draws lists of nodes by ray casting (paper 001, section 3): for each node front to back an ID pass and a march of
/// the maximum mipmap from the back faces of its box, then one resolve pass over the screen.
///
/// GL thread only. Programs are compiled on first use of a feature set and kept.
class TerrainRenderer {
  public:
    TerrainRenderer(const ShaderLibrary& shaders, const Tiling& tiling);
    ~TerrainRenderer();

    /// @param nodes  front to back, every tile resident in `tiles` (misuse otherwise)
    /// @param timer  told which pass runs; may be null
    void render(const View& view, std::span<const DrawNode> nodes, const GpuTiles& tiles, const RenderOptions& options,
                FrameTargets& targets, GpuTimer* timer);

    /// Bytes of the node buffer and the like.
    [[nodiscard]] uint64_t bufferBytes() const;

  private:
    struct Programs;
    /// What programs are compiled for.
    struct Variant {
        FeatureSet features;
        bool occlusion = true;
        bool photoProbes = false;
        auto operator<=>(const Variant&) const = default;
    };
    Programs& programsFor(const Variant& variant);
    void uploadFrame(const View& view, std::span<const DrawNode> nodes, const GpuTiles& tiles,
                     const RenderOptions& options);
    void castNodes(size_t count, const Programs& programs, const FrameTargets& targets, GpuTimer* timer);
    void resolve(const Programs& programs, const GpuTiles& tiles, float anisotropy, const FrameTargets& targets);

    const ShaderLibrary& shaders_;
    Tiling tiling_;
    bool softwareRasteriser_;
    std::map<Variant, std::unique_ptr<Programs>> programs_;
    GlBuffer nodeBuffer_;
    GlBuffer frameBuffer_;
    GlBuffer boxIndices_;
    GlVertexArray vertexArray_;
    GlSampler photoSampler_;
    uint64_t nodeCapacity_ = 0;
};

}  // namespace terray
