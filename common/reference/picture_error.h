#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/grid.h"
#include "common/reference/flip.h"
#include "common/rgba.h"

namespace terray {

/// Mean and nearest-rank percentiles of a number over a picture.
struct Spread {
    double mean = 0;
    double median = 0;
    double p95 = 0;
    double p99 = 0;
    double max = 0;

    bool operator==(const Spread&) const = default;
};

/// Of finite values in any order; none: all 0.
[[nodiscard]] Spread spreadOf(std::span<const float> values);

/// How far a picture is from a reference of the same size.
struct PictureError {
    Spread flip;                 ///< over pixels, see flipOf()
    std::optional<double> psnr;  ///< dB over red, green and blue as stored (sRGB); none: the pictures are equal
    double differing = 0;        ///< part of the pixels, 0 .. 1, of which a channel differs
    uint32_t greatest = 0;       ///< difference of any channel, 0 .. 255
};

/// Alpha does not count. @param flip  of the same two pictures
[[nodiscard]] PictureError measurePictures(GridView<const Rgba> reference, GridView<const Rgba> test,
                                           const Grid<float>& flip);

/// Peak signal-to-noise ratio, 10 log10(255^2 / mean squared difference) over the three channels; none when equal.
[[nodiscard]] std::optional<double> psnr(GridView<const Rgba> reference, GridView<const Rgba> test);

/// A number 0 .. 1 as a colour, for maps of errors: black over red and yellow to white, lighter all the way.
[[nodiscard]] Rgba heatColour(float value);

}  // namespace terray
