#include "client/stream/ground_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <glm/geometric.hpp>

#include "common/error.h"

namespace terray {
namespace {

constexpr float kNone = -std::numeric_limits<float>::infinity();
/// Four tiles, 1024 cells a side.
constexpr uint32_t kMapLevel = 1;

HeightTile readTile(const TileSource& source, const TileId& id) {
    const auto refuse = [&id](const Failure& failure) {
        return Error(ExitCode::dataset, "cannot read height tile " + toString(id) + ": " + failure.message +
                                            "; terray-preprocess verify tells what is damaged");
    };
    const auto payload = source.read(TileLayer::heights, id);
    if (!payload) throw refuse(payload.failure());
    auto tile = decodeHeightTile(*payload, id);
    if (!tile) throw refuse(tile.failure());
    return std::move(*tile);
}

}  // namespace

GroundMap GroundMap::read(const TileSource& source) {
    const DatasetMetadata& metadata = source.metadata();
    const uint32_t level = std::min(kMapLevel, metadata.tiling.finestLevel);
    GroundMap map(metadata, level);
    const HeightTile root = readTile(source, {});
    if (level == 0) {
        map.take(root);
    } else {
        for (uint32_t quadrant = 0; quadrant < 4; ++quadrant)
            if (root.children[quadrant].exists) map.take(readTile(source, root.id.child(quadrant)));
    }
    map.measure();
    return map;
}

GroundMap::GroundMap(const DatasetMetadata& metadata, uint32_t level)
    : bounds_(metadata.groundBounds()), side_(metadata.tiling.spacing(level)) {
    const int64_t factor = int64_t{1} << (metadata.tiling.finestLevel - level);
    const auto cells = [factor](int64_t samples) { return (samples + factor - 1) / factor; };
    heights_ = Grid<float>({cells(metadata.samples.width), cells(metadata.samples.height)}, kNone);
}

void GroundMap::take(const HeightTile& tile) {
    const GridRect core = Tiling::coreSamples(tile.id);
    const GridRect shared = intersection(core, {0, 0, heights_.width(), heights_.height()});
    for (int64_t y = shared.y; y < shared.y + shared.height; ++y) {
        for (int64_t x = shared.x; x < shared.x + shared.width; ++x) {
            const uint16_t code = tile.codes.at(x - core.x + kHeightApron, y - core.y + kHeightApron);
            if (code == kNoSurface) continue;
            heights_.at(x, y) = static_cast<float>(tile.encoding.height(code) + tile.record.error);
        }
    }
}

void GroundMap::measure() {
    bool any = false;
    for (const float height : heights_.cells()) {
        if (height == kNone) continue;
        lowest_ = any ? std::min(lowest_, double{height}) : height;
        highest_ = any ? std::max(highest_, double{height}) : height;
        any = true;
    }
}

glm::dvec2 GroundMap::centreOf(int64_t column, int64_t row) const {
    return {bounds_.west + (static_cast<double>(column) + 0.5) * side_,
            bounds_.north - (static_cast<double>(row) + 0.5) * side_};
}

double GroundMap::highestNear(glm::dvec2 place, double radius) const {
    const auto cell = [this](double metres, int64_t count) {  // clamped before the conversion: places may be far away
        return static_cast<int64_t>(std::clamp(std::floor(metres / side_), -1.0, static_cast<double>(count)));
    };
    const int64_t x0 = std::max<int64_t>(cell(place.x - radius - bounds_.west, heights_.width()), 0);
    const int64_t x1 = std::min(cell(place.x + radius - bounds_.west, heights_.width()), heights_.width() - 1);
    const int64_t y0 = std::max<int64_t>(cell(bounds_.north - place.y - radius, heights_.height()), 0);
    const int64_t y1 = std::min(cell(bounds_.north - place.y + radius, heights_.height()), heights_.height() - 1);
    double highest = lowest_;
    for (int64_t y = y0; y <= y1; ++y)
        for (int64_t x = x0; x <= x1; ++x) highest = std::max(highest, double{heights_.at(x, y)});
    return highest;
}

glm::dvec2 GroundMap::summit(double margin) const {
    const auto inset = [margin](int64_t cells) { return static_cast<int64_t>(margin * static_cast<double>(cells)); };
    const int64_t left = inset(heights_.width()), top = inset(heights_.height());
    glm::dvec2 place{(bounds_.west + bounds_.east) / 2, (bounds_.south + bounds_.north) / 2};
    float highest = kNone;
    for (int64_t y = top; y < heights_.height() - top; ++y) {
        for (int64_t x = left; x < heights_.width() - left; ++x) {
            if (heights_.at(x, y) <= highest) continue;
            highest = heights_.at(x, y);
            place = centreOf(x, y);
        }
    }
    return place;
}

double GroundMap::roughness(glm::dvec2 from, glm::dvec2 to) const {
    const int steps = std::max(1, static_cast<int>(glm::distance(from, to) / side_));
    double sum = 0;
    float previous = kNone;
    for (int i = 0; i <= steps; ++i) {
        const glm::dvec2 place = from + (to - from) * (static_cast<double>(i) / steps);
        const double column = std::floor((place.x - bounds_.west) / side_),
                     row = std::floor((bounds_.north - place.y) / side_);
        const bool inside = column >= 0 && row >= 0 && column < static_cast<double>(heights_.width()) &&
                            row < static_cast<double>(heights_.height());
        const float height = inside ? heights_.at(static_cast<int64_t>(column), static_cast<int64_t>(row)) : kNone;
        if (height != kNone && previous != kNone) sum += std::abs(height - previous);
        previous = height;
    }
    return sum;
}

}  // namespace terray
