#include "preprocess/synthetic_terrain.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace terray {

namespace {

constexpr int kMaxOctaves = 10;
constexpr int kProvinces = 100;  // channel of the noise that says where mountains are, beside those of the octaves

/// 0 below `from`, 1 above `to`, smooth between.
float smoothStep(float value, float from, float to) {
    const float t = std::clamp((value - from) / (to - from), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

struct Gradient {
    float x;
    float y;
};

/// One of eight directions of length 1 (up to rounding), none along an axis, where the lattice would show.
Gradient gradientAt(int64_t x, int64_t y, uint64_t channel, uint64_t seed) {
    constexpr float kCosine = 0.92387953f;  // of 22.5 degrees
    constexpr float kSine = 0.38268343f;
    static constexpr std::array<Gradient, 8> kDirections{{{kCosine, kSine},
                                                          {kSine, kCosine},
                                                          {-kSine, kCosine},
                                                          {-kCosine, kSine},
                                                          {-kCosine, -kSine},
                                                          {-kSine, -kCosine},
                                                          {kSine, -kCosine},
                                                          {kCosine, -kSine}}};
    return kDirections[hashPlace(x, y, channel, seed) >> 61];
}

/// Perlin's quintic, whose first and second derivative vanish at 0 and 1.
float fade(float t) {
    return t * t * t * (t * (t * 6 - 15) + 10);
}

/// Log2 of the coarsest wavelength in quarter samples: half the terrain, but no more than about 8 km.
int basePeriod(const SyntheticTerrain& terrain) {
    const double samples = std::min(static_cast<double>(terrain.size) / 2, 8000 / terrain.spacing);
    const auto quarterSamples = static_cast<uint64_t>(std::max(8.0, 4 * samples));
    return static_cast<int>(std::bit_width(quarterSamples)) - 1;
}

}  // namespace

uint64_t hashPlace(int64_t x, int64_t y, uint64_t channel, uint64_t seed) {
    // Multiply and shift as in MurmurHash3's and SplitMix64's finishers (public domain).
    uint64_t h = (seed ^ (channel * 0xd6e8feb86659fd93ULL)) + static_cast<uint64_t>(x) * 0x9e3779b97f4a7c15ULL;
    h = (h ^ (h >> 32)) * 0xbf58476d1ce4e5b9ULL + static_cast<uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL;
    h = (h ^ (h >> 29)) * 0x94d049bb133111ebULL;
    return h ^ (h >> 32);
}

TerrainFunction::TerrainFunction(const SyntheticTerrain& terrain)
    : seed_(hashPlace(0, 0, 0, terrain.seed)),
      basePeriodLog2_(basePeriod(terrain)),
      octaves_(std::min(kMaxOctaves, basePeriodLog2_ - 2)) {
    // A kilometre of ground gets hills, a hundred get mountains.
    const double extent = static_cast<double>(terrain.size) * terrain.spacing;
    relief_ = static_cast<float>(std::clamp(0.15 * extent, 1.0, 1500.0));
    lakeLevel_ = 0.1f * relief_;
}

/// Gradient noise of one octave, about -0.7 .. 0.7.
void TerrainFunction::noise(int64_t x, int64_t y, int64_t step, int octave, std::span<float> out) const {
    const int periodLog2 = octave == kProvinces ? basePeriodLog2_ + 1 : basePeriodLog2_ - octave;
    const int64_t period = int64_t{1} << periodLog2;
    const float perPeriod = 1.0f / static_cast<float>(period);  // a power of two: exact
    const auto channel = static_cast<uint64_t>(octave + 1);
    // Each octave's lattice is shifted by its own part of a period, so that their lines, where noise is 0, do not
    // coincide.
    const uint64_t shift = hashPlace(0, 0, channel, ~seed_);
    x += static_cast<int64_t>(shift >> 32) & (period - 1);
    y += static_cast<int64_t>(shift & 0xffffffff) & (period - 1);
    const int64_t cellY = y >> periodLog2;
    const float v = static_cast<float>(y - (cellY << periodLog2)) * perPeriod;
    const float fadeV = fade(v);
    for (size_t i = 0; i < out.size();) {
        // All places of one lattice cell share its four corners.
        const int64_t cellX = (x + static_cast<int64_t>(i) * step) >> periodLog2;
        const Gradient nw = gradientAt(cellX, cellY, channel, seed_);
        const Gradient ne = gradientAt(cellX + 1, cellY, channel, seed_);
        const Gradient sw = gradientAt(cellX, cellY + 1, channel, seed_);
        const Gradient se = gradientAt(cellX + 1, cellY + 1, channel, seed_);
        const int64_t first = x + static_cast<int64_t>(i) * step - (cellX << periodLog2);
        const auto inCell = static_cast<size_t>((period - first + step - 1) / step);
        const size_t count = std::min(inCell, out.size() - i);
        for (size_t j = 0; j < count; ++j) {
            const float u = static_cast<float>(first + static_cast<int64_t>(j) * step) * perPeriod;
            const float fadeU = fade(u);
            const float northWest = nw.x * u + nw.y * v;
            const float northEast = ne.x * (u - 1) + ne.y * v;
            const float southWest = sw.x * u + sw.y * (v - 1);
            const float southEast = se.x * (u - 1) + se.y * (v - 1);
            const float north = northWest + fadeU * (northEast - northWest);
            const float south = southWest + fadeU * (southEast - southWest);
            out[i + j] = north + fadeV * (south - north);
        }
        i += count;
    }
}

void TerrainFunction::heights(int64_t x, int64_t y, int64_t step, std::span<float> out) const {
    const size_t count = out.size();
    std::vector<float> octave(count);
    std::vector<float> hills(count, 0.0f);
    std::vector<float> ridges(count, 0.0f);
    std::vector<float> weights(count, 1.0f);  // ridges carry finer ridges, valleys stay smooth
    float amplitude = 1;
    for (int i = 0; i < octaves_; ++i, amplitude *= 0.5f) {
        noise(x, y, step, i, octave);
        for (size_t j = 0; j < count; ++j) {
            const float n = octave[j];
            const float crest = 1 - 1.4f * (n < 0 ? -n : n);
            const float ridge = crest * crest * weights[j];
            hills[j] += amplitude * n;
            ridges[j] += amplitude * ridge;
            weights[j] = std::clamp(1.6f * ridge, 0.1f, 1.0f);
        }
    }
    noise(x, y, step, kProvinces, octave);
    for (size_t j = 0; j < count; ++j) {
        const float mountains = smoothStep(octave[j] + 0.25f * hills[j], -0.1f, 0.35f);
        const float height = relief_ * (0.12f + 0.09f * hills[j] + 0.5f * mountains * ridges[j]);
        out[j] = std::max(height, lakeLevel_);
    }
}

}  // namespace terray
