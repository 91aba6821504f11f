#include "common/reference/ground_caster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace terray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int64_t kSquare = 512;  // patches along the side of what is loaded at once
constexpr int64_t kBlock = 16;    // patches along the side of what is left out at once
constexpr int64_t kBlocks = kSquare / kBlock;

/// A height over the plane along a ray, or its clearance: a t^2 + b t + c.
struct Quadratic {
    double a = 0;
    double b = 0;
    double c = 0;

    [[nodiscard]] double at(double t) const { return (a * t + b) * t + c; }
    /// Where it is least on a stretch.
    [[nodiscard]] double leastAt(const Stretch& stretch) const {
        const double end = at(stretch.from) <= at(stretch.to) ? stretch.from : stretch.to;
        if (!(a > 0)) return end;
        const double vertex = std::clamp(-b / (2 * a), stretch.from, stretch.to);
        return at(vertex) <= at(end) ? vertex : end;
    }
};

/// The one t of a stretch where a quadratic changes its sign, which its ends do not share, to the last place.
double signChange(const Quadratic& quadratic, Stretch stretch) {
    const bool startsBelow = quadratic.at(stretch.from) <= 0;
    for (;;) {
        const double middle = stretch.from + (stretch.to - stretch.from) / 2;
        if (!(middle > stretch.from && middle < stretch.to)) return stretch.to;
        ((quadratic.at(middle) <= 0) == startsBelow ? stretch.from : stretch.to) = middle;
    }
}

/// The first t of a stretch at which a quadratic is at or below 0.
std::optional<double> firstBelow(const Quadratic& quadratic, const Stretch& stretch) {
    if (quadratic.at(stretch.from) <= 0) return stretch.from;
    const double least = quadratic.leastAt(stretch);
    if (!(quadratic.at(least) <= 0)) return std::nullopt;
    return signChange(quadratic, {stretch.from, least});
}

}  // namespace

/// In heights and in samples: x and y count from the centre of sample (0, 0), y to the south.
struct GroundCaster::Ray {
    PlaneLine line;
    Quadratic height;
};

/// An extreme of what a slack allows: which one, by how much.
struct GroundCaster::Offset {
    Slack slack;
    double sign = 1;  ///< of what is added to heights
};

/// Bounds of how a ground's height changes.
struct GroundCaster::Relief {
    double steepest = 0;  ///< over a sample to the east plus over one to the south
    double step = 0;      ///< from a patch to the next: those beside a hole take other means for the missing sample
};

/// 512 x 512 patches with the samples around them and a ring of further ones. Patch (i, j) lies between samples i, i +
/// 1 and j, j + 1.
struct GroundCaster::Square {
    int64_t column = 0;  ///< of its first patch
    int64_t row = 0;
    Grid<double> heights;  ///< 515 x 515, the first one before (column, row); NaN: no surface
    Grid<double> tops;     ///< of each block, its highest sample and that of the ring; -infinity: no surface

    /// Samples 0, 0; 1, 0; 0, 1; 1, 1 of a patch.
    [[nodiscard]] std::array<double, 4> corners(int64_t i, int64_t j) const {
        const int64_t x = i - column + 1;
        const int64_t y = j - row + 1;
        return {heights.at(x, y), heights.at(x + 1, y), heights.at(x, y + 1), heights.at(x + 1, y + 1)};
    }
    /// How heights change in a patch and those around it.
    [[nodiscard]] Relief reliefAround(int64_t i, int64_t j) const {
        double east = 0, south = 0, low = kInfinity, high = -kInfinity;
        bool missing = false;
        const auto at = [&](int64_t x, int64_t y) { return heights.at(i - column + x, j - row + y); };
        for (int64_t y = 0; y < 4; ++y)
            for (int64_t x = 0; x < 4; ++x) {
                const double height = at(x, y);
                missing |= std::isnan(height);
                low = std::fmin(low, height);
                high = std::fmax(high, height);
                if (x > 0) east = std::fmax(east, std::abs(height - at(x - 1, y)));
                if (y > 0) south = std::fmax(south, std::abs(height - at(x, y - 1)));
            }
        if (missing) return {.steepest = 2 * (high - low), .step = high - low};
        return {.steepest = east + south};
    }
};

