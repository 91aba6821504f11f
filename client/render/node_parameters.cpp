#include "client/render/node_parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace terray {
namespace {

/// What shading modes tell of a node: see TERRAY_HEIGHT_STAND_IN_BIT and below in shaders/interop.h.
uint32_t shadingBits(const DrawNode& node) {
    const TileId& tile = node.heightTile;
    const auto hash = static_cast<uint32_t>(std::hash<TileId>()(tile)) << 2 | tile.quadrant();
    return (node.heightsExact ? 0 : TERRAY_HEIGHT_STAND_IN_BIT) | (node.imageryExact ? 0 : TERRAY_PHOTO_STAND_IN_BIT) |
           tile.level << TERRAY_TILE_LEVEL_SHIFT | hash << TERRAY_TILE_HASH_SHIFT;
}

glm::vec4 withW(const glm::dvec3& xyz, double w) {
    return glm::vec4(glm::vec3(xyz), static_cast<float>(w));
}

/// The part of an ancestor's core, in its texels, that a cell covers: corner and side. Powers of two, so exact.
struct SubSquare {
    glm::dvec2 corner{0};
    double side = kTileCore;
};

SubSquare subSquare(const TileId& cell, const TileId& ancestor) {
    const uint32_t levels = cell.level - ancestor.level;
    const double side = std::ldexp(kTileCore, -static_cast<int>(levels));
    const auto column = static_cast<double>(cell.x - (uint64_t{ancestor.x} << levels));
    const auto row = static_cast<double>(cell.y - (uint64_t{ancestor.y} << levels));
    return {{column * side, row * side}, side};
}

constexpr double kUnbounded = 1e30;
constexpr float kManyPixels = 1e6F;
/// View depth in metres at which boxes around the eye are cut off, so that they have a projection: less than any ground
/// that is not at the eye, more than the roundings of corners.
constexpr double kNearest = 1e-9;

/// Distance from the eye to the farthest corner of a cell's box as it is seen, metres.
double farthestCorner(const DrawNode& node, const Tiling& tiling, const View& view) {
    const GroundRect ground = tiling.bounds(node.cell);
    const glm::dvec3& eye = view.eye;
    const double x = std::max(std::abs(eye.x - ground.west), std::abs(eye.x - ground.east));
    const double y = std::max(std::abs(eye.y - ground.south), std::abs(eye.y - ground.north));
    const double drop = view.earth ? dropOver(*view.earth, ground, glm::dvec2(eye)).greatest : 0;
    const double z = std::max(std::abs(eye.z - view.exaggeration * node.minHeight + drop),
                              std::abs(eye.z - view.exaggeration * node.maxHeight + drop));
    return std::hypot(x, y, z);
}

/// What a box needs more, in metres, when only its corners are lowered by the drop at their place.
struct Bulge {
    double down = 0;
    double up = 0;
};

/// The drop is a quadratic and the earth convex: over a square of side s the lowered top rises above the bilinear
/// surface through its corners by up to (xx + yy) s^2 / 4, and the two triangles that are drawn lie up to |xy| s^2 / 4
/// off that surface, up or down.
Bulge bulgeOver(const EarthCurvature& earth, double side) {
    const double down = std::abs(earth.xy) * side * side / 4;
    return {.down = down, .up = (earth.xx + earth.yy) * side * side / 4 + down};
}

/// Where a box's corners are seen, in pixels counted like gl_FragCoord, and, of edges that lead behind the eye, where
/// they come nearest.
std::vector<glm::dvec2> outlinePixels(const interop::NodeParameters& node, const View& view) {
    const glm::dvec3 scale(node.eye.w, -node.eye.w, node.right.w);  // tile frame to metres east, north, up
    std::array<glm::dvec3, 8> corners;                              // right, up, depth
    for (size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 corner((i & 1) != 0 ? node.boxMax.x : node.boxMin.x,
                                (i & 2) != 0 ? node.boxMax.y : node.boxMin.y,
                                (i & 4) != 0 ? node.boxMax.z : node.boxMin.z);
        glm::dvec3 fromEye = (corner - glm::dvec3(node.eye)) * scale;
        if (view.earth) {
            fromEye.z -= view.earth->drop(fromEye.x, fromEye.y);
            fromEye.z += (i & 4) != 0 ? node.boxMax.w : -node.boxMin.w;
        }
        corners[i] = {glm::dot(fromEye, view.right), glm::dot(fromEye, view.up), glm::dot(fromEye, view.forward)};
    }
    const glm::dvec2 size(view.width, view.height);
    const glm::dvec2 half(view.tanHalfWidth(), view.tanHalfHeight);
    std::vector<glm::dvec2> pixels;
    const auto take = [&](const glm::dvec3& point) {
        const glm::dvec2 slope(point.x / point.z, point.y / point.z);
        pixels.push_back((slope / half + 1.0) * 0.5 * size);
    };
    for (size_t i = 0; i < corners.size(); ++i) {
        if (corners[i].z >= kNearest) take(corners[i]);
        for (const size_t axis : {1, 2, 4}) {
            const glm::dvec3& a = corners[i];
            const glm::dvec3& b = corners[i ^ axis];
            if (a.z < kNearest && b.z > kNearest) take(glm::mix(a, b, (kNearest - a.z) / (b.z - a.z)));
        }
    }
    return pixels;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// Counter-clockwise (Andrew 1979, "Another efficient algorithm for convex hulls in two dimensions").
std::vector<glm::dvec2> convexHull(std::vector<glm::dvec2> points) {
    std::ranges::sort(points,
                      [](const glm::dvec2& a, const glm::dvec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    std::vector<glm::dvec2> hull;
    for (int side = 0; side < 2; ++side) {
        const size_t first = hull.size();
        for (const glm::dvec2& point : points) {
            while (hull.size() >= first + 2 && cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0)
                hull.pop_back();
            hull.push_back(point);
        }
        if (!hull.empty()) hull.pop_back();  // it begins the other side
        std::ranges::reverse(points);
    }
    return hull;
}

/// The part of a convex polygon where a linear function of the place is not negative (Sutherland and Hodgman 1974).
template <class Inside>
std::vector<glm::dvec2> clipped(const std::vector<glm::dvec2>& polygon, const Inside& inside) {
    std::vector<glm::dvec2> out;
    for (size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double atA = inside(a), atB = inside(b);
        if (atA >= 0) out.push_back(a);
        if ((atA >= 0) != (atB >= 0)) out.push_back(glm::mix(a, b, atA / (atA - atB)));
    }
    return out;
}

}  // namespace

glm::dvec2 eyeInTile(const TileId& heightTile, const Tiling& tiling, const glm::dvec3& eye) {
    const double spacing = tiling.spacing(heightTile.level);
    return {(eye.x - tiling.west) / spacing - double{kTileCore} * heightTile.x,
            (tiling.north - eye.y) / spacing - double{kTileCore} * heightTile.y};
}

glm::dvec2 onFloatGrid(const glm::dvec2& eye) {
    constexpr double kGrid = 0x1p-15;
    return glm::round(eye / kGrid) * kGrid;
}

double boxMargin(const DrawNode& node, const Tiling& tiling, const View& view, double eyeCode, double step) {
    constexpr double kRoundings = 0x1p-20;
    const double drop =
        view.earth ? dropOver(*view.earth, tiling.bounds(node.cell), glm::dvec2(view.eye)).greatest / step : 0;
    return 0.5 + kRoundings * (std::abs(eyeCode) + drop);
}

bool magnified(const DrawNode& node, const Tiling& tiling, const View& view) {
    const GroundRect ground = tiling.bounds(node.cell);
    const double x = std::max({ground.west - view.eye.x, view.eye.x - ground.east, 0.0});
    const double y = std::max({ground.south - view.eye.y, view.eye.y - ground.north, 0.0});
    const double z = std::max(
        {view.exaggeration * node.minHeight - view.eye.z, view.eye.z - view.exaggeration * node.maxHeight, 0.0});
    return tiling.spacing(node.heightTile.level) * view.focalPixels() > std::hypot(x, y, z);
}

glm::vec4 pixelBounds(const interop::NodeParameters& node, const View& view) {
    glm::dvec2 least(kUnbounded), greatest(-kUnbounded);
    for (const glm::dvec2& point : outlinePixels(node, view)) {
        least = glm::min(least, point);
        greatest = glm::max(greatest, point);
    }
    const GridRect part = view.drawn();
    const glm::dvec2 corner(part.x, view.height - part.y - part.height);
    least -= corner;
    greatest -= corner;
    return glm::clamp(glm::vec4(least - 1.0, greatest + 1.0), -kManyPixels, kManyPixels);
}

double coveredPixels(const interop::NodeParameters& node, const View& view) {
    std::vector<glm::dvec2> outline = convexHull(outlinePixels(node, view));
    for (const int axis : {0, 1}) {
        const double most = axis == 0 ? view.width : view.height;
        outline = clipped(outline, [&](const glm::dvec2& point) { return point[axis]; });
        outline = clipped(outline, [&](const glm::dvec2& point) { return most - point[axis]; });
    }
    double twiceArea = 0;
    for (size_t i = 0; i < outline.size(); ++i) twiceArea += cross(outline[i], outline[(i + 1) % outline.size()]);
    return std::abs(twiceArea) / 2;
}

interop::NodeParameters nodeParameters(const DrawNode& node, const NodeSource& source, const Tiling& tiling,
                                       const View& view) {
    TERRAY_CHECK(node.heightTile.covers(node.cell));
    const ResidentHeights& heights = source.heights;
    const double spacing = tiling.spacing(node.heightTile.level);
    const double heightStep = heights.encoding.metresPerCode();
    const double step = view.exaggeration * heightStep;
    const auto codeOf = [&](double height) {
        return height / heightStep - static_cast<double>(heights.encoding.offset);
    };
    const auto tileDirection = [&](const glm::dvec3& world) {
        return glm::dvec3(world.x / spacing, -world.y / spacing, world.z / step);
    };

    interop::NodeParameters out;
    const glm::dvec3 eye(onFloatGrid(eyeInTile(node.heightTile, tiling, view.eye)),
                         codeOf(view.eye.z / view.exaggeration));
    const double marginMetres = farthestCorner(node, tiling, view) / view.focalPixels();
    out.eye = withW(eye, spacing);
    out.right = withW(tileDirection(view.right * view.tanHalfWidth()), step);
    out.up = withW(tileDirection(view.up * view.tanHalfHeight), marginMetres);
    out.forward = withW(tileDirection(view.forward), view.exaggeration * heights.record.error);

    const double margin = boxMargin(node, tiling, view, eye.z, step);
    const SubSquare cell = subSquare(node.cell, node.heightTile);
    const Bulge bulge = view.earth ? bulgeOver(*view.earth, tiling.tileSide(node.cell.level)) : Bulge();
    out.boxMin = withW({cell.corner, codeOf(node.minHeight) - margin}, bulge.down);
    const double patchTop = heights.maxima.over(cell.corner.x, cell.corner.y, cell.side);
    double top = source.bilinear ? patchTop : codeOf(node.maxHeight);
    if (source.castsShadow) top = std::max(top, patchTop);
    out.boxMax = withW({cell.corner + cell.side, top + margin}, bulge.up);

    if (node.imageryTile && source.photoSlot != TERRAY_NO_SLOT) {
        // Both tiles contain the cell, so one contains the other: photo texels = offset + scale * height texels.
        const SubSquare inPhoto = subSquare(node.cell, *node.imageryTile);
        const double scale = inPhoto.side / cell.side;
        out.photo = withW({inPhoto.corner - scale * cell.corner, scale}, 0);
    } else {
        out.photo = glm::vec4(0);
    }
    // Paper 001, section 3.2: start below the single block that holds the cell, for every ray enters at its box.
    const auto below = static_cast<int>(node.cell.level - node.heightTile.level);
    // Patches are tried from level 1 (shaders/march.glsl).
    const int leaf = source.bilinear ? 1 : 0;
    const auto start = static_cast<uint32_t>(source.pyramid ? std::max(8 - below, leaf) : leaf);
    out.source = {heights.slot, node.imageryTile ? source.photoSlot : TERRAY_NO_SLOT, node.cell.level,
                  start | (source.bilinear ? TERRAY_BILINEAR_BIT : 0) | shadingBits(node)};
    return out;
}

glm::dvec3 worldFromTile(const TileId& heightTile, const HeightEncoding& encoding, const Tiling& tiling,
                         const glm::dvec3& tilePoint) {
    const GroundRect source = tiling.bounds(heightTile);
    const double spacing = tiling.spacing(heightTile.level);
    return {source.west + tilePoint.x * spacing, source.north - tilePoint.y * spacing,
            (tilePoint.z + static_cast<double>(encoding.offset)) * encoding.metresPerCode()};
}

}  // namespace terray
