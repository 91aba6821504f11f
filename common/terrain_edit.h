#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "common/tiling.h"

// Changes of the ground that a program makes at run time: craters (paper 003, section 3.6) and brush strokes. Plain
// values, applied in order; the dataset is never written. Places are in the dataset's coordinates, metres of its plane.

namespace terray {

/// A straight part of the line along which an edit works. from == to: a point.
struct EditSegment {
    glm::dvec2 from{0};
    glm::dvec2 to{0};
    bool operator==(const EditSegment&) const = default;
};

/// One change: what it does to a height h depends on the distance d of the place to the edit's line.
///
/// crater   Paper 003 adds a crater's height map to the ground; this is a crater in closed form, a bowl that is a
///          paraboloid and a rim that falls off to both sides. With r = d / radius,
///              h + (depth + rim) r^2 - depth  for r <= 1,    h + rim (2 - r)^2  for 1 <= r <= 2,    h beyond:
///          continuous, without slope at its centre and where it ends, with a crest at r = 1 as fresh craters have.
/// raise    h + w height; negative heights lower. w is 1 up to `full` from the line, 0 from `radius` on, and between
///          them 1 - 3 t^2 + 2 t^3 with t = (d - full) / (radius - full).
/// level    (1 - w) h + w height: towards one height, reached up to `full` from the line.
///
/// So every edit, and every list of them, is h -> a h + b at a place, with 0 <= a <= 1: it keeps the order of heights
/// and never takes two of them farther apart. Where there is no surface there still is none.
struct TerrainEdit {
    enum class Kind : uint8_t { crater, raise, level };
    Kind kind = Kind::raise;
    std::vector<EditSegment> line;  ///< at least one; of a crater one, a point
    double radius = 1;              ///< metres, > 0: of a crater's crest; where a stroke ends beside its line
    double full = 0;                ///< metres, strokes: 0 <= full < radius
    /// Metres. crater: depth >= 0 of its centre below the ground; raise: added; level: height in the dataset's datum.
    double height = 0;
    double rim = 0;  ///< metres, >= 0: of a crater's crest above the ground
    bool operator==(const TerrainEdit&) const = default;
};

/// In the order in which they are applied.
using EditList = std::vector<TerrainEdit>;

/// Limits: radii and a level's height to 10,000 km; what all edits together may lower or raise to 10,000 km, so that
/// edited heights always have an encoding (HeightEncoding::covering).
inline constexpr double kMostEditMetres = 1e7;
/// Whether every edit is as its members' comments say and the limits hold.
[[nodiscard]] bool valid(std::span<const TerrainEdit> edits);

/// The line through some points; one point: a segment of length 0.
[[nodiscard]] std::vector<EditSegment> segmentsThrough(std::span<const glm::dvec2> points);

[[nodiscard]] double distanceToSegment(glm::dvec2 place, const EditSegment& segment);

/// The distance from its line at which an edit ends: there and beyond it changes nothing, to the last bit.
[[nodiscard]] double reachOf(const TerrainEdit& edit);

/// A height after some edits, metres.
[[nodiscard]] double editedHeight(double height, glm::dvec2 place, std::span<const TerrainEdit> edits);

/// The edits that may change something within a rectangle, of their lines only the segments within reach of it: over
/// the rectangle they do exactly what the whole list does.
[[nodiscard]] EditList editsNear(std::span<const TerrainEdit> edits, const GroundRect& rect);

/// The bounding rectangle of what an edit may change.
[[nodiscard]] GroundRect footprint(const TerrainEdit& edit);

/// A rectangle widened by some metres on each side.
[[nodiscard]] constexpr GroundRect widened(const GroundRect& rect, double metres) {
    return {rect.west - metres, rect.south - metres, rect.east + metres, rect.north + metres};
}

}  // namespace terray