namespace {

using Corners = std::array<double, 4>;

/// Whether all, some or none of a patch's samples have a surface; where some do, the others take the mean of these.
struct Patch {
    Corners heights{};
    std::array<bool, 4> exists{};
    int count = 0;

    explicit Patch(const Corners& samples) : heights(samples) {
        double sum = 0;
        for (size_t n = 0; n < heights.size(); ++n) {
            exists[n] = !std::isnan(heights[n]);
            if (!exists[n]) continue;
            ++count;
            sum += heights[n];
        }
        for (size_t n = 0; n < heights.size(); ++n)
            if (!exists[n]) heights[n] = sum / count;
    }
    [[nodiscard]] double heightAt(double u, double v) const {
        const double north = heights[0] + u * (heights[1] - heights[0]);
        const double south = heights[2] + u * (heights[3] - heights[2]);
        return north + v * (south - north);
    }
};

/// How high a ray is above a patch, s after `from`. @param u, v  place in the patch at `from`
Quadratic clearanceOf(const Patch& patch, const PlaneLine& line, const Quadratic& height, double from, double u,
                      double v) {
    const auto& h = patch.heights;
    const double twist = h[0] - h[1] - h[2] + h[3];
    const double eastward = h[1] - h[0] + v * twist;
    const double southward = h[2] - h[0] + u * twist;
    return {height.a - twist * line.changeX * line.changeY,
            height.b + 2 * height.a * from - eastward * line.changeX - southward * line.changeY,
            height.at(from) - patch.heightAt(u, v)};
}

/// First contact with a patch as if it existed whole.
std::optional<double> meetWhole(const Patch& patch, int64_t i, int64_t j, const PlaneLine& line,
                                const Quadratic& height, const Stretch& stretch) {
    const double u = std::clamp(line.x(stretch.from) - static_cast<double>(i), 0.0, 1.0);
    const double v = std::clamp(line.y(stretch.from) - static_cast<double>(j), 0.0, 1.0);
    const auto s = firstBelow(clearanceOf(patch, line, height, stretch.from, u, v), {0, stretch.to - stretch.from});
    return s ? std::optional(stretch.from + *s) : std::nullopt;
}

/// First contact with a patch, or with those quarters of it that exist.
std::optional<double> meetPatch(const Patch& patch, int64_t i, int64_t j, const PlaneLine& line,
                                const Quadratic& height, const Stretch& stretch) {
    if (patch.count == 0) return std::nullopt;
    if (patch.count == 4) return meetWhole(patch, i, j, line, height, stretch);
    std::optional<double> contact;
    walkSquares(line, 0.5, {2 * i, 2 * j, 2, 2}, stretch, [&](int64_t x, int64_t y, const Stretch& part) {
        const auto owner = static_cast<size_t>((x - 2 * i) + 2 * (y - 2 * j));
        if (patch.exists[owner]) contact = meetWhole(patch, i, j, line, height, part);
        return contact.has_value();
    });
    return contact;
}

}  // namespace

GroundCaster::GroundCaster(const ReferenceHeights& heights, const Tiling& tiling, double floor, uint64_t budgetBytes)
    : heights_(heights),
      tiling_(tiling),
      floor_(floor),
      mostSquares_(std::max<uint64_t>(budgetBytes / (sizeof(double) * (kSquare + 3) * (kSquare + 3)), 1)) {}

GroundCaster::~GroundCaster() = default;

GroundCaster::Ray GroundCaster::rayOf(const View& view, const glm::dvec3& direction) const {
    const double spacing = tiling_.finestSpacing;
    const double bend = view.earth ? view.earth->drop(direction.x, direction.y) : 0;
    return {.line = {(view.eye.x - tiling_.west) / spacing - 0.5, (tiling_.north - view.eye.y) / spacing - 0.5,
                     direction.x / spacing, -direction.y / spacing},
            .height = {bend / view.exaggeration, direction.z / view.exaggeration, view.eye.z / view.exaggeration}};
}

std::optional<double> GroundCaster::meet(const View& view, const glm::dvec3& direction) const {
    return meetGround(rayOf(view, direction), floor_, nullptr);
}

