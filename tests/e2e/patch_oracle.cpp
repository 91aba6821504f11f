#include "tests/e2e/patch_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "client/render/node_parameters.h"
#include "common/check.h"

namespace terray {

/// A ray over one tile: horizontally in samples, vertically in metres. Height bends upwards over a curved earth.
struct PatchOracle::Ray {
    glm::dvec2 eye;
    glm::dvec2 perT;
    double eyeZ;
    double zPerT;
    double bend;
    double metresPerT;
    double sign;  ///< of the change of the ground: -1 shrunk, 1 grown
    double floor;

    [[nodiscard]] double height(double t) const { return eyeZ + t * (zPerT + t * bend); }
    [[nodiscard]] double doubt(double t) const { return 0.01 + 0x1p-20 * t * metresPerT; }
};

/// When a point that starts at `start` and moves by `speed` is between low and high.
PatchOracle::Times PatchOracle::between(double start, double speed, double low, double high) {
    constexpr double kEver = 1e300;
    if (low > high) return {1, 0};
    if (speed == 0) return start >= low && start <= high ? Times{-kEver, kEver} : Times{1, 0};
    const double a = (low - start) / speed, b = (high - start) / speed;
    return {std::min(a, b), std::max(a, b)};
}

PatchOracle::Times PatchOracle::both(const Times& a, const Times& b) {
    return {std::max(a.from, b.from), std::min(a.to, b.to)};
}

namespace {

/// A place in half samples: quarters of patches are squares of one.
struct Place {
    int x = 0;
    int y = 0;
    bool operator==(const Place&) const = default;
    [[nodiscard]] Place sample() const { return {x >> 1, y >> 1}; }
    /// The sample at the north-western corner of the patch.
    [[nodiscard]] Place patch() const { return {(x - 1) >> 1, (y - 1) >> 1}; }
};

uint16_t codeAt(const HeightTile& tile, const Place& sample) {
    return tile.codes.at(sample.x + kHeightApron, sample.y + kHeightApron);
}

/// The bilinear surface over one patch.
struct Patch {
    std::array<double, 4> heights{};  ///< metres: north-west, north-east, south-west, south-east
    bool whole = true;

    Patch(const HeightTile& tile, const Place& corner) {
        std::array<uint16_t, 4> codes{};
        double sum = 0;
        int count = 0;
        for (size_t i = 0; i < 4; ++i) {
            codes[i] = codeAt(tile, {corner.x + static_cast<int>(i & 1), corner.y + static_cast<int>(i >> 1)});
            if (codes[i] == kNoSurface) continue;
            heights[i] = tile.encoding.height(codes[i]);
            sum += heights[i];
            ++count;
        }
        whole = count == 4;
        for (size_t i = 0; i < 4; ++i)
            if (codes[i] == kNoSurface && count > 0) heights[i] = sum / count;
    }
    [[nodiscard]] double at(double u, double v) const {
        return (heights[0] * (1 - u) + heights[1] * u) * (1 - v) + (heights[2] * (1 - u) + heights[3] * u) * v;
    }
    /// Metres per sample.
    [[nodiscard]] double steepest() const {
        return std::hypot(std::max(std::abs(heights[1] - heights[0]), std::abs(heights[3] - heights[2])),
                          std::max(std::abs(heights[2] - heights[0]), std::abs(heights[3] - heights[1])));
    }
    [[nodiscard]] double twist() const { return heights[0] - heights[1] - heights[2] + heights[3]; }
};

bool inside(const glm::dvec2& low, const glm::dvec2& high, const Place& place) {
    return 0.5 * (place.x + 1) > low.x && 0.5 * place.x < high.x && 0.5 * (place.y + 1) > low.y &&
           0.5 * place.y < high.y;
}

/// The first time from `from` to `to` at which a quadratic function of time is at or below 0, by its sign at the ends
/// and at its turning point, and by halving.
template <class Function>
std::optional<double> firstBelow(const Function& clearance, double from, double to, double turning) {
    if (clearance(from) <= 0) return from;
    double below = to;
    if (turning > from && turning < to && clearance(turning) <= 0) below = turning;
    if (clearance(below) > 0) return {};
    double above = from;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (above + below);
        (clearance(middle) <= 0 ? below : above) = middle;
    }
    return below;
}

}  // namespace

