#include <cmath>

#include <gtest/gtest.h>

#include "common/bc1_decode.h"
#include "common/error.h"
#include "preprocess/verify_dataset.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

const std::atomic<bool> kNeverStop = false;

/// BC1 stores a flat block as 5, 6 and 5 bits, mixed in thirds: red and blue are then off by up to 8 / 3 of a value.
constexpr int kBc1Tolerance = 3;

Grid<Rgba> decoded(const ImageryTile& tile, int mip = 0) {
    return decodeBc1(tile.mip(mip), {imageryMipSide(mip), imageryMipSide(mip)});
}

::testing::AssertionResult isNear(const Rgba& found, const std::array<int, 3>& expected) {
    for (size_t channel = 0; channel < 3; ++channel)
        if (std::abs(found[channel] - expected[channel]) > kBc1Tolerance)
            return ::testing::AssertionFailure()
                   << "found " << int{found[0]} << " " << int{found[1]} << " " << int{found[2]} << ", expected "
                   << expected[0] << " " << expected[1] << " " << expected[2];
    return ::testing::AssertionSuccess();
}

constexpr std::array<int, 3> kNeutral = {kNeutralGround[0], kNeutralGround[1], kNeutralGround[2]};

/// A dataset with flat heights and a photo.
class PhotoDataset {
  public:
    PhotoDataset(GridSize heights, Grid<Rgba> texels, uint32_t level, const TestBuild& build = {}) {
        const GridHeights source(Grid<float>(heights, 1.0f));
        summary = buildTestDataset(source, directory_ / "out", build, gridPhoto(std::move(texels), level));
        tiles = readImageryTiles(path());
    }
    [[nodiscard]] std::filesystem::path path() const { return directory_ / "out"; }
    [[nodiscard]] size_t faults() const { return verifyDataset(openDataset(path()), 2, kNeverStop).faults.size(); }

    BuildSummary summary;
    std::map<TileId, ImageryTile> tiles;

  private:
    TemporaryDirectory directory_;
};

/// Photo in which every tile of a level has a colour of its own.
Rgba colourOfTile(int64_t x, int64_t y) {
    return {static_cast<uint8_t>(40 + 60 * x), static_cast<uint8_t>(40 + 60 * y), 80, 255};
}
std::array<int, 3> rgbOfTile(int64_t x, int64_t y) {
    const Rgba colour = colourOfTile(x, y);
    return {colour[0], colour[1], colour[2]};
}
Grid<Rgba> colouredTiles(GridSize size) {
    Grid<Rgba> texels(size);
    for (int64_t y = 0; y < size.height; ++y)
        for (int64_t x = 0; x < size.width; ++x) texels.at(x, y) = colourOfTile(x / kTileCore, y / kTileCore);
    return texels;
}

TEST(ImageryPyramid, GuttersHoldTheNeighboursTexels) {
    const PhotoDataset dataset({1536, 1536}, colouredTiles({1536, 1536}), 2);
    for (int64_t y = 0; y < 3; ++y)
        for (int64_t x = 0; x < 3; ++x) {
            const Grid<Rgba> tile = decoded(dataset.tiles.at({2, static_cast<uint32_t>(x), static_cast<uint32_t>(y)}));
            const auto expected = [&](int64_t column, int64_t row) {
                const bool inside = column >= 0 && row >= 0 && column < 3 && row < 3;
                return inside ? rgbOfTile(column, row) : kNeutral;
            };
            for (const int64_t near : {int64_t{0}, int64_t{kImageryGutter - 1}}) {
                const int64_t far = kImageryTileSide - 1 - near;
                EXPECT_TRUE(isNear(tile.at(near, 300), expected(x - 1, y)));
                EXPECT_TRUE(isNear(tile.at(far, 300), expected(x + 1, y)));
                EXPECT_TRUE(isNear(tile.at(300, near), expected(x, y - 1)));
                EXPECT_TRUE(isNear(tile.at(300, far), expected(x, y + 1)));
                EXPECT_TRUE(isNear(tile.at(far, far), expected(x + 1, y + 1)));
            }
            EXPECT_TRUE(isNear(tile.at(kImageryGutter, kImageryGutter), expected(x, y)));
        }
    EXPECT_EQ(dataset.faults(), 0u);
}

TEST(ImageryPyramid, CoarserLevelsAverageLight) {
    Grid<Rgba> checks({1024, 1024});
    for (int64_t y = 0; y < 1024; ++y)
        for (int64_t x = 0; x < 1024; ++x)
            checks.at(x, y) = (x + y) % 2 == 0 ? Rgba{0, 0, 0, 255} : Rgba{255, 255, 255, 255};
    const PhotoDataset dataset({1024, 1024}, checks, 1);
    const ImageryTile& root = dataset.tiles.at({0, 0, 0});
    ASSERT_EQ(root.mips, kImageryMips);
    for (int mip = 0; mip < kImageryMips; ++mip) {
        const Grid<Rgba> image = decoded(root, mip);
        const int64_t gutter = kImageryGutter >> mip;
        const int64_t last = image.width() - gutter - 1;
        for (const int64_t at : {gutter, image.width() / 2, last})
            EXPECT_TRUE(isNear(image.at(at, at), {188, 188, 188})) << mip;
        for (const int64_t at : {int64_t{0}, gutter - 1, last + 1, image.width() - 1}) {
            EXPECT_TRUE(isNear(image.at(at, image.width() / 2), kNeutral)) << mip;
            EXPECT_TRUE(isNear(image.at(image.width() / 2, at), kNeutral)) << mip;
        }
    }
    EXPECT_EQ(dataset.tiles.at({1, 0, 0}).mips, 1);
}

