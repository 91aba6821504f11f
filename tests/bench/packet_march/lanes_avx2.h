#pragma once
// Lanes by AVX2 and FMA; see lanes.h.

#include <cstdint>

#include <immintrin.h>

namespace terray::TERRAY_LANES {

// Reinterpretations, no instructions.
inline Float asFloat(Int bits) {
    return reinterpret_cast<Float>(bits);
}
inline Int asInt(Float value) {
    return reinterpret_cast<Int>(value);
}
inline __m256i raw(Int value) {
    return reinterpret_cast<__m256i>(value);
}
inline Int lanes(__m256i value) {
    return reinterpret_cast<Int>(value);
}

inline Float select(Int mask, Float yes, Float no) {
    return _mm256_blendv_ps(no, yes, asFloat(mask));
}
inline Int select(Int mask, Int yes, Int no) {
    return asInt(select(mask, asFloat(yes), asFloat(no)));
}
inline bool any(Int mask) {
    return _mm256_movemask_ps(asFloat(mask)) != 0;
}
inline Float minimum(Float a, Float b) {
    return _mm256_min_ps(a, b);
}
inline Float maximum(Float a, Float b) {
    return _mm256_max_ps(a, b);
}
inline Int minimum(Int a, Int b) {
    return lanes(_mm256_min_epi32(raw(a), raw(b)));
}
inline Int maximum(Int a, Int b) {
    return lanes(_mm256_max_epi32(raw(a), raw(b)));
}
/// a * b + c, rounded once.
inline Float mulAdd(Float a, Float b, Float c) {
    return _mm256_fmadd_ps(a, b, c);
}
inline Float squareRoot(Float value) {
    return _mm256_sqrt_ps(value);
}
inline Float converted(Int value) {
    return _mm256_cvtepi32_ps(raw(value));
}
/// Towards zero. Any integer where the value has no int32.
inline Int truncated(Float value) {
    return lanes(_mm256_cvttps_epi32(value));
}
inline Int floored(Float value) {
    return truncated(_mm256_floor_ps(value));
}
/// values[index] in the low half and values[index + 1] in the high half of each lane; 0 where the mask is not set, and
/// nothing is read there.
inline Int gatherPairs(const uint16_t* values, Int index, Int mask) {
    return lanes(_mm256_mask_i32gather_epi32(_mm256_setzero_si256(), reinterpret_cast<const int*>(values), raw(index),
                                             raw(mask), sizeof(uint16_t)));
}

}  // namespace terray::TERRAY_LANES