/// Whether the ray stays higher than ground that nowhere exceeds a code, however much that is grown.
bool PatchOracle::clears(const Ray& ray, const Times& span, const NodeGround& node, uint16_t top) {
    const double most = ray.doubt(span.to) * (2 + 2 * node.relief / node.spacing);
    const double sag = ray.bend * (span.to - span.from) * (span.to - span.from) / 4;
    return std::min(ray.height(span.from), ray.height(span.to)) - sag > node.tile->encoding.height(top) + most;
}

/// One quarter of a patch of a node.
struct PatchOracle::Quarter {
    const NodeGround& node;
    Place place;

    [[nodiscard]] bool solid(const Place& at) const {
        return inside(node.low, node.high, at) && codeAt(*node.tile, at.sample()) != kNoSurface;
    }
    /// Whether the ground goes on without a step into a neighbouring quarter.
    [[nodiscard]] bool continuesAt(const Patch& own, const Place& neighbour) const {
        if (!solid(neighbour)) return false;
        if (neighbour.patch() == place.patch()) return true;
        return own.whole && Patch(*node.tile, neighbour.patch()).whole;
    }

    /// Whether the ray is higher than anything around this quarter's sample: a quick answer for most quarters.
    [[nodiscard]] bool passesAbove(const Ray& ray, const Times& span) const {
        return clears(ray, span, node, node.tops->samples.at(place.sample().x, place.sample().y));
    }
    [[nodiscard]] std::optional<double> meet(const Ray& ray, const Times& span) const {
        if (!solid(place) || passesAbove(ray, span)) return {};
        const Patch patch(*node.tile, place.patch());
        const double doubt = ray.doubt(span.to), reach = doubt / node.spacing;
        const double change = ray.sign * doubt * (1 + patch.steepest() / node.spacing);
        // Where the ground of this quarter is, in samples.
        const auto side = [&](int dx, int dy) {
            if (ray.sign > 0) return reach;
            return continuesAt(patch, {place.x + dx, place.y + dy}) ? 0.0 : -reach;
        };
        const glm::dvec2 corner = 0.5 * glm::dvec2(place.x, place.y);
        const glm::dvec2 low = glm::max(corner, node.low) - glm::dvec2(side(-1, 0), side(0, -1));
        const glm::dvec2 high = glm::min(corner + 0.5, node.high) + glm::dvec2(side(1, 0), side(0, 1));
        const Times times = both(
            span, both(between(ray.eye.x, ray.perT.x, low.x, high.x), between(ray.eye.y, ray.perT.y, low.y, high.y)));
        if (times.empty()) return {};

        const glm::dvec2 origin = glm::dvec2(place.patch().x, place.patch().y) + 0.5;
        const auto clearance = [&](double t) {
            const glm::dvec2 at = ray.eye + t * ray.perT - origin;
            return ray.height(t) - patch.at(at.x, at.y) - change;
        };
        // Its second derivative is constant; the turning point is where the first one, taken at the start, is used up.
        const double curvature = 2 * (ray.bend - patch.twist() * ray.perT.x * ray.perT.y);
        const double width = std::max(times.to - times.from, 1e-9);
        const double slope = (clearance(times.from + width) - clearance(times.from)) / width - 0.5 * curvature * width;
        const double turning = curvature == 0 ? times.to : times.from - slope / curvature;
        const auto met = firstBelow(clearance, times.from, times.to, turning);
        return met && ray.height(*met) >= ray.floor ? met : std::nullopt;
    }
};