std::optional<double> GroundCaster::meetExtreme(const View& view, const glm::dvec3& direction, const Slack& slack,
                                                Extreme extreme, double floor) const {
    const Offset offset{.slack = slack, .sign = static_cast<double>(extreme)};
    Ray ray = rayOf(view, direction);
    // A ground that is higher is one above which the ray is lower.
    ray.height.a -= offset.sign * slack.heightBend;
    ray.height.b -= offset.sign * slack.height.b;
    ray.height.c -= offset.sign * slack.height.a;
    return meetGround(ray, floor, &offset);
}

std::optional<double> GroundCaster::meetExtremeOfPatch(const Square& loaded, int64_t i, int64_t j, const Ray& ray,
                                                       const Stretch& stretch, const Offset& offset) {
    const Patch patch(loaded.corners(i, j));
    if (patch.count == 0) return std::nullopt;
    const Slack& slack = offset.slack;
    const Relief relief = loaded.reliefAround(i, j);
    const double edge = std::min(slack.edge.at(stretch.to), 0.5);
    const double reach = slack.reach.at(stretch.to);
    const auto x = static_cast<double>(i), y = static_cast<double>(j);
    // Cut where the ray crosses a place at which sides may lie, or from which the next patch is within reach.
    const std::array<double, 4> places{0.5 - edge, 0.5 + edge, reach, 1 - reach};
    std::array<double, 10> times{stretch.from, stretch.to};
    for (size_t n = 0; n < places.size(); ++n) {
        const auto crossing = [&](double start, double change) {
            return change == 0 ? stretch.to : std::clamp((places[n] - start) / change, stretch.from, stretch.to);
        };
        times[2 + 2 * n] = crossing(ray.line.startX - x, ray.line.changeX);
        times[3 + 2 * n] = crossing(ray.line.startY - y, ray.line.changeY);
    }
    std::sort(times.begin(), times.end());
    for (size_t n = 0; n + 1 < times.size(); ++n) {
        if (n > 0 && times[n] == times[n + 1]) continue;
        const Stretch part{times[n], times[n + 1]};
        const double middle = part.from + (part.to - part.from) / 2;
        const double u = ray.line.x(middle) - x, v = ray.line.y(middle) - y;
        bool any = false, all = true;
        for (size_t owner = 0; owner < 4; ++owner) {
            const bool nearU = owner % 2 == 0 ? u <= 0.5 + edge : u >= 0.5 - edge;
            const bool nearV = owner / 2 == 0 ? v <= 0.5 + edge : v >= 0.5 - edge;
            any |= nearU && nearV && patch.exists[owner];
            all &= !nearU || !nearV || patch.exists[owner];
        }
        if (!(offset.sign > 0 ? any : all)) continue;
        const bool nextInReach = reach > 0 && std::min({u, v, 1 - u, 1 - v}) <= reach;
        const double steep = offset.sign * relief.steepest;
        const double step = nextInReach ? offset.sign * relief.step : 0;
        const Quadratic height{ray.height.a, ray.height.b - slack.reach.b * steep,
                               ray.height.c - slack.reach.a * steep - step};
        if (const auto contact = meetWhole(patch, i, j, ray.line, height, part)) return contact;
    }
    return std::nullopt;
}

