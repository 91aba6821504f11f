// A part of a dataset as a dataset of its own: the same ground, the same heights, nothing else.

#include <gtest/gtest.h>

#include "common/bc1_decode.h"
#include "common/error.h"
#include "preprocess/dataset_source.h"
#include "preprocess/verify_dataset.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

constexpr GridSize kSize{1300, 1100};
/// Columns 200 to 899 and rows 300 to 749 of the finest samples; GridHeights begins at (1000, 5000).
constexpr GridRect kCells{200, 300, 700, 450};
constexpr GroundRect kArea{1200, 4250, 1900, 4700};

class Extract : public testing::Test {
  protected:
    void SetUp() override {
        OpenPhoto photo;
#if TERRAY_WITH_STB
        Grid<Rgba> texels({2 * kSize.width, 2 * kSize.height});
        for (int64_t y = 0; y < texels.height(); ++y)
            for (int64_t x = 0; x < texels.width(); ++x)
                texels.at(x, y) = {static_cast<uint8_t>(x / 16 % 256), static_cast<uint8_t>(y / 16 % 256), 90, 255};
        photo = gridPhoto(std::move(texels), 3);
#endif
        (void)buildTestDataset(GridHeights(makeHills(kSize, 21, 4)), whole(), {.jobs = 2, .depth = 2}, photo);
    }
    [[nodiscard]] std::filesystem::path whole() const {
        return directory_ / "whole";
    }
    [[nodiscard]] std::filesystem::path part() const {
        return directory_ / "part";
    }

    void extract(const DatasetPart& wanted, const TestBuild& build = {}) const {
        const auto dataset = std::make_shared<const DatasetArchives>(openDataset(whole()));
        const DatasetSources sources = openDatasetPart(dataset, wanted);
        std::filesystem::remove_all(part());
        (void)buildTestDataset(*sources.heights, part(),
                               {.jobs = build.jobs, .depth = build.depth, .quantum = dataset->metadata.quantum},
                               sources.openPhoto);
    }
    [[nodiscard]] uint64_t faults() const {
        const std::atomic<bool> stop = false;
        return verifyDataset(openDataset(part()), 2, stop).faults.size();
    }

    TemporaryDirectory directory_;
};

/// Heights of a level, NaN for holes.
class StoredHeights {
  public:
    StoredHeights(const std::filesystem::path& dataset, uint32_t level)
        : tiles_(readHeightTiles(dataset)), level_(level) {}
    [[nodiscard]] double at(int64_t x, int64_t y) const {
        const TileId id{level_, static_cast<uint32_t>(x / kTileCore), static_cast<uint32_t>(y / kTileCore)};
        const auto tile = tiles_.find(id);
        if (tile == tiles_.end()) return -1e9;
        const uint16_t code = tile->second.codes.at(x % kTileCore + kHeightApron, y % kTileCore + kHeightApron);
        return code == kNoSurface ? -1e9 : tile->second.encoding.height(code);
    }

  private:
    std::map<TileId, HeightTile> tiles_;
    uint32_t level_;
};

/// Samples of `cells` of the whole's level that are not those of the part's finest level.
int64_t differing(const StoredHeights& whole, const StoredHeights& part, const GridRect& cells) {
    int64_t count = 0;
    for (int64_t y = 0; y < cells.height; ++y)
        for (int64_t x = 0; x < cells.width; ++x)
            if (part.at(x, y) != whole.at(cells.x + x, cells.y + y)) ++count;
    return count;
}

TEST_F(Extract, AnAreaHoldsTheSameHeightsToTheBit) {
    extract({.bounds = kArea});
    const DatasetMetadata metadata = openDataset(part()).metadata;
    EXPECT_EQ(metadata.samples, (GridSize{kCells.width, kCells.height}));
    EXPECT_EQ(metadata.groundBounds(), kArea);
    EXPECT_EQ(differing(StoredHeights(whole(), 2), StoredHeights(part(), 1), kCells), 0);
    EXPECT_EQ(faults(), 0u);
}

TEST_F(Extract, FewerLevelsEndWithTheOneAskedFor) {
    extract({.finestLevel = 1});
    const DatasetMetadata metadata = openDataset(part()).metadata;
    EXPECT_EQ(metadata.samples, (GridSize{650, 550}));
    EXPECT_EQ(metadata.tiling.finestSpacing, 2);
    EXPECT_EQ(differing(StoredHeights(whole(), 1), StoredHeights(part(), 1), {0, 0, 650, 550}), 0);
    EXPECT_EQ(faults(), 0u);
}

