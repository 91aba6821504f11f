#pragma once
// Eight floats or eight integers side by side, and what the packet march does with them.
//
// The march is compiled once for each instruction set, from the same headers. The .cpp that includes them first defines
//     TERRAY_LANES        its own namespace below terray, so that the linker never takes one set's code for another's
//     TERRAY_LANES_AVX2   1: AVX2 and FMA through intrinsics; 0: GCC's vector extensions, for any processor
// Nothing that the kernels include may define inline functions outside that namespace, for the same reason: they would
// be compiled with AVX2 and shared with code that runs without.
//
// + - * & | ^ ~ << >> and comparisons are the compiler's, lane by lane. A comparison answers a mask: an Int of all ones
// where it holds, else 0.

#include <cstdint>

namespace terray::TERRAY_LANES {

inline constexpr int kLanes = 8;
using Float = float __attribute__((vector_size(4 * kLanes)));
using Int = int32_t __attribute__((vector_size(4 * kLanes)));

}  // namespace terray::TERRAY_LANES

#if TERRAY_LANES_AVX2
#include "tests/bench/packet_march/lanes_avx2.h"
#else
#include "tests/bench/packet_march/lanes_portable.h"
#endif

namespace terray::TERRAY_LANES {

inline Int all(int32_t value) {
    return Int{} + value;
}
inline Float all(float value) {
    return value - Float{};
}
inline Int clamp(Int value, Int low, Int high) {
    return maximum(low, minimum(value, high));
}
inline Float clamp(Float value, Float low, Float high) {
    return maximum(low, minimum(value, high));
}
inline Float magnitude(Float value) {
    return asFloat(asInt(value) & 0x7fffffff);
}
/// value, with its sign turned where the mask is set.
inline Float negatedWhere(Int mask, Float value) {
    return asFloat(asInt(value) ^ (mask & INT32_MIN));
}

}  // namespace terray::TERRAY_LANES
