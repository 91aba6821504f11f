#pragma once

#include <cstdint>

#include "client/bench/shader_march.h"
#include "common/reference/ground_caster.h"

namespace terray {

// How far a hit may be from the truth, and why.
//
// Numbers have a relative rounding error of u: 2^-24 in float, 2^-53 in double. What follows counts roundings in the
// shaders' march and says what each does to the place of a ray, in metres, along any of the three axes. Let side be a
// tile's side, M = 1 + tanHalfWidth + tanHalfHeight, and t the view depth.
//
//   Eye in the tile frame.    One rounding of a number of at most side + M t.                  1 u (side + M t)
//   Pixel to -1 .. 1.         Division by the size (2.5 units in the last place by GLSL's
//                             rules) and a difference of numbers up to 2: below 7 u, times
//                             tan t.                                                           7 u M t
//   Direction.                Three roundings of axes, two products, two sums, each of at
//                             most M.                                                          4 u M t
//   Eye + t direction.        A product and a sum.                                             2 u (side + M t)
//   t of a box or an edge.    A difference, a reciprocal, a product: relative errors of t,
//                             along the ray.                                                   5 u M t
//   t within a patch.         A root and a quotient in forms without cancellation (math/
//                             contact.glsl), 8 u of a patch's width; added to t.               1 u (side + M t)
//
// Together 20 u (side + M t); 24 is granted. Heights are numbers of at most 65,536 codes + M t, and so are the sums in
// a patch: for the vertical axis side is 65,536 codes. Over a curved earth, drop(M t) is one more term of the height.
// World coordinates and the truth itself are doubles: 24 * 2^-53 of the coordinates on top.
//
// A quadratic's root is not stable: a ray that grazes a ridge meets it or passes. But each error above is the same as
// one of the ray, a displacement d(t) = 24 u (side + M t), so each hit is the exact hit of a displaced ray, or, the
// same, of the ray with a ground that is displaced. What a displaced ground may be lies between two extremes (Slack):
// higher by d and wider by d, and lower and narrower. So
//
//   a hit is right when it is not before the grown ground's, nor after the shrunk ground's;
//   sky is right when the shrunk ground is missed;
//   and the told place lies within d of the ray.
//
// Columns are the heights of places up to half a sample away. So for them the displacement of heights to the side
// is half a sample more, that of edges is not. Where two tiles with code steps of different size meet, shared samples
// are rounded twice: half a step each. Where coarser levels are drawn, the ground may be off by their tiles' error.
//
// Where it stops holding, that is, where it allows what one would not accept:
//   d in pixels is 24 u M focalPixels (float: 1.4e-6 M focal): a pixel when the field of view is 0.1 degrees and the
//   picture has 720 rows. Below that, float rays of neighbouring pixels are the same. (t cancels: distance does not
//   matter.)
//   d in samples, 24 u (512 + M t / spacing), is half a sample at t = 350,000 samples: there a hole or a pillar of one
//   sample may be missed. The truth's extremes are made for less than a sample; stability cases stay below.

/// The bound of a march over nodes of tiles of this side.
struct StabilityBound {
    Slack slack;           ///< heights and edges
    Slack::Line place;     ///< metres, along each axis: of the told place from the ray
    double placeBend = 0;  ///< for the vertical axis, per squared metre more
};

/// What the bound depends on beside the view.
struct BoundTerms {
    Precision precision = Precision::single;
    bool columns = false;
    double tileSide = 512;   ///< of the coarsest tile that is drawn, metres
    double spacing = 1;      ///< of the finest samples, metres
    double codeStep = 0.01;  ///< the greatest of a tile, metres
    double quantum = 0.01;   ///< the least
    double coordinates = 0;  ///< greatest absolute value of a coordinate, metres
    double relief = 0;       ///< by how much drawn levels may differ from the finest one, metres
};
[[nodiscard]] StabilityBound stabilityBound(const View& view, const BoundTerms& terms);

/// What a ray's end is worth.
enum class RayVerdict : uint8_t {
    right,
    notANumber,
    seeThrough,  ///< sky, though the shrunk ground is met
    coversSky,   ///< ground, though the grown one is missed
    misplaced,   ///< before the grown ground, after the shrunk one, or off the ray
};

/// @param lowest  the ground may end anywhere between this height and truth.floor()
[[nodiscard]] RayVerdict judgeRay(const GroundCaster& truth, const View& view, const glm::ivec2& pixel,
                                  const DrawnPixel& drawn, const StabilityBound& bound, double lowest);

}  // namespace terray