std::optional<double> GroundCaster::meetGround(const Ray& ray, double floor, const Offset* offset) const {
    const bool grown = offset != nullptr && offset->sign > 0;
    const std::optional<Stretch> whole = overGround(ray, floor, grown ? 0.5 : 0);
    if (!whole) return std::nullopt;

    const auto clears = [&](double top, const Stretch& part) { return ray.height.at(ray.height.leastAt(part)) > top; };
    const GridSize size = heights_.size();
    const GridRect squares{-1, -1, (size.width - 1) / kSquare + 2, (size.height - 1) / kSquare + 2};
    const auto meetOne = [&](const Square& loaded, int64_t i, int64_t j, const Stretch& inPatch) {
        if (offset != nullptr) return meetExtremeOfPatch(loaded, i, j, ray, inPatch, *offset);
        return meetPatch(Patch(loaded.corners(i, j)), i, j, ray.line, ray.height, inPatch);
    };
    std::optional<double> contact;
    const auto meetSquare = [&](int64_t column, int64_t row, const Stretch& inSquare) {
        if (clears(topOf({column * kSquare - 1, row * kSquare - 1, kSquare + 3, kSquare + 3}), inSquare)) return false;
        const SquarePointer loaded = square({row, column});
        const auto meetBlock = [&](int64_t blockX, int64_t blockY, const Stretch& inBlock) {
            if (clears(loaded->tops.at(blockX - column * kBlocks, blockY - row * kBlocks), inBlock)) return false;
            return walkSquares(ray.line, 1, {blockX * kBlock, blockY * kBlock, kBlock, kBlock}, inBlock,
                               [&](int64_t i, int64_t j, const Stretch& inPatch) {
                                   contact = meetOne(*loaded, i, j, inPatch);
                                   return contact.has_value();
                               });
        };
        return walkSquares(ray.line, kBlock, {column * kBlocks, row * kBlocks, kBlocks, kBlocks}, inSquare, meetBlock);
    };
    walkSquares(ray.line, kSquare, squares, *whole, meetSquare);
    return contact;
}

/// A ray that sinks below the floor has passed the ground.
std::optional<Stretch> GroundCaster::overGround(const Ray& ray, double floor, double margin) const {
    Stretch part{0, kInfinity};
    const auto clip = [&](double start, double change, double low, double high) {
        if (change == 0) {
            if (start < low || start > high) part.to = -1;
            return;
        }
        const double a = (low - start) / change;
        const double b = (high - start) / change;
        part = {std::max(part.from, std::min(a, b)), std::min(part.to, std::max(a, b))};
    };
    const GridSize size = heights_.size();
    clip(ray.line.startX, ray.line.changeX, -0.5 - margin, static_cast<double>(size.width) - 0.5 + margin);
    clip(ray.line.startY, ray.line.changeY, -0.5 - margin, static_cast<double>(size.height) - 0.5 + margin);
    if (!(part.from <= part.to) || std::isinf(part.from)) return std::nullopt;
    if (std::isinf(part.to)) {  // straight up or down: t is bounded by its height alone
        if (ray.height.b == 0) return Stretch{0, 0};
        part.to = std::max((floor - ray.height.c) / ray.height.b, 0.0);
        if (ray.height.b > 0) return Stretch{part.to, part.to};  // it meets where it starts, or never
        if (ray.height.c < floor) return std::nullopt;
        return part;
    }
    const Quadratic aboveFloor{ray.height.a, ray.height.b, ray.height.c - floor};
    if (aboveFloor.at(part.from) < 0) {
        if (!(aboveFloor.at(part.to) > 0)) return std::nullopt;
        part.from = signChange(aboveFloor, part);
    } else if (const auto sinks = firstBelow(aboveFloor, part)) {
        part.to = *sinks;
    }
    return part;
}

std::optional<glm::dvec3> GroundCaster::nearestEdge(double x, double y) const {
    constexpr int kDirections = 16;
    constexpr double kMostSamples = 256;
    constexpr double kGrowth = std::numbers::sqrt2;  // of the circles
    constexpr int kHalvings = 30;
    const auto at = [&](int direction, double samples) -> std::optional<glm::dvec3> {
        const double angle = 2 * std::numbers::pi * direction / kDirections;
        const double metres = samples * tiling_.finestSpacing;
        const glm::dvec2 place(x + metres * std::sin(angle), y + metres * std::cos(angle));
        const std::optional<double> height = heightAt(place.x, place.y);
        return height ? std::optional(glm::dvec3(place, *height)) : std::nullopt;
    };
    for (double circle = 0.25; circle <= kMostSamples; circle *= kGrowth) {
        std::optional<glm::dvec3> nearest;
        double least = circle;
        for (int direction = 0; direction < kDirections; ++direction) {
            std::optional<glm::dvec3> found = at(direction, circle);
            if (!found) continue;
            double without = 0, with = circle;
            for (int n = 0; n < kHalvings; ++n) {
                const double middle = (without + with) / 2;
                const std::optional<glm::dvec3> nearer = at(direction, middle);
                (nearer ? with : without) = middle;
                if (nearer) found = nearer;
            }
            if (nearest && with >= least) continue;
            nearest = found;
            least = with;
        }
        if (nearest) return nearest;
    }
    return std::nullopt;
}

