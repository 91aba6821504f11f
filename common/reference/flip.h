#pragma once

#include "common/grid.h"
#include "common/rgba.h"

namespace terray {

/// How many pixels a degree of the viewer's field holds at a screen 0.7 m wide with 3840 columns, seen from 0.7 m: what
/// FLIP's authors take when nothing is known.
inline constexpr double kFlipPixelsPerDegree = 67.0206432765823;

/// How much each pixel of a picture differs from a reference to somebody who flips between both in place: 0 not at all,
/// 1 as much as can be. Alpha does not count.
///
/// LDR-FLIP: differences of colour after the eye's blur, raised where edges and points differ. Not symmetric by its
/// idea, but by its formulas: exchanging the pictures changes nothing.
///
/// Source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astrom and Fairchild 2020, "FLIP: A Difference Evaluator for
/// Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3 (2), DOI 10.1145/3406183; constants as there. Agrees
/// with the authors' own program (version 1.7) to 1e-5 a pixel; tests/reference/flip_test.cpp holds its values.
///
/// @param reference, test  8-bit sRGB of one size, not empty
/// @param pixelsPerDegree  above 0; filters grow with it: at 67 a pixel costs about a microsecond
[[nodiscard]] Grid<float> flipOf(GridView<const Rgba> reference, GridView<const Rgba> test,
                                 double pixelsPerDegree = kFlipPixelsPerDegree);

}  // namespace terray
