// BC1 blocks: what they lose, and how our decoder reads them.

#include "preprocess/bc1.h"

#include <cmath>

#include <gtest/gtest.h>

#include "common/bc1_decode.h"
#include "common/imagery_tile.h"
#include "preprocess/raster_files.h"

namespace terray {
namespace {

TEST(Bc1, DecodesABlockAsTheFormatDefinesIt) {
    // End colours 0xF800 (red) and 0x001F (blue), the first greater: four colours. The first row chooses 0, 1, 2, 3.
    Bytes block{std::byte{0x00}, std::byte{0xf8}, std::byte{0x1f}, std::byte{0x00},
                std::byte{0xe4}, std::byte{0},    std::byte{0},    std::byte{0}};
    const Grid<Rgba> image = decodeBc1(block, {4, 4});
    EXPECT_EQ(image.at(0, 0), (Rgba{255, 0, 0, 255}));
    EXPECT_EQ(image.at(1, 0), (Rgba{0, 0, 255, 255}));
    EXPECT_EQ(image.at(2, 0), (Rgba{170, 0, 85, 255}));
    EXPECT_EQ(image.at(3, 0), (Rgba{85, 0, 170, 255}));
    EXPECT_EQ(image.at(3, 3), (Rgba{255, 0, 0, 255}));
    // Exchanged: three colours, the fourth choice black.
    std::swap(block[0], block[2]);
    std::swap(block[1], block[3]);
    const Grid<Rgba> three = decodeBc1(block, {4, 4});
    EXPECT_EQ(three.at(2, 0), (Rgba{128, 0, 128, 255}));
    EXPECT_EQ(three.at(3, 0), (Rgba{0, 0, 0, 255}));
}

TEST(Bc1, KeepsFlatColoursToTwoSteps) {
    for (int value = 0; value < 256; value += 5) {
        const Rgba colour{static_cast<uint8_t>(value), static_cast<uint8_t>(255 - value),
                          static_cast<uint8_t>(value / 2), 255};
        const Grid<Rgba> flat({8, 4}, colour);
        const Grid<Rgba> decoded = decodeBc1(encodeBc1(flat.view()), flat.size());
        for (const Rgba& texel : decoded.cells())
            // Thirds between neighbouring 5-bit values, 8.2 apart, lie at most 2 from any 8-bit one.
            for (size_t i = 0; i < 3; ++i) ASSERT_NEAR(texel[i], colour[i], 2) << value;
    }
}

TEST(Bc1, IgnoresAlpha) {
    Grid<Rgba> image({4, 4}, Rgba{10, 200, 30, 255});
    const Bytes opaque = encodeBc1(image.view());
    for (size_t i = 0; i < 16; i += 3) image.cells()[i][3] = 0;
    EXPECT_EQ(encodeBc1(image.view()), opaque);
}

TEST(Bc1, OrdersBlocksByRowsFromTheTop) {
    Grid<Rgba> image({8, 8}, Rgba{0, 0, 0, 255});
    image.at(6, 1) = {255, 255, 255, 255};
    const Bytes blocks = encodeBc1(image.view());
    ASSERT_EQ(blocks.size(), 4 * kBc1BlockBytes);
    const Grid<Rgba> second = decodeBc1(ByteView(blocks).subspan(kBc1BlockBytes, kBc1BlockBytes), {4, 4});
    EXPECT_EQ(second.at(2, 1), (Rgba{255, 255, 255, 255}));
    EXPECT_EQ(decodeBc1(blocks, image.size()), image);  // two colours only: no loss
}

TEST(Bc1, KeepsAPhotoAboveThirtyDecibels) {
    const SyntheticTerrain terrain{.size = 512, .spacing = 1, .seed = 5};
    const Tiling tiling{.finestSpacing = 1, .finestLevel = 0};
    Grid<Rgba> photo({512, 512});
    makeSyntheticPhoto(terrain, tiling)->openReader()->read({0, 0, 512, 512}, photo.view());
    const Grid<Rgba> decoded = decodeBc1(encodeBc1(photo.view()), photo.size());
    double squares = 0;
    for (size_t i = 0; i < photo.cells().size(); ++i)
        for (size_t c = 0; c < 3; ++c) squares += std::pow(photo.cells()[i][c] - decoded.cells()[i][c], 2);
    const double psnr = 10 * std::log10(255 * 255 * 3 * static_cast<double>(photo.cells().size()) / squares);
    EXPECT_GT(psnr, 30);
    RecordProperty("psnr_dB", std::to_string(psnr));
}

}  // namespace
}  // namespace terray