std::optional<double> GroundCaster::heightAt(double x, double y) const {
    const double u = (x - tiling_.west) / tiling_.finestSpacing - 0.5;
    const double v = (tiling_.north - y) / tiling_.finestSpacing - 0.5;
    const GridSize size = heights_.size();
    const bool inside = u >= -0.5 && v >= -0.5 && u <= static_cast<double>(size.width) - 0.5 &&
                        v <= static_cast<double>(size.height) - 0.5;
    if (!inside) return std::nullopt;
    const auto i = static_cast<int64_t>(std::floor(u));
    const auto j = static_cast<int64_t>(std::floor(v));
    const auto squareOf = [](int64_t patch) { return patch < 0 ? -1 : patch / kSquare; };
    const Patch patch(square({squareOf(j), squareOf(i)})->corners(i, j));
    const double inU = u - static_cast<double>(i);
    const double inV = v - static_cast<double>(j);
    const size_t owner = (inU >= 0.5 ? 1 : 0) + (inV >= 0.5 ? 2 : 0);
    if (!patch.exists[owner]) return std::nullopt;
    return patch.heightAt(inU, inV);
}

double GroundCaster::topOf(const GridRect& samples) const {
    const GridSize size = heights_.size();
    const GridRect shared = intersection(samples, {0, 0, size.width, size.height});
    return shared.empty() ? -kInfinity : heights_.upperBound(shared);
}

GroundCaster::SquarePointer GroundCaster::square(const SquareId& id) const {
    {
        const std::scoped_lock lock(mutex_);
        if (const auto found = loaded_.find(id); found != loaded_.end()) {
            recent_.splice(recent_.begin(), recent_, found->second);
            return found->second->second;
        }
    }
    SquarePointer made = load(id);  // two threads may both load it; one is kept
    const std::scoped_lock lock(mutex_);
    if (const auto found = loaded_.find(id); found != loaded_.end()) return found->second->second;
    recent_.emplace_front(id, made);
    loaded_[id] = recent_.begin();
    while (recent_.size() > mostSquares_) {
        loaded_.erase(recent_.back().first);
        recent_.pop_back();
    }
    return made;
}

GroundCaster::SquarePointer GroundCaster::load(const SquareId& id) const {
    constexpr int64_t kSide = kSquare + 3;  // samples: around the patches, and a ring
    auto made = std::make_shared<Square>();
    made->row = id.first * kSquare;
    made->column = id.second * kSquare;
    const GridRect samples{made->column - 1, made->row - 1, kSide, kSide};
    const GridSize size = heights_.size();
    const GridRect shared = intersection(samples, {0, 0, size.width, size.height});
    made->heights = Grid<double>({samples.width, samples.height}, std::numeric_limits<double>::quiet_NaN());
    if (!shared.empty()) {
        const Grid<double> read = heights_.read(shared);
        for (int64_t y = 0; y < shared.height; ++y)
            for (int64_t x = 0; x < shared.width; ++x)
                made->heights.at(x + shared.x - samples.x, y + shared.y - samples.y) = read.at(x, y);
    }
    made->tops = Grid<double>({kBlocks, kBlocks}, -kInfinity);
    for (int64_t y = 0; y < kSide; ++y)
        for (int64_t x = 0; x < kSide; ++x) {
            const double height = made->heights.at(x, y);
            if (std::isnan(height)) continue;
            // A sample belongs to each block whose patches it, or one beside it, is a corner of.
            const auto first = [](int64_t at) { return std::max<int64_t>(at - 3, 0) / kBlock; };
            const auto last = [](int64_t at) { return std::min(at / kBlock, kBlocks - 1); };
            for (int64_t blockY = first(y); blockY <= last(y); ++blockY)
                for (int64_t blockX = first(x); blockX <= last(x); ++blockX) {
                    double& top = made->tops.at(blockX, blockY);
                    top = std::max(top, height);
                }
        }
    return made;
}

}  // namespace terray