const PatchOracle::Tops& PatchOracle::topsOf(const HeightTile& tile) {
    Tops& tops = tops_[tile.id];
    if (tops.samples.width() > 0) return tops;
    tops.samples = Grid<uint16_t>({kTileCore, kTileCore});
    tops.blocks = Grid<uint16_t>({kTileCore / kBlock, kTileCore / kBlock});
    for (int y = 0; y < kTileCore; ++y)
        for (int x = 0; x < kTileCore; ++x)
            for (int row = y - 1; row <= y + 1; ++row)
                for (int column = x - 1; column <= x + 1; ++column)
                    tops.samples.at(x, y) = std::max(tops.samples.at(x, y), codeAt(tile, {column, row}));
    const auto blockOf = [](int sample) { return std::clamp(sample, 0, kTileCore - 1) / kBlock; };
    for (int y = 0; y < kTileCore; ++y)
        for (int x = 0; x < kTileCore; ++x)
            for (const int row : {y - 1, y + 1})
                for (const int column : {x - 1, x + 1}) {
                    uint16_t& top = tops.blocks.at(blockOf(column), blockOf(row));
                    top = std::max(top, tops.samples.at(x, y));
                }
    return tops;
}

/// When the ray leaves the block of samples that it is in at the times' start, if it is higher than anything around
/// that block until then.
std::optional<double> PatchOracle::pastBlock(const NodeGround& node, const Ray& ray, const Times& times) {
    const double nudge = 1e-7 / std::max({std::abs(ray.perT.x), std::abs(ray.perT.y), 1e-12});
    const glm::dvec2 here = ray.eye + (times.from + nudge) * ray.perT;
    const glm::dvec2 block = glm::floor(here / static_cast<double>(kBlock));
    const double blocks = kTileCore / kBlock;
    if (block.x < 0 || block.y < 0 || block.x >= blocks || block.y >= blocks) return {};
    double leave = times.to;
    for (int axis = 0; axis < 2; ++axis) {
        if (ray.perT[axis] == 0) continue;
        const double edge = kBlock * (block[axis] + (ray.perT[axis] > 0 ? 1 : 0));
        leave = std::min(leave, (edge - ray.eye[axis]) / ray.perT[axis]);
    }
    // Grown ground reaches less than a sample into the block, or this is no shortcut.
    if (leave <= times.from + nudge || ray.doubt(leave) > 0.5 * node.spacing) return {};
    const uint16_t top = node.tops->blocks.at(static_cast<int64_t>(block.x), static_cast<int64_t>(block.y));
    if (!clears(ray, {times.from, leave}, node, top)) return {};
    return leave < times.to ? leave : std::nextafter(leave, 1e300);
}

const PatchOracle::NodeGround& PatchOracle::groundOf(const DrawNode& node) {
    NodeGround& ground = grounds_[{node.cell, node.heightTile}];
    if (ground.tile != nullptr) return ground;
    const Tiling& tiling = source().metadata().tiling;
    const GroundRect cell = tiling.bounds(node.cell), whole = tiling.bounds(node.heightTile);
    ground.tile = &columns_.tile(node.heightTile);
    ground.tops = &topsOf(*ground.tile);
    ground.origin = {whole.west, whole.north, 0};
    ground.spacing = tiling.spacing(node.heightTile.level);
    ground.low = {(cell.west - whole.west) / ground.spacing, (whole.north - cell.north) / ground.spacing};
    ground.high = {(cell.east - whole.west) / ground.spacing, (whole.north - cell.south) / ground.spacing};
    ground.top = -1e30;
    double bottom = 1e30;
    for (auto y = static_cast<int>(std::floor(ground.low.y)) - 1; y <= std::ceil(ground.high.y); ++y)
        for (auto x = static_cast<int>(std::floor(ground.low.x)) - 1; x <= std::ceil(ground.high.x); ++x) {
            const uint16_t code = codeAt(*ground.tile, {x, y});
            if (code == kNoSurface) continue;
            ground.top = std::max(ground.top, ground.tile->encoding.height(code));
            bottom = std::min(bottom, ground.tile->encoding.height(code));
        }
    ground.relief = std::max(0.0, ground.top - bottom);
    return ground;
}

