#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "client/render/compute_launch.h"
#include "client/render/draw_costs.h"
#include "client/render/gpu_tiles.h"
#include "client/render/overlay_pass.h"
#include "client/render/raster_launch.h"
#include "client/render/shadow_pass.h"
#include "client/render/sky_table.h"
#include "common/draw_node.h"
#include "common/tiling.h"
#include "common/units.h"

namespace terray {

/// Who filters photos anisotropically.
enum class PhotoFilter : uint8_t {
    automatic,  ///< probes on Mesa's software rasterisers, whose texture units take 10 times as long, else hardware
    hardware,   ///< the texture units: textureGrad with GL_TEXTURE_MAX_ANISOTROPY
    probes,     ///< the resolve shader, by the same formula
};

/// How rays get onto the GPU. Both launches draw the same picture.
enum class Launch : uint8_t {
    automatic,  ///< whichever is faster in a short calibration on the first frame
    raster,     ///< boxes rasterised, fragments march (paper 001)
    compute,    ///< dispatches only; for GPUs whose fragment stage is small
};
[[nodiscard]] std::string_view name(Launch launch);

/// What is drawn between samples.
enum class Surface : uint8_t {
    automatic,  ///< node by node: bilinear where a sample is larger than a pixel, else columns
    columns,    ///< piecewise constant (paper 001)
    bilinear,   ///< patches between sample centres (paper 000, section 3.7)
};

/// Light, surface and filtering of a frame.
struct RenderOptions {
    /// Towards the sun, world frame, any length > 0. The default is 40 degrees high in the north-west, as maps are
    /// shaded.
    glm::dvec3 sunDirection{-0.5417, 0.5417, 0.6428};
    float anisotropy = 16;  ///< 1..16, of photo sampling
    PhotoFilter photoFilter = PhotoFilter::automatic;
    double nearMetres = 0.1;         ///< view depth that depth value 1 stands for; hits nearer count as it
    Launch launch = Launch::raster;  ///< methods that rasterise geometry are drawn by the raster launch alone
    bool occlusion = true;           ///< raster launch: the tile-ID pass (paper 001, section 3.4)
    Surface surface = Surface::automatic;
    MethodOptions method;                ///< that of GpuTilesOptions, where the method keeps something of each tile
    std::optional<DrawCosts> drawCosts;  ///< Method::hybrid needs them, see draw_calibration.h
    /// The sky of the sun's elevation, and its light on the ground; off: a gradient, and light as under a sun at 40
    /// degrees. Heights count from the sea (z = 0).
    bool sky = false;
    /// Aerial perspective: how far a black mountain at sea level is still told from the sky. None: clear as glass.
    std::optional<Metres> visualRange;
    std::optional<ShadowOptions> shadows;  ///< none: the sun shines through hills
    ShadingOptions shading;                ///< modes that show steps need FeatureSet::statistics of the targets
};

/// Draws lists of nodes by ray casting (paper 001, section 3): a march of each pixel's ray through the nodes, front to
/// back, by either launch, then one resolve pass over the screen.
///
/// GL thread only. Programs are compiled on first use of a feature set and kept.
class TerrainRenderer {
  public:
    TerrainRenderer(const ShaderLibrary& shaders, const Tiling& tiling);

    /// With Launch::automatic the first frame is also the calibration: it is drawn kCalibrationFrames times by each
    /// launch.
    /// @param nodes    front to back, every tile resident in `tiles` (misuse otherwise)
    /// @param casters  outside the picture, for shadow rays alone, likewise resident; no cell overlaps another's
    /// @param timer    told which pass runs; may be null
    void render(const View& view, std::span<const DrawNode> nodes, std::span<const DrawNode> casters,
                const GpuTiles& tiles, const RenderOptions& options, FrameTargets& targets, GpuTimer* timer);

    /// From now on draws these into each picture, in place of those given before; none: nothing is kept of them.
    void setOverlay(std::span<const OverlayMesh> meshes);

    /// What the calibration chose, and in milliseconds why.
    struct Calibration {
        Launch chosen = Launch::raster;
        double rasterMs = 0;
        double computeMs = 0;
    };
    /// None while nothing was drawn with Launch::automatic.
    [[nodiscard]] const std::optional<Calibration>& calibration() const { return calibration_; }
    /// Of each launch, the first one untimed.
    static constexpr int kCalibrationFrames = 4;

    /// Of the last frame.
    [[nodiscard]] size_t bilinearNodes() const { return bilinearNodes_; }
    /// Nodes of it that were rasterised as geometry.
    [[nodiscard]] size_t rasterisedNodes() const;

    /// Bytes of the node buffer, the sky's table and the like.
    [[nodiscard]] uint64_t bufferBytes() const;

  private:
    void calibrate(CastFrame frame, bool occlusion);
    Launch launchOf(const CastFrame& frame, const RenderOptions& options);
    void draw(const CastFrame& frame, Launch launch);
    void describeNodes(const View& view, std::span<const DrawNode> nodes, const GpuTiles& tiles,
                       const RenderOptions& options);
    void uploadFrame(const View& view, const RenderOptions& options);
    void makeSky(const View& view, const RenderOptions& options);
    void chooseRasterised(const View& view, std::span<const DrawNode> nodes, const GpuTiles& tiles,
                          const RenderOptions& options);
    void bindShading(const RenderOptions& options);
    void bindMethod(const MethodOptions& options, const GpuTiles& tiles);
    void bindTextures(const FrameTargets& targets, const GpuTiles& tiles, float anisotropy);

    const ShaderLibrary& shaders_;
    Tiling tiling_;
    bool softwareRasteriser_;
    RasterLaunch rasterLaunch_;
    ComputeLaunch computeLaunch_;
    std::optional<Calibration> calibration_;
    std::unique_ptr<ShadowPass> shadowPass_;  ///< from the first frame with shadows on
    ShadowOptions shadowOptions_;
    std::vector<DrawNode> drawn_;                 ///< of the last frame: nodes, then casters
    std::vector<interop::NodeParameters> nodes_;  ///< of these
    size_t bilinearNodes_ = 0;
    std::vector<uint8_t> rasterised_;  ///< CastFrame::rasterised of the last frame
    HybridChoice choice_;
    GlBuffer nodeBuffer_;
    GlBuffer frameBuffer_;
    GlSampler photoSampler_;
    std::unique_ptr<SkyTable> sky_;  ///< while RenderOptions::sky is on
    uint64_t nodeCapacity_ = 0;
    GlBuffer shadingBuffer_;                ///< from the first frame that needs it
    GlBuffer methodBuffer_;                 ///< likewise
    std::unique_ptr<OverlayPass> overlay_;  ///< none without meshes
};

}  // namespace terray
