#include "common/reference/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "common/srgb.h"

namespace terray {
namespace {

using std::numbers::pi;

/// Three numbers of a pixel, whatever the colour space.
using Colour = std::array<float, 3>;
using Plane = Grid<float>;
/// One plane for each of a colour space's three coordinates.
using Planes = std::array<Plane, 3>;

// --- Colour spaces ---------------------------------------------------------------------------------------------------

/// CIE XYZ over that of the white (D65), from linear light with the primaries of sRGB (IEC 61966-2-1): white is 1,
/// 1, 1.
Colour whiteRelative(const Colour& light) {
    constexpr double kMatrix[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                      {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                      {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};
    Colour xyz{};
    for (size_t row = 0; row < 3; ++row) {
        const auto& m = kMatrix[row];
        xyz[row] = static_cast<float>((m[0] * light[0] + m[1] * light[1] + m[2] * light[2]) / (m[0] + m[1] + m[2]));
    }
    return xyz;
}

/// The inverse of whiteRelative(), by Cramer's rule from three lights that span the space.
Colour lightFromWhiteRelative(const Colour& xyz) {
    const auto cross = [](const Colour& a, const Colour& b) {
        return std::array<double, 3>{double{a[1]} * b[2] - double{a[2]} * b[1],
                                     double{a[2]} * b[0] - double{a[0]} * b[2],
                                     double{a[0]} * b[1] - double{a[1]} * b[0]};
    };
    static const std::array<Colour, 3> kPrimaries{whiteRelative({1, 0, 0}), whiteRelative({0, 1, 0}),
                                                  whiteRelative({0, 0, 1})};
    static const std::array<std::array<double, 3>, 3> kRows = [&] {
        std::array<std::array<double, 3>, 3> rows{};
        for (size_t n = 0; n < 3; ++n) {
            const Colour& own = kPrimaries[n];
            const auto normal = cross(kPrimaries[(n + 1) % 3], kPrimaries[(n + 2) % 3]);
            const double volume = normal[0] * own[0] + normal[1] * own[1] + normal[2] * own[2];
            for (size_t k = 0; k < 3; ++k) rows[n][k] = normal[k] / volume;
        }
        return rows;
    }();
    Colour light{};
    for (size_t n = 0; n < 3; ++n)
        light[n] = static_cast<float>(kRows[n][0] * xyz[0] + kRows[n][1] * xyz[1] + kRows[n][2] * xyz[2]);
    return light;
}

/// A linear cousin of CIELab: luminance, and two opponent axes. Source: section 4.1.1.
Colour opponentFromLight(const Colour& light) {
    const Colour xyz = whiteRelative(light);
    return {116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])};
}

Colour lightFromOpponent(const Colour& opponent) {
    const float y = (opponent[0] + 16) / 116;
    return lightFromWhiteRelative({y + opponent[1] / 500, y, y - opponent[2] / 200});
}

/// CIELab with chroma that fades in the dark (Hunt's effect). Source: section 4.1.2.
Colour perceivedFromLight(const Colour& light) {
    const auto compressed = [](float value) {
        constexpr float kDelta = 6.0F / 29;
        return value > kDelta * kDelta * kDelta ? std::cbrt(value) : value / (3 * kDelta * kDelta) + 4.0F / 29;
    };
    const Colour xyz = whiteRelative(light);
    const float x = compressed(xyz[0]);
    const float y = compressed(xyz[1]);
    const float z = compressed(xyz[2]);
    const float lightness = 116 * y - 16;
    const float hunt = 0.01F * lightness;
    return {lightness, hunt * 500 * (x - y), hunt * 200 * (y - z)};
}

// --- Filters ---------------------------------------------------------------------------------------------------------

/// Weights of 2 radius + 1 neighbours along one axis.
using Taps = std::vector<double>;

/// @param weight  of a neighbour so many pixels away
template <class Weight>
Taps tapsOf(int radius, Weight weight) {
    Taps taps;
    for (int x = -radius; x <= radius; ++x) taps.push_back(weight(static_cast<double>(x)));
    return taps;
}

// Beyond its border a picture goes on as its last pixel.

Plane filteredAlongRows(const Plane& from, const Taps& taps) {
    Plane to(from.size());
    const auto radius = static_cast<int64_t>(taps.size() / 2);
    std::vector<double> extended(static_cast<size_t>(from.width() + 2 * radius));
    for (int64_t y = 0; y < from.height(); ++y) {
        const std::span<const float> row = from.view().row(y);
        std::fill(extended.begin(), extended.begin() + radius, row.front());
        std::copy(row.begin(), row.end(), extended.begin() + radius);
        std::fill(extended.end() - radius, extended.end(), row.back());
        const std::span<float> filteredRow = to.view().row(y);
        for (size_t x = 0; x < filteredRow.size(); ++x)
            filteredRow[x] = static_cast<float>(
                std::inner_product(taps.begin(), taps.end(), extended.begin() + static_cast<int64_t>(x), 0.0));
    }
    return to;
}

Plane filteredAlongColumns(const Plane& from, const Taps& taps) {
    Plane to(from.size());
    const auto radius = static_cast<int64_t>(taps.size() / 2);
    std::vector<double> sums(static_cast<size_t>(from.width()));
    for (int64_t y = 0; y < from.height(); ++y) {
        std::fill(sums.begin(), sums.end(), 0.0);
        for (int64_t n = -radius; n <= radius; ++n) {
            const std::span<const float> row = from.view().row(std::clamp<int64_t>(y + n, 0, from.height() - 1));
            const double tap = taps[static_cast<size_t>(n + radius)];
            for (size_t x = 0; x < sums.size(); ++x) sums[x] += tap * row[x];
        }
        std::copy(sums.begin(), sums.end(), to.view().row(y).begin());
    }
    return to;
}

Plane filtered(const Plane& from, const Taps& alongX, const Taps& alongY) {
    return filteredAlongColumns(filteredAlongRows(from, alongX), alongY);
}

/// The eye's sensitivity to contrast along one opponent axis, as the sum of two Gaussians: amplitude and width of each.
/// Source: section 4.1.1, table 1.
struct Sensitivity {
    double a1, b1, a2, b2;
};
constexpr std::array<Sensitivity, 3> kSensitivities{
    {{1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};
constexpr double kWidestGaussian = 0.04;

/// What the eye at its distance makes of a plane.
Plane blurred(const Plane& plane, const Sensitivity& eye, double pixelsPerDegree) {
    const auto radius = static_cast<int>(std::ceil(3 * std::sqrt(kWidestGaussian / (2 * pi * pi)) * pixelsPerDegree));
    Plane sum(plane.size());
    double total = 0;
    const auto add = [&](double amplitude, double width) {
        if (amplitude == 0) return;
        const Taps taps = tapsOf(radius, [&](double x) {
            const double degrees = x / pixelsPerDegree;
            return std::exp(-pi * pi / width * degrees * degrees);
        });
        const double ofTaps = std::accumulate(taps.begin(), taps.end(), 0.0);
        const double factor = amplitude * std::sqrt(pi / width);
        total += factor * ofTaps * ofTaps;
        const Plane part = filtered(plane, taps, taps);
        for (size_t n = 0; n < sum.cells().size(); ++n) sum.cells()[n] += static_cast<float>(factor * part.cells()[n]);
    };
    add(eye.a1, eye.b1);
    add(eye.a2, eye.b2);
    for (float& value : sum.cells()) value = static_cast<float>(value / total);
    return sum;
}

/// Scales positive taps to a sum of 1 and negative ones to a sum of -1.
Taps balanced(Taps taps) {
    double positive = 0;
    double negative = 0;
    for (const double tap : taps) (tap > 0 ? positive : negative) += std::abs(tap);
    for (double& tap : taps)
        if (tap != 0) tap /= tap > 0 ? positive : negative;
    return taps;
}

/// Strength of edges and of points in a picture's luminance. Source: section 4.2.
struct Features {
    Plane edges;
    Plane points;
};

Plane lengths(const Plane& x, const Plane& y) {
    Plane length(x.size());
    for (size_t n = 0; n < length.cells().size(); ++n) length.cells()[n] = std::hypot(x.cells()[n], y.cells()[n]);
    return length;
}

Features featuresOf(const Plane& luminance, double pixelsPerDegree) {
    constexpr double kEdgeWidthDegrees = 0.082;  // of the edges that the eye finds best
    const double deviation = 0.5 * kEdgeWidthDegrees * pixelsPerDegree;
    const auto radius = static_cast<int>(std::ceil(3 * deviation));
    const auto bell = [&](double x) { return std::exp(-x * x / (2 * deviation * deviation)); };
    const Taps smooth = balanced(tapsOf(radius, bell));
    const Taps slope = balanced(tapsOf(radius, [&](double x) { return -x * bell(x); }));
    const Taps bend =
        balanced(tapsOf(radius, [&](double x) { return (x * x / (deviation * deviation) - 1) * bell(x); }));
    return {lengths(filtered(luminance, slope, smooth), filtered(luminance, smooth, slope)),
            lengths(filtered(luminance, bend, smooth), filtered(luminance, smooth, bend))};
}

// --- Differences -----------------------------------------------------------------------------------------------------

/// Distance for large differences too: along lightness as in a city, across chroma as the crow flies (section 4.1.3).
float cityChromaDistance(const Colour& a, const Colour& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

/// A distance of colours as 0 .. 1: the small ones spread out over most of it (section 4.1.3).
float colourError(float distance) {
    constexpr float kExponent = 0.7F;
    constexpr float kKnee = 0.4F;          // of the greatest distance ...
    constexpr float kErrorAtKnee = 0.95F;  // ... becomes this
    static const float kGreatest =
        std::pow(cityChromaDistance(perceivedFromLight({0, 1, 0}), perceivedFromLight({0, 0, 1})), kExponent);
    const float powered = std::pow(distance, kExponent);
    const float knee = kKnee * kGreatest;
    if (powered < knee) return kErrorAtKnee / knee * powered;
    return kErrorAtKnee + (powered - knee) / (kGreatest - knee) * (1 - kErrorAtKnee);
}

/// A picture as FLIP sees it: what the eye perceives of its colours, and its features.
struct Seen {
    Grid<Colour> colours;
    Features features;
};

Planes opponentPlanes(GridView<const Rgba> picture) {
    Planes planes{Plane(picture.size()), Plane(picture.size()), Plane(picture.size())};
    for (int64_t y = 0; y < picture.height(); ++y)
        for (int64_t x = 0; x < picture.width(); ++x) {
            const Rgba& pixel = picture.at(x, y);
            const Colour opponent =
                opponentFromLight({linearFromSrgb(pixel[0]), linearFromSrgb(pixel[1]), linearFromSrgb(pixel[2])});
            for (size_t n = 0; n < 3; ++n) planes[n].at(x, y) = opponent[n];
        }
    return planes;
}

Grid<Colour> perceived(const Planes& opponent) {
    Grid<Colour> colours(opponent[0].size());
    for (size_t n = 0; n < colours.cells().size(); ++n) {
        Colour light = lightFromOpponent({opponent[0].cells()[n], opponent[1].cells()[n], opponent[2].cells()[n]});
        for (float& channel : light) channel = std::clamp(channel, 0.0F, 1.0F);
        colours.cells()[n] = perceivedFromLight(light);
    }
    return colours;
}

Seen look(GridView<const Rgba> picture, double pixelsPerDegree) {
    Planes opponent = opponentPlanes(picture);
    Plane luminance(picture.size());
    for (size_t n = 0; n < luminance.cells().size(); ++n) luminance.cells()[n] = (opponent[0].cells()[n] + 16) / 116;
    for (size_t n = 0; n < 3; ++n) opponent[n] = blurred(opponent[n], kSensitivities[n], pixelsPerDegree);
    return {perceived(opponent), featuresOf(luminance, pixelsPerDegree)};
}

/// How much a pixel's edge or point differs, 0 .. 1 (section 4.2).
float featureError(const Features& a, const Features& b, size_t pixel) {
    const float edges = std::abs(a.edges.cells()[pixel] - b.edges.cells()[pixel]);
    const float points = std::abs(a.points.cells()[pixel] - b.points.cells()[pixel]);
    return std::sqrt(std::max(edges, points) / std::numbers::sqrt2_v<float>);
}

}  // namespace

Grid<float> flipOf(GridView<const Rgba> reference, GridView<const Rgba> test, double pixelsPerDegree) {
    TERRAY_CHECK(reference.size() == test.size());
    TERRAY_CHECK_OP(reference.size().count(), >, 0);
    TERRAY_CHECK_OP(pixelsPerDegree, >, 0);
    const Seen a = look(reference, pixelsPerDegree);
    const Seen b = look(test, pixelsPerDegree);
    Grid<float> errors(reference.size());
    for (size_t n = 0; n < errors.cells().size(); ++n) {
        const float colour = colourError(cityChromaDistance(a.colours.cells()[n], b.colours.cells()[n]));
        errors.cells()[n] = std::pow(colour, 1 - featureError(a.features, b.features, n));
    }
    return errors;
}

}  // namespace terray
