#include "common/reference/picture_error.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "common/percentile.h"

namespace terray {
namespace {

constexpr size_t kColourChannels = 3;  // of the four

/// Calls use(greatest difference of a channel, sum of squared differences) for each pixel.
template <class Use>
void forEachDifference(GridView<const Rgba> a, GridView<const Rgba> b, Use use) {
    TERRAY_CHECK(a.size() == b.size());
    for (int64_t y = 0; y < a.height(); ++y)
        for (int64_t x = 0; x < a.width(); ++x) {
            int greatest = 0;
            int squares = 0;
            for (size_t channel = 0; channel < kColourChannels; ++channel) {
                const int difference = std::abs(a.at(x, y)[channel] - b.at(x, y)[channel]);
                greatest = std::max(greatest, difference);
                squares += difference * difference;
            }
            use(greatest, squares);
        }
}

}  // namespace

Spread spreadOf(std::span<const float> values) {
    if (values.empty()) return {};
    std::vector<float> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    const std::span<const float> ascending(sorted);
    return {.mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(sorted.size()),
            .median = percentile(ascending, 50),
            .p95 = percentile(ascending, 95),
            .p99 = percentile(ascending, 99),
            .max = ascending.back()};
}

std::optional<double> psnr(GridView<const Rgba> reference, GridView<const Rgba> test) {
    double sum = 0;
    forEachDifference(reference, test, [&](int, int squares) { sum += squares; });
    if (sum == 0) return std::nullopt;
    const double mean = sum / (static_cast<double>(reference.size().count()) * kColourChannels);
    return 10 * std::log10(255.0 * 255.0 / mean);
}

PictureError measurePictures(GridView<const Rgba> reference, GridView<const Rgba> test, const Grid<float>& flip) {
    TERRAY_CHECK(reference.size() == flip.size());
    int64_t differing = 0;
    int greatest = 0;
    forEachDifference(reference, test, [&](int ofPixel, int) {
        differing += ofPixel > 0 ? 1 : 0;
        greatest = std::max(greatest, ofPixel);
    });
    return {.flip = spreadOf(flip.cells()),
            .psnr = psnr(reference, test),
            .differing = static_cast<double>(differing) / static_cast<double>(reference.size().count()),
            .greatest = static_cast<uint32_t>(greatest)};
}

Rgba heatColour(float value) {
    const float third = 3 * std::clamp(value, 0.0F, 1.0F);  // one channel rises in each third
    const auto ramp = [&](float from) {
        return static_cast<uint8_t>(std::lround(255 * std::clamp(third - from, 0.0F, 1.0F)));
    };
    return {ramp(0), ramp(1), ramp(2), 255};
}

}  // namespace terray
