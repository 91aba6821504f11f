#include "tests/e2e/column_oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "common/check.h"

namespace terray {
namespace {

struct Span {
    double from = 0;
    double to = std::numeric_limits<double>::infinity();
};

/// Cuts a span down to where low <= start + t * slope <= high.
void clip(Span& span, double start, double slope, double low, double high) {
    if (low > high || slope == 0) {
        if (!(start >= low && start <= high)) span.to = -1;
        return;
    }
    const double a = (low - start) / slope;
    const double b = (high - start) / slope;
    span.from = std::max(span.from, std::min(a, b));
    span.to = std::min(span.to, std::max(a, b));
}

/// The same for the first part of start + t * slope + t^2 * bend that lies between low and high; bend >= 0.
void clipBent(Span& span, double start, double slope, double bend, glm::dvec2 range) {
    if (bend == 0) return clip(span, start, slope, range.x, range.y);
    /// The times at which the parabola passes a height; not numbers when it stays above.
    const auto passes = [&](double height) {
        const double root = std::sqrt(slope * slope - 4 * bend * (start - height));
        const double far = slope < 0 ? root - slope : -root - slope;  // no digits cancel
        const double a = far / (2 * bend), b = 2 * (start - height) / far;
        return glm::dvec2(std::min(a, b), std::max(a, b));
    };
    const glm::dvec2 high = passes(range.y), low = passes(range.x);
    if (std::isnan(high.x)) {
        span.to = -1;
        return;
    }
    span.from = std::max(span.from, high.x);
    span.to = std::min(span.to, high.y);
    if (!std::isnan(low.x) && low.y > 0) span.to = std::min(span.to, low.x);
}

glm::dvec3 centreOf(const GroundRect& ground) {
    return {(ground.west + ground.east) / 2, (ground.south + ground.north) / 2, 0};
}

}  // namespace

ColumnOracle::ColumnOracle(const TileSource& source) : source_(source) {}

const HeightTile& ColumnOracle::tile(const TileId& id) {
    auto found = tiles_.find(id);
    if (found == tiles_.end()) {
        auto bytes = source_.read(TileLayer::heights, id);
        TERRAY_CHECK(bytes.ok());
        auto decoded = decodeHeightTile(*bytes, id);
        TERRAY_CHECK(decoded.ok());
        found = tiles_.emplace(id, std::move(*decoded)).first;
    }
    return found->second;
}

const Grid<uint16_t>& ColumnOracle::blockTops(const HeightTile& tile) {
    Grid<uint16_t>& tops = blockTops_[tile.id];
    if (tops.width() > 0) return tops;
    tops = Grid<uint16_t>({kTileCore / kBlock, kTileCore / kBlock});
    const auto blockOf = [](int64_t sample) { return std::clamp<int64_t>(sample, 0, kTileCore - 1) / kBlock; };
    for (int64_t y = 0; y < kTileCore; ++y)
        for (int64_t x = 0; x < kTileCore; ++x)
            for (const int64_t row : {y - 1, y + 1})
                for (const int64_t column : {x - 1, x + 1}) {
                    uint16_t& top = tops.at(blockOf(column), blockOf(row));
                    top = std::max(top, tile.codes.at(x + kHeightApron, y + kHeightApron));
                }
    return tops;
}

std::optional<double> ColumnOracle::meetNode(const DrawNode& node, const Ray& ray, std::optional<double> first) {
    const Tiling& tiling = source_.metadata().tiling;
    const GroundRect ground = tiling.bounds(node.cell);
    const double metresPerT = glm::length(ray.direction);
    const auto changeAt = [&](double t) { return ray.sign * (0.01 + 0x1p-20 * t * metresPerT); };
    Span span;
    clipBent(span, ray.eye.z, ray.direction.z, ray.bend, {ray.floor, node.maxHeight + 1});
    const double widest =
        ray.sign < 0 ? 0
                     : 0.01 + 0x1p-20 * std::hypot(glm::distance(ray.eye, centreOf(ground)), ground.east - ground.west);
    clip(span, ray.eye.x, ray.direction.x, ground.west - widest, ground.east + widest);
    clip(span, ray.eye.y, ray.direction.y, ground.south - widest, ground.north + widest);
    if (span.to <= span.from) return first;

    const HeightTile& tile = this->tile(node.heightTile);
    const GroundRect source = tiling.bounds(node.heightTile);
    const double spacing = tiling.spacing(node.heightTile.level);
    const glm::dvec2 eye((ray.eye.x - source.west) / spacing, (source.north - ray.eye.y) / spacing);
    const glm::dvec2 perT(ray.direction.x / spacing, -ray.direction.y / spacing);
    const auto throughCell = [&](int64_t column, int64_t row, double grow) {
        Span cell{0, span.to};
        clip(cell, eye.x, perT.x, static_cast<double>(column) - grow, static_cast<double>(column + 1) + grow);
        clip(cell, eye.y, perT.y, static_cast<double>(row) - grow, static_cast<double>(row + 1) + grow);
        return cell;
    };
    /// Time at which the ray meets one column, if it does.
    const auto meetColumn = [&](int64_t column, int64_t row, double change) -> std::optional<double> {
        if (std::min(column, row) < 0 || std::max(column, row) >= kTileCore) return {};
        const uint16_t code = tile.codes.at(column + kHeightApron, row + kHeightApron);
        if (code == kNoSurface) return {};
        Span inside = throughCell(column, row, change / spacing);
        clipBent(inside, ray.eye.z, ray.direction.z, ray.bend, {ray.floor, tile.encoding.height(code) + change});
        return inside.from <= inside.to ? std::optional(inside.from) : std::nullopt;
    };
    /// When the ray leaves the block of samples around a cell, if until then it is higher than all that is in the block
    /// and next to it; else 0. What grows by more than a sample is left to single columns.
    const Grid<uint16_t>& tops = blockTops(tile);
    const auto pastBlock = [&](int64_t column, int64_t row, double from) {
        if (std::min(column, row) < 0 || std::max(column, row) >= kTileCore) return 0.0;
        Span block{from, span.to};
        const auto cut = [&](double start, double slope, int64_t sample) {
            const auto low = static_cast<double>(sample / kBlock * kBlock);
            clip(block, start, slope, low, low + kBlock);
        };
        cut(eye.x, perT.x, column);
        cut(eye.y, perT.y, row);
        if (block.to <= from || std::abs(changeAt(block.to)) > spacing) return 0.0;
        const auto height = [&](double t) { return ray.eye.z + t * (ray.direction.z + t * ray.bend); };
        const double sag = ray.bend * (block.to - from) * (block.to - from) / 4;
        const double top = tile.encoding.height(tops.at(column / kBlock, row / kBlock)) + changeAt(block.to);
        return std::min(height(from), height(block.to)) - sag > top ? block.to : 0.0;
    };
    const int64_t beside = ray.sign > 0 ? 1 : 0;  // grown columns reach into their neighbours
    // A column beside the ray's cell may be met later than one in the next cell, so go on until past what was found.
    for (double t = span.from; t < std::min(span.to, first.value_or(span.to));) {
        // The cell around a point just ahead, and the time at which the ray leaves that cell.
        const double ahead = t + 1e-9 * std::max(1.0, t) + 1e-7 * spacing / metresPerT;
        const auto column = static_cast<int64_t>(std::floor(eye.x + ahead * perT.x));
        const auto row = static_cast<int64_t>(std::floor(eye.y + ahead * perT.y));
        if (const double past = pastBlock(column, row, t); past > ahead) {
            t = past;
            continue;
        }
        for (int64_t y = row - beside; y <= row + beside; ++y)
            for (int64_t x = column - beside; x <= column + beside; ++x) {
                const auto met = meetColumn(x, y, changeAt(ahead));
                if (met && (!first || *met < *first)) first = met;
            }
        t = std::max(throughCell(column, row, 0).to, ahead);
    }
    return first;
}

std::optional<double> ColumnOracle::meet(const std::vector<DrawNode>& nodes, const View& view,
                                         const glm::dvec3& direction, Columns columns, double floor) {
    std::optional<double> first;
    // The oracle works in heights. Its rays keep their t.
    const View heights = exaggerated(view, 1 / view.exaggeration);
    const Ray ray{.eye = heights.eye,
                  .direction = {direction.x, direction.y, direction.z / view.exaggeration},
                  .bend = heights.earth ? heights.earth->drop(direction.x, direction.y) : 0,
                  .sign = columns == Columns::shrunk ? -1.0 : 1.0,
                  .floor = floor};
    for (const DrawNode& node : nodes) first = meetNode(node, ray, first);
    return first;
}

}  // namespace terray
