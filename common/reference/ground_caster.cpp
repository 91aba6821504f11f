#include "common/reference/ground_caster.h"

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

/// 512 x 512 patches with the samples around them. Patch (i, j) lies between samples i, i + 1 and j, j + 1.
struct GroundCaster::Square {
    int64_t column = 0;  ///< of its first patch
    int64_t row = 0;
    Grid<double> heights;  ///< 513 x 513; NaN: no surface
    Grid<double> tops;     ///< of each block, its highest sample; -infinity: no surface

    /// Samples 0, 0; 1, 0; 0, 1; 1, 1 of a patch.
    [[nodiscard]] std::array<double, 4> corners(int64_t i, int64_t j) const {
        const int64_t x = i - column;
        const int64_t y = j - row;
        return {heights.at(x, y), heights.at(x + 1, y), heights.at(x, y + 1), heights.at(x + 1, y + 1)};
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

/// First contact with a patch, or with those quarters of it that exist.
std::optional<double> meetPatch(const Patch& patch, int64_t i, int64_t j, const PlaneLine& line,
                                const Quadratic& height, const Stretch& stretch) {
    const auto meetPart = [&](const Stretch& part) -> std::optional<double> {
        const double u = std::clamp(line.x(part.from) - static_cast<double>(i), 0.0, 1.0);
        const double v = std::clamp(line.y(part.from) - static_cast<double>(j), 0.0, 1.0);
        const auto s = firstBelow(clearanceOf(patch, line, height, part.from, u, v), {0, part.to - part.from});
        return s ? std::optional(part.from + *s) : std::nullopt;
    };
    if (patch.count == 0) return std::nullopt;
    if (patch.count == 4) return meetPart(stretch);
    std::optional<double> contact;
    walkSquares(line, 0.5, {2 * i, 2 * j, 2, 2}, stretch, [&](int64_t x, int64_t y, const Stretch& part) {
        const auto owner = static_cast<size_t>((x - 2 * i) + 2 * (y - 2 * j));
        if (patch.exists[owner]) contact = meetPart(part);
        return contact.has_value();
    });
    return contact;
}

}  // namespace

GroundCaster::GroundCaster(const ReferenceHeights& heights, const Tiling& tiling, double floor, uint64_t budgetBytes)
    : heights_(heights),
      tiling_(tiling),
      floor_(floor),
      mostSquares_(std::max<uint64_t>(budgetBytes / (sizeof(double) * (kSquare + 1) * (kSquare + 1)), 1)) {}

GroundCaster::~GroundCaster() = default;

std::optional<double> GroundCaster::meet(const View& view, const glm::dvec3& direction) const {
    const double spacing = tiling_.finestSpacing;
    const double bend = view.earth ? view.earth->drop(direction.x, direction.y) : 0;
    const Ray ray{
        .line = {(view.eye.x - tiling_.west) / spacing - 0.5, (tiling_.north - view.eye.y) / spacing - 0.5,
                 direction.x / spacing, -direction.y / spacing},
        .height = {bend / view.exaggeration, direction.z / view.exaggeration, view.eye.z / view.exaggeration}};
    const std::optional<Stretch> whole = overGround(ray);
    if (!whole) return std::nullopt;

    const auto clears = [&](double top, const Stretch& part) { return ray.height.at(ray.height.leastAt(part)) > top; };
    const GridSize size = heights_.size();
    const GridRect squares{-1, -1, (size.width - 1) / kSquare + 2, (size.height - 1) / kSquare + 2};
    std::optional<double> contact;
    const auto meetSquare = [&](int64_t column, int64_t row, const Stretch& inSquare) {
        if (clears(topOf({column * kSquare, row * kSquare, kSquare + 1, kSquare + 1}), inSquare)) return false;
        const SquarePointer loaded = square({row, column});
        const auto meetBlock = [&](int64_t blockX, int64_t blockY, const Stretch& inBlock) {
            if (clears(loaded->tops.at(blockX - column * kBlocks, blockY - row * kBlocks), inBlock)) return false;
            return walkSquares(ray.line, 1, {blockX * kBlock, blockY * kBlock, kBlock, kBlock}, inBlock,
                               [&](int64_t i, int64_t j, const Stretch& inPatch) {
                                   contact =
                                       meetPatch(Patch(loaded->corners(i, j)), i, j, ray.line, ray.height, inPatch);
                                   return contact.has_value();
                               });
        };
        return walkSquares(ray.line, kBlock, {column * kBlocks, row * kBlocks, kBlocks, kBlocks}, inSquare, meetBlock);
    };
    walkSquares(ray.line, kSquare, squares, *whole, meetSquare);
    return contact;
}

/// The part of a ray over samples and not below the floor. A ray that sinks below it has passed the ground.
std::optional<Stretch> GroundCaster::overGround(const Ray& ray) const {
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
    clip(ray.line.startX, ray.line.changeX, -0.5, static_cast<double>(size.width) - 0.5);
    clip(ray.line.startY, ray.line.changeY, -0.5, static_cast<double>(size.height) - 0.5);
    if (!(part.from <= part.to) || std::isinf(part.from)) return std::nullopt;
    if (std::isinf(part.to)) {  // straight up or down: t is bounded by its height alone
        if (ray.height.b == 0) return Stretch{0, 0};
        part.to = std::max((floor_ - ray.height.c) / ray.height.b, 0.0);
        if (ray.height.b > 0) return Stretch{part.to, part.to};  // it meets where it starts, or never
        if (ray.height.c < floor_) return std::nullopt;
        return part;
    }
    const Quadratic aboveFloor{ray.height.a, ray.height.b, ray.height.c - floor_};
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
    auto made = std::make_shared<Square>();
    made->row = id.first * kSquare;
    made->column = id.second * kSquare;
    const GridRect samples{made->column, made->row, kSquare + 1, kSquare + 1};
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
    for (int64_t y = 0; y <= kSquare; ++y)
        for (int64_t x = 0; x <= kSquare; ++x) {
            const double height = made->heights.at(x, y);
            if (std::isnan(height)) continue;
            // A sample on the line between two blocks belongs to both.
            for (int64_t blockY = std::max<int64_t>(y - 1, 0) / kBlock; blockY <= std::min(y / kBlock, kBlocks - 1);
                 ++blockY)
                for (int64_t blockX = std::max<int64_t>(x - 1, 0) / kBlock; blockX <= std::min(x / kBlock, kBlocks - 1);
                     ++blockX) {
                    double& top = made->tops.at(blockX, blockY);
                    top = std::max(top, height);
                }
        }
    return made;
}

}  // namespace terray
