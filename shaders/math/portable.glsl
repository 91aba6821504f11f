// math/portable.glsl: what lets the modules of this folder compile as GLSL, as C++ in float and as C++ in double.
//
// Rules for these modules: no samplers, no swizzles, number literals through REAL(), out parameters through OUT(type),
// only functions that GLSL and GLM share. In C++ (math/math.h) `real` is float or double and vec3 follows it.
#ifndef TERRAY_MATH_PORTABLE
#define TERRAY_MATH_PORTABLE
#ifndef __cplusplus
#define real float
#define REAL(number) number
#define OUT(type) out type
#define MATH_FUNCTION
#endif
#endif
