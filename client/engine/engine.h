#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/engine/earth.h"
#include "client/render/frame_targets.h"
#include "client/render/gpu_tiles.h"
#include "client/render/gpu_timer.h"
#include "client/render/terrain_renderer.h"
#include "client/stream/camera.h"
#include "client/stream/dataset_source.h"
#include "client/stream/pager.h"
#include "client/stream/selection.h"
#include "common/overlay_mesh.h"
#include "common/terrain_edit.h"
#include "common/utc_time.h"

namespace terray {

/// How the frame loop pages and draws. Every field is an option of terray-view and terray-bench.
struct EngineOptions {
    SelectionOptions selection;
    RenderOptions render;
    PagerOptions pager;
    EarthOptions earth;
    uint64_t gpuHeightBytes = 256ull << 20;
    uint64_t gpuImageryBytes = 256ull << 20;
    // Of one frame that does not wait for tiles. At least one tile is uploaded however small these are.
    uint64_t uploadBytesPerFrame = 16ull << 20;
    double uploadShare = 0.5;  ///< time for uploads, pyramids among it, over the time that the rest of a frame takes
    FeatureSet
        features;  ///< imagery: set by the engine, true when the dataset has some and selection.useImagery is set
    ColourFormat colour = ColourFormat::srgb8;
    std::filesystem::path drawCostsFile;  ///< of Method::hybrid, see draw_costs_file.h; unless render.drawCosts are set
    bool prefetch = true;                 ///< read ahead along the camera's motion, where frames do not wait for tiles
    bool measurePreparation = false;      ///< tiles().preparation(); frames then wait for the GPU at each upload
    double exaggeration = 1;              ///< of heights, see View; kLeastExaggeration .. kGreatestExaggeration
    /// The sun of this moment, over the camera's place in each frame; takes the place of render.sunDirection.
    std::optional<UtcTime> sunTime;
    std::vector<OverlayMesh> overlay;  ///< drawn into every picture
    EditList edits;                    ///< of the ground; valid()
};

/// What a frame did. Times in milliseconds, sizes in bytes.
struct FrameReport {
    double cpuMs = 0;    ///< of the render thread: selection, uploads, draw calls; no waiting for tiles or the GPU
    double waitMs = 0;   ///< the render thread stood still for tiles (waitForTiles only)
    double frameMs = 0;  ///< drawFrame() from start to end less waitMs; it ends when the GPU has finished
    std::array<double, kGpuPasses> gpuMs{};
    size_t nodes = 0;
    size_t bilinearNodes = 0;
    size_t rasterisedNodes = 0;   ///< drawn by geometry of the method
    uint64_t triangles = 0;       ///< drawn by methods that rasterise geometry, sides of boxes not counted
    double bytesPerTriangle = 0;  ///< that the method keeps of resident tiles; 0: it keeps no mesh of each tile's own
    size_t casters = 0;           ///< nodes outside the picture that may cast shadows into it
    size_t standIns = 0;          ///< nodes drawn from an ancestor of what was wanted
    size_t wanted = 0;            ///< tiles that the frame still lacked, failed ones among them
    Coarsening coarsening;        ///< of the tolerances, so that memory can hold what the view needs
    uint64_t hostBytes = 0;       ///< of tiles in main memory: held, on their way, and waiting for upload; each in full
    size_t uploadedTiles = 0;
    size_t editedTiles = 0;  ///< of the uploaded ones, those that edits change
    uint64_t uploadedBytes = 0;
    size_t residentHeights = 0;
    size_t residentImagery = 0;
    GpuTileBytes gpuTiles;
    uint64_t gpuTargets = 0;
    uint64_t gpuBuffers = 0;
    PagerStatistics pager;
    std::vector<std::string> failures;  ///< tiles that are damaged or missing, as sentences; told once, or at each try
    std::vector<std::string> unreachable;  ///< tiles that a server could not give for now; they are asked for again
};

/// For what is worth nothing with tiles missing: throws Error(dataset) when some are damaged, Error(network) when a
/// server could not give some. @param consequence  such as "the flight was broken off"
void requireAllTiles(const FrameReport& report, const std::string& consequence);

/// The frame loop that viewer and bench share: pager, tile tree, selection, uploads, renderer over one dataset.
///
/// GL thread only; a context must be current from construction to destruction.
class Engine {
  public:
    /// Loads the root tiles; they stay on the GPU for good. `source` and `shaders` must outlive the engine.
    /// Throws Error(dataset) when a root tile cannot be had, Error(graphics) when a shader does not compile; with a
    /// sun's time Error(georeference) when the dataset has no coordinate system, Error(unsupported) in a build without
    /// PROJ.
    /// @param part  as for resizeToPart(); none: all of the picture
    Engine(const TileSource& source, const ShaderLibrary& shaders, const EngineOptions& options, int width, int height,
           const std::optional<GridRect>& part = {});
    ~Engine();
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    /// Draws one frame into targets(). With waitForTiles it first loads until the selection for this camera is
    /// complete, or until budgets allow nothing more: then the picture depends only on the camera (and, when budgets
    /// are far too small, on what was drawn before), never on the order in which tiles arrive. It always ends: within
    /// one wait no tile is uploaded more than three times, a tile that failed is not asked for again, and where a
    /// server fails the wait ends with what there is (FrameReport::unreachable).
    FrameReport drawFrame(const Camera& camera, bool waitForTiles);
    /// The same for a view as it is, its earth and exaggeration included: also one that no camera has, with rays that
    /// are exactly vertical, say. The sun stays where it is.
    FrameReport drawView(const View& view, bool waitForTiles);

