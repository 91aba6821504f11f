// Terrain whose pyramid is known in closed form.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

/// Decoded height of core cell (x, y) of a tile.
double heightAt(const HeightTile& tile, int64_t x, int64_t y) {
    return tile.encoding.height(tile.codes.at(x + kHeightApron, y + kHeightApron));
}

std::map<TileId, HeightTile> buildTiles(const Grid<float>& heights, double quantum = 0.01) {
    const TemporaryDirectory directory;
    (void)buildTestDataset(GridHeights(heights), directory / "out", {.jobs = 2, .depth = 1, .quantum = quantum});
    return readHeightTiles(directory / "out");
}

TEST(KnownHeights, APlaneStaysAPlane) {
    // Powers of two all through, so that means and codes are exact: slope 1/4, quantum 1/64.
    const auto tiles =
        buildTiles(makeHeights({2048, 64}, [](int64_t x, int64_t) { return static_cast<double>(x) / 4; }), 1.0 / 64);
    for (const auto& [id, tile] : tiles) {
        const double side = std::ldexp(1.0, 2 - static_cast<int>(id.level));  // finest samples along a cell
        const auto column = static_cast<double>(512 * id.x + 100);
        EXPECT_DOUBLE_EQ(heightAt(tile, 100, 3), ((column + 0.5) * side - 0.5) / 4) << id;
        // The samples farthest from a cell's centre lie (side - 1) / 2 away. At the ground's rim, where there is
        // nothing to go on to, the bilinear surface is off by as much, and some 2^-19 of the relief is added for
        // rounding.
        EXPECT_GE(tile.record.error, static_cast<float>((side - 1) / 2 / 4)) << id;
        EXPECT_LE(tile.record.error, (side - 1) / 2 / 4 * (1 + 1e-4)) << id;
        EXPECT_TRUE(tile.record.hasHoles) << id;  // beyond the southern edge, at the least
    }
    EXPECT_EQ(tiles.size(), 4u + 2 + 1);
}

TEST(KnownHeights, AStepIsHalvedOnlyWhereACellSpansIt) {
    // The cliff stands at x = 515: cells of 2 and of 4 samples span it, at 514 (1 of 2) and at 512 (3 of 4 are low).
    const auto tiles = buildTiles(makeHeights({1100, 1100}, [](int64_t x, int64_t) { return x < 515 ? 0.0 : 8.0; }));
    EXPECT_DOUBLE_EQ(heightAt(tiles.at({2, 1, 0}), 2, 0), 0);
    EXPECT_DOUBLE_EQ(heightAt(tiles.at({2, 1, 0}), 3, 0), 8);
    EXPECT_DOUBLE_EQ(heightAt(tiles.at({1, 0, 0}), 257, 0), 4);
    EXPECT_DOUBLE_EQ(heightAt(tiles.at({0, 0, 0}), 128, 0), 2);
    EXPECT_EQ(tiles.at({2, 1, 0}).record.error, 0);
    EXPECT_EQ(tiles.at({1, 0, 0}).record.error, 4);
    EXPECT_EQ(tiles.at({0, 0, 0}).record.error, 6);
}

TEST(KnownHeights, ASpikeIsRememberedByEveryErrorAbove) {
    const auto tiles =
        buildTiles(makeHeights({2048, 2048}, [](int64_t x, int64_t y) { return x == 1333 && y == 777 ? 256.0 : 0.0; }));
    for (uint32_t level = 0; level <= 2; ++level) {
        const int64_t side = int64_t{1} << (2 - level);
        const int64_t x = 1333 / side;
        const int64_t y = 777 / side;
        const HeightTile& tile =
            tiles.at({level, static_cast<uint32_t>(x / kTileCore), static_cast<uint32_t>(y / kTileCore)});
        const double mean = 256.0 / static_cast<double>(side * side);
        EXPECT_DOUBLE_EQ(heightAt(tile, x % kTileCore, y % kTileCore), mean);
        // One level up the bilinear surface is lower over the spike than the mean: 9/16 of it. No more is proven of
        // the root than the range of heights.
        const double off[] = {252, 256 - 64 * 9 / 16.0, 0};
        EXPECT_GE(tile.record.error, static_cast<float>(256 - mean));
        EXPECT_NEAR(tile.record.error, off[level], 0.001);
        EXPECT_EQ(tile.record.maxHeight, static_cast<float>(mean));
    }
    // Tiles that the spike is not in know nothing of it.
    EXPECT_EQ(tiles.at({2, 0, 0}).record.error, 0);
}

