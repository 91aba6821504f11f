#include "tests/e2e/comparison.h"

#include <cmath>
#include <ostream>

#include "common/tiling.h"

namespace terray {

void Comparison::operator+=(const Comparison& other) {
    pixels += other.pixels;
    ground += other.ground;
    holes += other.holes;
    falseGround += other.falseGround;
    misplaced += other.misplaced;
    jumps += other.jumps;
    outOfSteps += other.outOfSteps;
}

std::ostream& operator<<(std::ostream& out, const Comparison& comparison) {
    return out << comparison.pixels << " pixels, " << comparison.ground << " of ground: " << comparison.holes
               << " holes, " << comparison.falseGround << " of false ground, " << comparison.misplaced << " misplaced, "
               << comparison.outOfSteps << " out of steps; " << comparison.jumps << " level jumps";
}

Grid<PixelTruth> truthOf(const std::vector<DrawNode>& drawn, const View& view, const DatasetMetadata& metadata,
                         const Truth& truth) {
    Grid<PixelTruth> result({view.width, view.height});
    for (int64_t y = 0; y < view.height; ++y)
        for (int64_t x = 0; x < view.width; ++x) {
            const glm::dvec3 direction = view.direction(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
            result.at(x, y) = {
                truth(drawn, view, direction, ColumnOracle::Columns::shrunk, metadata.minHeight),
                truth(drawn, view, direction, ColumnOracle::Columns::grown, metadata.minHeight - 1e6),
            };
        }
    return result;
}

Comparison compare(const Grid<PixelTruth>& truth, const std::vector<DrawNode>& drawn, const FrameTargets& targets) {
    Comparison result;
    const auto nodes = targets.readNodes();
    const auto hits = targets.readHits();
    const auto colours = targets.readSrgb();
    result.outOfSteps = raysOutOfSteps(targets);
    for (int64_t y = 0; y < nodes.height(); ++y)
        for (int64_t x = 0; x < nodes.width(); ++x) {
            ++result.pixels;
            const auto& [sure, possible] = truth.at(x, y);
            const uint32_t node = nodes.at(x, y);
            const double t = hits.at(x, y).w;
            if (sure) {
                ++result.ground;
                if (node == 0 || colours.at(x, y) == kSignal) {
                    ++result.holes;
                } else if (t > *sure * (1 + 0x1p-18) + 0.05) {
                    ++result.misplaced;
                }
            }
            if (node != 0) {
                if (!possible) ++result.falseGround;
                if (possible && t < *possible * (1 - 0x1p-18) - 0.05) ++result.misplaced;
            }
            if (x > 0 && node != 0 && nodes.at(x - 1, y) != 0) {
                const auto levelOf = [&](uint32_t n) { return drawn[n - 1].heightTile.level; };
                result.jumps += levelOf(node) != levelOf(nodes.at(x - 1, y)) ? 1 : 0;
            }
        }
    return result;
}

double groundAt(ColumnOracle& oracle, double x, double y) {
    const Tiling& tiling = oracle.source().metadata().tiling;
    const auto column = static_cast<int64_t>(std::floor((x - tiling.west) / tiling.finestSpacing));
    const auto row = static_cast<int64_t>(std::floor((tiling.north - y) / tiling.finestSpacing));
    const GridSize samples = oracle.source().metadata().samples;
    if (column < 0 || row < 0 || column >= samples.width || row >= samples.height) return std::nan("");
    const TileId id{tiling.finestLevel, static_cast<uint32_t>(column / kTileCore),
                    static_cast<uint32_t>(row / kTileCore)};
    const HeightTile& tile = oracle.tile(id);
    return tile.encoding.height(tile.codes.at(column % kTileCore + kHeightApron, row % kTileCore + kHeightApron));
}

Camera randomCamera(std::mt19937& random, ColumnOracle& oracle) {
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const GroundRect ground = oracle.source().metadata().groundBounds();
    const double wide = ground.east - ground.west;
    const double x = ground.west + wide * uniform(-0.1, 1.1);
    const double y = ground.south + (ground.north - ground.south) * uniform(-0.1, 1.1);
    const double below = groundAt(oracle, x, y);
    const double height =
        (std::isnan(below) ? oracle.source().metadata().minHeight : below) + wide * std::pow(10, uniform(-3.3, -0.3));
    const double pitch = uniform(0, 1) < 0.1 ? -90 : uniform(-70, 10);
    return cameraAt({x, y, height}, uniform(0, 360), pitch, uniform(20, 90));
}

float cliffs(int64_t column, int64_t row) {
    const bool high = ((column / 512) + (row / 512)) % 2 == 1;
    return static_cast<float>((high ? 900 : 0) + (column * 7919 + row * 104729) % 13);
}

}  // namespace terray
