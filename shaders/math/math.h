// The modules of this folder as C++, twice: terray::mathf in float and terray::mathd in double. Double against float of
// the same code shows rounding error; double against an independent reference shows the algorithm's (design, section
// 5).
#pragma once

#include <cmath>

#include <glm/glm.hpp>

#define REAL(number) static_cast<real>(number)
#define OUT(type) type&
#define MATH_FUNCTION [[maybe_unused, nodiscard]] inline

namespace terray::mathf {
using real = float;
using glm::abs, glm::exp, glm::floor, glm::length, glm::max, glm::min, glm::sqrt;
using ivec2 = glm::ivec2;
using vec2 = glm::vec<2, real>;
using vec3 = glm::vec<3, real>;
#include "math/air.glsl"
#include "math/atmosphere.glsl"
#include "math/bend.glsl"
#include "math/box.glsl"
#include "math/cell_walk.glsl"
#include "math/column.glsl"
#include "math/contact.glsl"
#include "math/footprint.glsl"
#include "math/patch.glsl"
}  // namespace terray::mathf

#undef TERRAY_MATH_PORTABLE
#undef TERRAY_MATH_AIR
#undef TERRAY_MATH_ATMOSPHERE
#undef TERRAY_MATH_BEND
#undef TERRAY_MATH_BOX
#undef TERRAY_MATH_CELL_WALK
#undef TERRAY_MATH_COLUMN
#undef TERRAY_MATH_CONTACT
#undef TERRAY_MATH_FOOTPRINT
#undef TERRAY_MATH_PATCH

namespace terray::mathd {
using real = double;
using glm::abs, glm::exp, glm::floor, glm::length, glm::max, glm::min, glm::sqrt;
using ivec2 = glm::ivec2;
using vec2 = glm::vec<2, real>;
using vec3 = glm::vec<3, real>;
#include "math/air.glsl"
#include "math/atmosphere.glsl"
#include "math/bend.glsl"
#include "math/box.glsl"
#include "math/cell_walk.glsl"
#include "math/column.glsl"
#include "math/contact.glsl"
#include "math/footprint.glsl"
#include "math/patch.glsl"
}  // namespace terray::mathd

#undef REAL
#undef OUT
#undef MATH_FUNCTION