std::optional<double> PatchOracle::meetNode(const NodeGround& node, const Ray& ray, std::optional<double> first) {
    const double reach =
        std::max(0.0, ray.sign) * (0.01 / node.spacing + 0x1p-20 * (glm::distance(ray.eye, node.low) + kTileCore));
    Times span = both({0, 1e300}, both(between(ray.eye.x, ray.perT.x, node.low.x - reach, node.high.x + reach),
                                       between(ray.eye.y, ray.perT.y, node.low.y - reach, node.high.y + reach)));
    if (ray.bend == 0) {
        const double farthest =
            node.spacing * (glm::distance(ray.eye, node.low) + kTileCore) + std::abs(ray.eyeZ - node.top) + node.relief;
        const double change = (0.01 + 0x1p-20 * farthest) * (1 + 2 * node.relief / node.spacing);
        span = both(span, between(ray.eyeZ, ray.zPerT, ray.floor, node.top + change));
    }
    if (span.empty() || span.to > 1e200) return first;

    const double perHalfSample = 0.5 / std::max({std::abs(ray.perT.x), std::abs(ray.perT.y), 1e-12});
    // A quarter beside the ray may be met later than one farther on, so go on until past what was found.
    for (double t = span.from; t <= std::min(span.to, first.value_or(span.to));) {
        if (const auto past = pastBlock(node, ray, {t, span.to})) {
            t = *past;
            continue;
        }
        // The ray's part up to where it leaves the half sample it is in, or a little farther.
        const glm::dvec2 here = 2.0 * (ray.eye + (t + 1e-7 * perHalfSample) * ray.perT);
        double leave = t + perHalfSample;
        for (int axis = 0; axis < 2; ++axis) {
            if (ray.perT[axis] == 0) continue;
            const double edge = 0.5 * (std::floor(here[axis]) + (ray.perT[axis] > 0 ? 1 : 0));
            leave = std::min(leave, (edge - ray.eye[axis]) / ray.perT[axis]);
        }
        leave = std::min(std::max(leave, t + 1e-7 * perHalfSample), span.to);
        // Every quarter that this part touches, or is within the grown ground's reach of.
        const double beside = std::max(0.0, ray.sign) * ray.doubt(leave) / node.spacing + 1e-7;
        const glm::dvec2 a = ray.eye + t * ray.perT, b = ray.eye + leave * ray.perT;
        const glm::dvec2 from = 2.0 * (glm::min(a, b) - beside), to = 2.0 * (glm::max(a, b) + beside);
        for (auto y = static_cast<int>(std::floor(from.y)); y <= std::floor(to.y); ++y)
            for (auto x = static_cast<int>(std::floor(from.x)); x <= std::floor(to.x); ++x) {
                const auto met = Quarter{node, {x, y}}.meet(ray, {t, leave});
                if (met && (!first || *met < *first)) first = met;
            }
        if (leave >= span.to) break;
        t = leave;
    }
    return first;
}

std::optional<double> PatchOracle::meet(const std::vector<DrawNode>& nodes, const View& view,
                                        const glm::dvec3& direction, ColumnOracle::Columns ground, double floor) {
    const Tiling& tiling = source().metadata().tiling;
    std::vector<DrawNode> asColumns;
    std::optional<double> first;
    for (const DrawNode& node : nodes) {
        if (surface_ == Surface::columns || (surface_ == Surface::automatic && !magnified(node, tiling, view))) {
            asColumns.push_back(node);
            continue;
        }
        // The oracle works in heights. Its rays keep their t.
        const NodeGround& of = groundOf(node);
        const Ray ray{.eye = {(view.eye.x - of.origin.x) / of.spacing, (of.origin.y - view.eye.y) / of.spacing},
                      .perT = {direction.x / of.spacing, -direction.y / of.spacing},
                      .eyeZ = view.eye.z / view.exaggeration,
                      .zPerT = direction.z / view.exaggeration,
                      .bend = view.earth ? view.earth->drop(direction.x, direction.y) / view.exaggeration : 0,
                      .metresPerT = glm::length(direction),
                      .sign = ground == ColumnOracle::Columns::shrunk ? -1.0 : 1.0,
                      .floor = floor};
        first = meetNode(of, ray, first);
    }
    const auto column = columns_.meet(asColumns, view, direction, ground, floor);
    return column && (!first || *column < *first) ? column : first;
}

}  // namespace terray
