#include "client/render/draw_calibration.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "client/render/node_parameters.h"
#include "client/render/terrain_mesh.h"
#include "client/render/terrain_renderer.h"
#include "common/height_tile.h"

namespace terray {
namespace {

constexpr int kSide = 384;       // of the picture, pixels
constexpr double kSpacing = 10;  // metres between samples
constexpr double kTileSide = kSpacing * kTileCore;
constexpr int kRepeats = 4;  // of which the fastest counts

/// Hills with slopes at every length from a sample to the tile: mountains as much as roughness.
int codeAt(int column, int row) {
    double height = 20000;
    for (int octave = 0; octave < 7; ++octave) {
        const double length = 300 / std::exp2(octave);
        height += 6000 / std::exp2(octave) * std::sin(column / length + 1.7 * octave) *
                  std::cos(row / length - 0.9 * octave + 0.3 * std::sin(column / length));
    }
    return static_cast<int>(height);
}

HeightTile computedTile() {
    HeightTile tile;
    tile.encoding.quantum = 0.1;  // metres
    tile.codes = Grid<uint16_t>({kHeightTileSide, kHeightTileSide});
    for (int row = 0; row < kHeightTileSide; ++row)
        for (int column = 0; column < kHeightTileSide; ++column)
            tile.codes.at(column, row) = static_cast<uint16_t>(codeAt(column, row));
    tile.record = measureRecord(tile.codes, tile.encoding, 0);
    return tile;
}

/// Over the middle of the tile, so many sides away.
View viewFrom(double sides, double degreesDown, double middleHeight) {
    const double down = glm::radians(degreesDown);
    View view{.width = kSide, .height = kSide};
    view.forward = {0, std::cos(down), -std::sin(down)};
    view.up = {0, std::sin(down), std::cos(down)};
    view.right = {1, 0, 0};
    view.eye = glm::dvec3(kTileSide / 2, -kTileSide / 2, middleHeight) - sides * kTileSide * view.forward;
    return view;
}

/// One computed tile on the GPU, and all that draws it.
class Scene {
  public:
    Scene(const ShaderLibrary& shaders, const HeightTile& tile, double meshError)
        : tiling_{.finestSpacing = kSpacing},
          method_{.method = Method::mesh, .error = meshError},
          tiles_(shaders, {.heightTiles = 1, .method = {.method = method_, .tiling = tiling_}}),
          renderer_(shaders, tiling_),
          targets_(kSide, kSide, {}),
          node_{.minHeight = tile.record.minHeight, .maxHeight = tile.record.maxHeight},
          makeMs_(millisecondsToMake(tile, meshError)) {
        TERRAY_CHECK(tiles_.uploadHeights(tile).done);
    }

    /// @param castMs  as another scene has measured it: rays do not see how closely the tile is triangulated
    CostSample measure(const View& view, std::optional<double> castMs) {
        const NodeSource source{.heights = *tiles_.heights(node_.heightTile)};
        const interop::NodeParameters node = nodeParameters(node_, source, tiling_, view);
        return {.work = workOf(node, view, tiles_.methodTiles()->triangles(node)),
                .castMs = castMs ? *castMs : milliseconds(view, {}, 1),
                .meshMs = milliseconds(view, method_, 1),
                .emptyMs = milliseconds(view, {}, 0),
                .makeMs = makeMs_};
    }

  private:
    static double millisecondsToMake(const HeightTile& tile, double meshError) {
        // As MeshTiles allows a finest tile, which has no error of its own.
        const MeshTolerance tolerance{.codes = meshError * kSpacing / 4 / tile.encoding.metresPerCode()};
        const auto start = std::chrono::steady_clock::now();
        const size_t triangles = triangulated(tile.codes, tolerance).triangles();
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
        TERRAY_CHECK_OP(triangles, >, 0u);
        return took.count();
    }

    /// Wall clock around glFinish, which also counts what the driver does on the CPU.
    double milliseconds(const View& view, const MethodOptions& method, size_t nodes) {
        RenderOptions options;
        options.surface = Surface::bilinear;
        options.method = method;
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i <= kRepeats; ++i) {
            glFinish();
            const auto start = std::chrono::steady_clock::now();
            renderer_.render(view, std::span(&node_, nodes), {}, tiles_, options, targets_, nullptr);
            glFinish();
            const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
            if (i > 0) least = std::min(least, took.count());  // the first may have compiled programs
        }
        return least;
    }

    Tiling tiling_;
    MethodOptions method_;
    GpuTiles tiles_;
    TerrainRenderer renderer_;
    FrameTargets targets_;
    DrawNode node_;
    double makeMs_;
};

}  // namespace

DrawCosts calibratedCosts(const ShaderLibrary& shaders) {
    const HeightTile tile = computedTile();
    const double middle = (double{tile.record.minHeight} + double{tile.record.maxHeight}) / 2;
    std::vector<View> views;
    for (const double sides : {0.6, 1.5, 5.0})
        for (const double degreesDown : {80.0, 35.0, 12.0}) views.push_back(viewFrom(sides, degreesDown, middle));
    std::vector<CostSample> samples;
    for (const double meshError : {40.0, 8.0, 1.0}) {
        Scene scene(shaders, tile, meshError);
        const bool first = samples.empty();
        for (size_t n = 0; n < views.size(); ++n)
            samples.push_back(scene.measure(views[n], first ? std::nullopt : std::optional(samples[n].castMs)));
    }
    return fittedCosts(samples);
}

}  // namespace terray