TEST(KnownHeights, AConeKeepsItsMassAndItsFoot) {
    const auto cone = [](int64_t x, int64_t y) {
        return std::max(0.0, 400 - std::hypot(static_cast<double>(x) - 511.5, static_cast<double>(y) - 511.5));
    };
    const Grid<float> heights = makeHeights({1024, 1024}, cone);
    const HeightTile root = buildTiles(heights).at({0, 0, 0});
    double sum = 0;
    for (int64_t y = 0; y < kTileCore; ++y)
        for (int64_t x = 0; x < kTileCore; ++x) sum += 4 * heightAt(root, x, y);
    // A mean pyramid keeps volume: that of the samples, which is that of the cone, pi r^2 h / 3, to a thousandth.
    EXPECT_NEAR(sum, std::numbers::pi * std::pow(400, 3) / 3, 1e-3 * std::pow(400, 3));
    EXPECT_DOUBLE_EQ(heightAt(root, 0, 0), 0);
    EXPECT_EQ(root.record.minHeight, 0);
    // On slope 1 a corner of 2 x 2 samples differs from their mean by at most its mean distance from the four.
    EXPECT_LE(root.record.error, (0 + 1 + 1 + std::numbers::sqrt2) / 4 + 0.0051);
    EXPECT_GE(root.record.error, 0.5);
}

TEST(KnownHeights, AGreatRangeCoarsensTheCodesAndNotMore) {
    // 0 to 5115 m in centimetres are 511,500 steps: 8 centimetres a code fit 16 bits, 4 do not.
    const auto tiles =
        buildTiles(makeHeights({512, 512}, [](int64_t x, int64_t) { return static_cast<double>(x) * 10.0 + 0.01; }));
    const HeightTile& tile = tiles.at({0, 0, 0});
    EXPECT_EQ(tile.encoding.exponent, 3u);
    EXPECT_LE(tile.record.error, 0.04f + 1e-6f);
    EXPECT_GT(tile.record.error, 0);
}

TEST(KnownHeights, MetadataSaysWhatWasMeasured) {
    Grid<float> heights = makeHills({900, 700}, 1, 0);
    heights.at(17, 20) = kNoHeight;
    heights.at(18, 20) = std::numeric_limits<float>::infinity();
    GridHeights source(heights, 2.5);
    source.info_.crsName = "EPSG:32613";
    source.info_.crsWkt = "PROJCRS[\"a name\"]";
    source.info_.lonLatBounds = GroundRect{-105.5, 37, -105.4, 37.1};
    source.info_.verticalDatum = "NAVD88";
    source.info_.files = {{"a.tif", 77, 1234}};
    const TemporaryDirectory directory;
    const DatasetMetadata metadata = buildTestDataset(source, directory / "out").metadata;
    const PmtilesReader archive = PmtilesReader::open(openFileSource(directory / "out" / kHeightsFile).value()).value();
    EXPECT_EQ(metadataFromJson(Json::parse(archive.metadata().value()).value()).value(), metadata);
    EXPECT_EQ(metadata.tiling, (Tiling{.west = 1000, .north = 5000, .finestSpacing = 2.5, .finestLevel = 1}));
    EXPECT_EQ(metadata.samples, (GridSize{900, 700}));
    EXPECT_EQ(metadata.holeSamples, 2u);  // infinity is no height
    EXPECT_EQ(metadata.crsName, "EPSG:32613");
    EXPECT_EQ(metadata.verticalDatum, "NAVD88");
    EXPECT_EQ(metadata.sources, source.info_.files);
    EXPECT_FALSE(metadata.imageryLevel);
    ASSERT_EQ(metadata.levelErrors.size(), 2u);
    EXPECT_NEAR(metadata.levelErrors[1], 0.005, 1e-5);
    EXPECT_EQ(metadata.errorBound, 0.005);
    EXPECT_GT(metadata.levelErrors[0], 1);
    EXPECT_EQ(archive.header().maxZoom, 1);
    EXPECT_DOUBLE_EQ(archive.header().minLon, -105.5);
    EXPECT_NEAR(archive.header().centerLat, 37.05, 1e-7);
    for (const auto& entry : std::filesystem::directory_iterator(directory / "out"))
        EXPECT_EQ(entry.path().filename(), kHeightsFile);
}