    /// Draws pictures of another size from the next frame on, over the earth that an engine of that size draws. Tiles
    /// stay.
    void resize(int width, int height);
    /// From the next frame on draws but a part of pictures of that size: the pixels that all of the picture would have
    /// there, byte by byte, since rays, levels of detail and patterns are the picture's. Two things may differ: where a
    /// triangle of the method mesh or of an overlay ends within rounding of a pixel's centre (measured: 2 of 39100
    /// pixels with mesh, none else); and photos with PhotoFilter::hardware, where the texture units filter groups of
    /// pixels together (Mesa's llvmpipe does: 3 to 5 % of the pixels). @param part  within the picture, rows from the
    /// top
    void resizeToPart(int width, int height, const GridRect& part);

    /// What the engine draws by, settled for its dataset.
    [[nodiscard]] const EngineOptions& options() const;
    /// From the next frame on pictures are drawn by the selection, render, earth, exaggeration, sunTime and
    /// features.statistics of these options; everything else stays as it was at construction. Photos cannot come where
    /// there were none then. Throws as the constructor does for a sun's time.
    void setOptions(const EngineOptions& options);

    /// From the next frame on heights, the camera's among them, are drawn multiplied by this. No tile is loaded anew;
    /// selection refines for the larger errors.
    void setExaggeration(double factor);

    /// Frozen, frames go on drawing the nodes of the last one, whatever the camera sees, and nothing is paged; edits
    /// wait. For looking at what was selected from elsewhere.
    void freezeSelection(bool frozen);

    /// From the next frame on the ground is edited so, in place of the edits before; the dataset is not touched. Tiles
    /// that the change concerns are made anew from their stored codes, in that frame where main memory holds them;
    /// until they come, ancestors stand in. When they have come, pictures are those of an engine that began with this
    /// list. @param edits  valid()
    void setEdits(EditList edits);
    /// The same list with one more at its end.
    void addEdit(TerrainEdit edit);

    /// From the next frame on draws these in place of EngineOptions::overlay and those given before.
    void setOverlay(std::span<const OverlayMesh> meshes);

    [[nodiscard]] const FrameTargets& targets() const;
    /// The nodes of the last frame; node index plus 1 is what targets().readNodes() holds.
    [[nodiscard]] const std::vector<DrawNode>& nodes() const;
    [[nodiscard]] const View& view() const;
    /// The view that a frame of this camera has: size, part, earth and exaggeration as they are now.
    [[nodiscard]] View viewFrom(const Camera& camera) const;
    [[nodiscard]] const GpuTiles& tiles() const;
    /// Over what the dataset is drawn: decided at construction and at a change of size, for pictures of 45 degrees.
    [[nodiscard]] const EarthModel& earth() const;
    /// What the ground shows, with what was settled from the dataset: heights, contour interval, tolerance.
    [[nodiscard]] const ShadingOptions& shading() const;
    /// What drawing costs here; none unless the method is hybrid.
    [[nodiscard]] const std::optional<DrawCosts>& drawCosts() const;
    /// How the launch was chosen; none unless Launch::automatic has drawn a frame.
    [[nodiscard]] const std::optional<TerrainRenderer::Calibration>& calibration() const;

    /// Where in the dataset a hit of the last frame lies, in double: metres, z a height, not exaggerated.
    [[nodiscard]] glm::dvec3 worldFromHit(const DrawNode& node, const glm::vec4& hit) const;
    /// Where in the dataset the ground of a pixel of the last frame lies, likewise; none in the sky and outside the
    /// picture. Reads one pixel back.
    [[nodiscard]] std::optional<glm::dvec3> placeAt(int column, int row) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace terray
