#pragma once
// Lanes for any processor: loops that the compiler turns into what it has; see lanes.h.

#include <cmath>
#include <cstdint>

namespace terray::TERRAY_LANES {

inline Float asFloat(Int bits) {
    return reinterpret_cast<Float>(bits);
}
inline Int asInt(Float value) {
    return reinterpret_cast<Int>(value);
}

inline Int select(Int mask, Int yes, Int no) {
    return (mask & yes) | (~mask & no);
}
inline Float select(Int mask, Float yes, Float no) {
    return asFloat(select(mask, asInt(yes), asInt(no)));
}
inline bool any(Int mask) {
    int32_t some = 0;
    for (int i = 0; i < kLanes; ++i) some |= mask[i];
    return some != 0;
}
inline Float minimum(Float a, Float b) {
    return select(a < b, a, b);
}
inline Float maximum(Float a, Float b) {
    return select(a > b, a, b);
}
inline Int minimum(Int a, Int b) {
    return select(a < b, a, b);
}
inline Int maximum(Int a, Int b) {
    return select(a > b, a, b);
}
/// a * b + c, rounded twice.
inline Float mulAdd(Float a, Float b, Float c) {
    return a * b + c;
}
inline Float squareRoot(Float value) {
    Float root;
    for (int i = 0; i < kLanes; ++i) root[i] = __builtin_sqrtf(value[i]);
    return root;
}
inline Float converted(Int value) {
    return __builtin_convertvector(value, Float);
}
/// Towards zero. Any integer where the value has no int32.
inline Int truncated(Float value) {
    constexpr float kLimit = 0x1p30f;
    const Float kept = select((value > -kLimit) & (value < kLimit), value, Float{});  // not for NaN either
    return __builtin_convertvector(kept, Int);
}
inline Int floored(Float value) {
    const Int towardsZero = truncated(value);
    return towardsZero + (converted(towardsZero) > value);  // a mask is -1
}
/// values[index] in the low half and values[index + 1] in the high half of each lane; anything where the mask is not
/// set, whatever the index is there.
inline Int gatherPairs(const uint16_t* values, Int index, Int mask) {
    Int pairs = {};
    for (int i = 0; i < kLanes; ++i) {
        if (mask[i] == 0) continue;
        const uint16_t* pair = values + index[i];
        pairs[i] = static_cast<int32_t>(pair[0] | static_cast<uint32_t>(pair[1]) << 16);
    }
    return pairs;
}

}  // namespace terray::TERRAY_LANES