TEST(KnownHeights, NoHeightIsOffByMoreThanTheBoundAskedFor) {
    const TemporaryDirectory directory;
    const GridHeights source(makeHills({700, 600}, 5, 2));
    for (const double most : {0.005, 0.03, 0.25}) {
        const std::filesystem::path out = directory / std::to_string(most);
        const DatasetMetadata metadata = buildDataset(source, {}, {.out = out, .maxHeightError = most}).metadata;
        EXPECT_EQ(metadata.errorBound, most);
        EXPECT_LE(metadata.levelErrors.back(), most * (1 + 1e-6));
        double greatest = 0;
        for (const auto& [id, tile] : readHeightTiles(out)) {
            if (id.level != metadata.tiling.finestLevel) continue;
            for (int64_t y = 0; y < kTileCore; ++y)
                for (int64_t x = 0; x < kTileCore; ++x) {
                    const uint16_t code = tile.codes.at(x + kHeightApron, y + kHeightApron);
                    if (code == kNoSurface) continue;
                    const float truth =
                        source.heights_.at(int64_t{id.x} * kTileCore + x, int64_t{id.y} * kTileCore + y);
                    greatest = std::max(greatest, std::abs(tile.encoding.height(code) - double{truth}));
                }
        }
        EXPECT_LE(greatest, most * (1 + 1e-9));
        EXPECT_FLOAT_EQ(static_cast<float>(greatest), static_cast<float>(metadata.levelErrors.back()));
        EXPECT_GT(greatest, 0.9 * most);
    }
}

TEST(KnownHeights, ABoundThatSixteenBitsCannotKeepIsRefusedWithOneTheyCan) {
    const TemporaryDirectory directory;
    const GridHeights steep(makeHeights({512, 512}, [](int64_t x, int64_t) { return static_cast<double>(x) * 10; }));
    try {
        (void)buildDataset(steep, {}, {.out = directory / "out", .maxHeightError = 0.005});
        FAIL() << "5110 m within one tile were coded to half a centimetre";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::input);
        EXPECT_NE(std::string(error.what()).find("within 0.04"), std::string::npos) << error.what();
    }
    EXPECT_EQ(buildDataset(steep, {}, {.out = directory / "out", .maxHeightError = 0.04}).metadata.errorBound, 0.04);
}

TEST(KnownHeights, TheQuantumFollowsThePrecisionOfTheSource) {
    HeightGridInfo info;
    info.spacing = 10;
    EXPECT_EQ(chooseQuantum(info), 0.01);
    info.spacing = 0.5;
    EXPECT_EQ(chooseQuantum(info), 0.001);
    info.sourceStep = 0.02;
    EXPECT_EQ(chooseQuantum(info), 0.01);
    info.sourceStep = 0.025;
    EXPECT_EQ(chooseQuantum(info), 0.001);
}

}  // namespace
}  // namespace terray