TEST(ImageryPyramid, RootMipsArePartsOfTheRoot) {
    // Four flat quarters: each mip shows them, half as large each time.
    const PhotoDataset dataset({1024, 1024}, colouredTiles({1024, 1024}), 1);
    for (int mip = 0; mip < kImageryMips; ++mip) {
        const Grid<Rgba> image = decoded(dataset.tiles.at({0, 0, 0}), mip);
        const int64_t quarter = image.width() / 4;
        EXPECT_TRUE(isNear(image.at(quarter, quarter), rgbOfTile(0, 0))) << mip;
        EXPECT_TRUE(isNear(image.at(3 * quarter, quarter), rgbOfTile(1, 0))) << mip;
        EXPECT_TRUE(isNear(image.at(quarter, 3 * quarter), rgbOfTile(0, 1))) << mip;
        EXPECT_TRUE(isNear(image.at(3 * quarter, 3 * quarter), rgbOfTile(1, 1))) << mip;
    }
}

TEST(ImageryPyramid, TilesWithoutPhotoAreNotStored) {
    // The photo covers the north-west 600 x 520 texels of a level with 4 x 4 tiles.
    const PhotoDataset dataset({2048, 2048}, Grid<Rgba>({600, 520}, Rgba{200, 30, 30, 255}), 2);
    std::vector<TileId> ids;
    for (const auto& [id, tile] : dataset.tiles) ids.push_back(id);
    EXPECT_EQ(ids, (std::vector<TileId>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 1}, {2, 1, 0}, {2, 1, 1}}));
    EXPECT_EQ(dataset.tiles.at({0, 0, 0}).childExists, (std::array{true, false, false, false}));
    EXPECT_EQ(dataset.tiles.at({2, 1, 1}).childExists, (std::array{false, false, false, false}));
    const Grid<Rgba> corner = decoded(dataset.tiles.at({2, 1, 1}));
    EXPECT_TRUE(isNear(corner.at(kImageryGutter + 80, kImageryGutter + 4), {200, 30, 30}));
    EXPECT_TRUE(isNear(corner.at(kImageryGutter + 200, kImageryGutter + 200), kNeutral));
    EXPECT_EQ(dataset.summary.metadata.imageryTiles, 6u);
    EXPECT_EQ(dataset.faults(), 0u);
}

TEST(ImageryPyramid, MayBeFinerOrCoarserThanTheHeights) {
    const PhotoDataset finer({512, 512}, Grid<Rgba>({2048, 2048}, Rgba{10, 200, 30, 255}), 2);
    EXPECT_EQ(finer.tiles.size(), 16u + 4 + 1);
    EXPECT_EQ(finer.faults(), 0u);
    const PhotoDataset coarser({2048, 1025}, Grid<Rgba>({512, 257}, Rgba{10, 200, 30, 255}), 0);
    EXPECT_EQ(coarser.tiles.size(), 1u);
    EXPECT_TRUE(isNear(decoded(coarser.tiles.at({0, 0, 0})).at(100, 100), {10, 200, 30}));
    EXPECT_EQ(coarser.tiles.at({0, 0, 0}).mips, kImageryMips);
    EXPECT_EQ(coarser.faults(), 0u);
    const auto bounds = coarser.summary.metadata.imageryBounds;
    ASSERT_TRUE(bounds);
    EXPECT_EQ(*bounds, coarser.summary.metadata.groundBounds());  // the photo's last row is clipped to the ground
}

TEST(ImageryPyramid, PhotoBeyondTheHeightsIsLeftOut) {
    // Heights cover 600 x 600 of the root's 1024 x 1024 samples, the photo all of it.
    const PhotoDataset dataset({600, 600}, Grid<Rgba>({1024, 1024}, Rgba{10, 200, 30, 255}), 1);
    const Grid<Rgba> tile = decoded(dataset.tiles.at({1, 1, 1}));
    EXPECT_TRUE(isNear(tile.at(kImageryGutter + 40, kImageryGutter + 40), {10, 200, 30}));
    EXPECT_TRUE(isNear(tile.at(kImageryGutter + 120, kImageryGutter + 120), kNeutral));
}

TEST(ImageryPyramid, IsByteIdenticalForAnyJobsAndBlockDepth) {
    Grid<Rgba> texels({2600, 2200});
    for (int64_t y = 0; y < 2200; ++y)
        for (int64_t x = 0; x < 2600; ++x)
            texels.at(x, y) = {static_cast<uint8_t>(x), static_cast<uint8_t>(y), static_cast<uint8_t>(x * y), 255};
    const PhotoDataset reference({1300, 1100}, texels, 3, {.jobs = 1, .depth = 3});
    for (const TestBuild build :
         {TestBuild{.jobs = 1, .depth = 1}, TestBuild{.jobs = 2, .depth = 2}, TestBuild{.jobs = 7, .depth = 1}}) {
        const PhotoDataset other({1300, 1100}, texels, 3, build);
        EXPECT_EQ(readFile(other.path() / kImageryFile), readFile(reference.path() / kImageryFile)) << build.jobs;
        EXPECT_EQ(readFile(other.path() / kHeightsFile), readFile(reference.path() / kHeightsFile)) << build.jobs;
    }
}

TEST(ImageryPyramid, RefusesAPhotoWithoutATexelOverTheHeights) {
    const GridHeights source(Grid<float>({600, 600}, 1.0f));
    const TemporaryDirectory directory;
    try {
        (void)buildTestDataset(source, directory / "out", {}, gridPhoto(Grid<Rgba>({600, 600}, Rgba{}), 1));
        FAIL() << "a photo of nodata was taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::georeference);
    }
    EXPECT_TRUE(directory.names().empty());
}

}  // namespace
}  // namespace terray
