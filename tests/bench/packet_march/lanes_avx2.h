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
/// Two values at each of the four places whose indices the two words hold.
inline __m128i pairsAt(const uint16_t* values, uint64_t first, uint64_t second) {
    const auto pair = [&](uint32_t index) {
        int32_t bits;
        __builtin_memcpy(&bits, values + index, sizeof bits);
        return bits;
    };
    __m128i pairs = _mm_cvtsi32_si128(pair(static_cast<uint32_t>(first)));
    pairs = _mm_insert_epi32(pairs, pair(static_cast<uint32_t>(first >> 32)), 1);
    pairs = _mm_insert_epi32(pairs, pair(static_cast<uint32_t>(second)), 2);
    return _mm_insert_epi32(pairs, pair(static_cast<uint32_t>(second >> 32)), 3);
}
/// values[index] in the low half and values[index + 1] in the high half of each lane; anything where the mask is not
/// set, whatever the index is there. Single loads: on Zen 5 they take 5 cycles where vpgatherdd takes 12.
inline Int gatherPairs(const uint16_t* values, Int index, Int mask) {
    const __m256i safe = raw(index & mask);
    const __m128i low = _mm256_castsi256_si128(safe);
    const __m128i high = _mm256_extracti128_si256(safe, 1);
    const auto word = [](__m128i words, int half) {
        return static_cast<uint64_t>(half == 0 ? _mm_cvtsi128_si64(words) : _mm_extract_epi64(words, 1));
    };
    return lanes(
        _mm256_set_m128i(pairsAt(values, word(high, 0), word(high, 1)), pairsAt(values, word(low, 0), word(low, 1))));
}

}  // namespace terray::TERRAY_LANES