TEST_F(Extract, IsByteIdenticalForAnyJobsAndBlockDepth) {
    extract({.bounds = kArea, .finestLevel = 2}, {.jobs = 1, .depth = 1});
    const Bytes heights = readFile(part() / kHeightsFile);
    extract({.bounds = kArea, .finestLevel = 2}, {.jobs = 3, .depth = 2});
    EXPECT_TRUE(readFile(part() / kHeightsFile) == heights);
}

TEST_F(Extract, RefusesWhatTheDatasetDoesNotHave) {
    try {
        extract({.bounds = GroundRect{0, 0, 900, 4000}});
        FAIL() << "an area beside the dataset was taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::georeference);
        EXPECT_NE(std::string(error.what()).find("W 1000, S 3900"), std::string::npos) << error.what();
    }
    EXPECT_THROW(extract({.finestLevel = 9}), Error);
}

TEST_F(Extract, NamesADamagedTile) {
    const DatasetArchives dataset = openDataset(whole());
    const auto range = dataset.heights.locate({2, 1, 1}).value().value();
    Bytes bytes = readFile(whole() / kHeightsFile);
    bytes[range.offset + range.length / 2] ^= std::byte{1};
    writeFile(whole() / kHeightsFile, bytes);
    try {
        extract({.bounds = kArea});
        FAIL() << "a damaged tile was taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::dataset);
        EXPECT_NE(std::string(error.what()).find("2/1/1"), std::string::npos) << error.what();
    }
}

#if TERRAY_WITH_STB
/// Greatest difference of a channel between the photo of the part and the whole's.
int greatestDifference(const std::filesystem::path& whole, uint32_t wholeLevel, const std::filesystem::path& part,
                       uint32_t partLevel, const GridRect& texels) {
    std::map<const ImageryTile*, Grid<Rgba>> decoded;
    const auto colourAt = [&](const std::map<TileId, ImageryTile>& tiles, uint32_t level, int64_t x, int64_t y) {
        const TileId id{level, static_cast<uint32_t>(x / kTileCore), static_cast<uint32_t>(y / kTileCore)};
        const ImageryTile& tile = tiles.at(id);
        auto& image = decoded[&tile];
        if (image.size().width == 0) image = decodeBc1(tile.mip(0), {kImageryTileSide, kImageryTileSide});
        return image.at(x % kTileCore + kImageryGutter, y % kTileCore + kImageryGutter);
    };
    const auto before = readImageryTiles(whole);
    const auto after = readImageryTiles(part);
    int greatest = 0;
    for (int64_t y = 0; y < texels.height; ++y)
        for (int64_t x = 0; x < texels.width; ++x) {
            const Rgba a = colourAt(before, wholeLevel, texels.x + x, texels.y + y);
            const Rgba b = colourAt(after, partLevel, x, y);
            for (size_t channel = 0; channel < 3; ++channel)
                greatest = std::max(greatest, std::abs(int{a[channel]} - int{b[channel]}));
        }
    return greatest;
}

TEST_F(Extract, ThePhotoLiesWhereItLay) {
    extract({.bounds = kArea});
    // Blocks lie as they lay, so what BC1 could show it can show again, to a step of its 5-bit colours.
    EXPECT_LE(
        greatestDifference(whole(), 3, part(), 2, {2 * kCells.x, 2 * kCells.y, 2 * kCells.width, 2 * kCells.height}),
        8);
}

TEST_F(Extract, APhotoCoarserThanTheHeightsComesAlong) {
    // A part so small that it has one level, and the photo's texels are four of its samples.
    std::filesystem::remove_all(whole());
    Grid<Rgba> texels({325, 275}, Rgba{40, 80, 120, 255});
    (void)buildTestDataset(GridHeights(makeHills(kSize, 21, 4)), whole(), {}, gridPhoto(std::move(texels), 0));
    extract({.bounds = GroundRect{1205, 4601, 1299, 4699}});
    const DatasetMetadata metadata = openDataset(part()).metadata;
    EXPECT_EQ(metadata.groundBounds(), (GroundRect{1204, 4600, 1300, 4700}));
    EXPECT_EQ(metadata.imageryLevel, 0u);
    EXPECT_EQ(faults(), 0u);
}
#endif

}  // namespace
}  // namespace terray
