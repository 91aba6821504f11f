#include "common/reference/picture_error.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace terray {
namespace {

constexpr GridSize kSize{20, 10};

Grid<Rgba> plain(uint8_t grey) {
    return Grid<Rgba>(kSize, {grey, grey, grey, 255});
}

TEST(Psnr, OfAConstantShiftIsItsRatioToWhite) {
    for (const int shift : {1, 16, 100})
        EXPECT_NEAR(psnr(plain(80).view(), plain(static_cast<uint8_t>(80 + shift)).view()).value(),
                    20 * std::log10(255.0 / shift), 1e-12);
    EXPECT_NEAR(psnr(plain(0).view(), plain(255).view()).value(), 0, 1e-12);
}

TEST(Psnr, OfOneChannelOfOnePixelIsThatMuchBetter) {
    Grid<Rgba> other = plain(80);
    other.at(3, 4)[2] = 90;
    EXPECT_NEAR(psnr(plain(80).view(), other.view()).value(), 20 * std::log10(25.5) + 10 * std::log10(600), 1e-12);
}

TEST(Psnr, EqualPicturesHaveNone) {
    EXPECT_FALSE(psnr(plain(80).view(), plain(80).view()).has_value());
}

TEST(PictureError, CountsPixelsThatDifferAndByHowMuch) {
    Grid<Rgba> other = plain(80);
    other.at(3, 4)[2] = 90;
    other.at(3, 4)[0] = 75;
    other.at(0, 0)[1] = 81;
    other.at(9, 9)[3] = 0;  // alpha does not count
    const Grid<float> flip = flipOf(plain(80).view(), other.view());
    const PictureError error = measurePictures(plain(80).view(), other.view(), flip);
    EXPECT_DOUBLE_EQ(error.differing, 2.0 / 200);
    EXPECT_EQ(error.greatest, 10U);
    EXPECT_EQ(error.flip, spreadOf(flip.cells()));
    EXPECT_GT(error.flip.max, 0);
}

TEST(Spread, TakesNearestRanks) {
    std::array<float, 200> values{};
    for (size_t n = 0; n < values.size(); ++n) values[(n * 7) % 200] = static_cast<float>(n + 1);  // 1 .. 200, shuffled
    EXPECT_EQ(spreadOf(values), (Spread{.mean = 100.5, .median = 100, .p95 = 190, .p99 = 198, .max = 200}));
    EXPECT_EQ(spreadOf(std::array{3.0F}), (Spread{.mean = 3, .median = 3, .p95 = 3, .p99 = 3, .max = 3}));
    EXPECT_EQ(spreadOf({}), Spread{});
}

TEST(HeatColour, GrowsFromBlackToWhite) {
    EXPECT_EQ(heatColour(0), (Rgba{0, 0, 0, 255}));
    EXPECT_EQ(heatColour(1), (Rgba{255, 255, 255, 255}));
    EXPECT_EQ(heatColour(7), heatColour(1));
    int before = -1;
    for (int step = 0; step <= 100; ++step) {
        const Rgba colour = heatColour(static_cast<float>(step) / 100);
        const int sum = colour[0] + colour[1] + colour[2];
        EXPECT_GT(sum, before) << step;
        before = sum;
    }
}

}  // namespace
}  // namespace terray
