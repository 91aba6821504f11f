// A tile's error bounds its surfaces between samples too: against the finest surfaces, evaluated point by point.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "preprocess/verify_dataset.h"
#include "tests/common/random.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
const std::atomic<bool> kNeverStop = false;

/// Height of the sample (column, row) of some level; NaN: none.
using Samples = std::function<double(int64_t column, int64_t row)>;

/// The bilinear surface at a place, samples' centres at + 0.5; NaN where the sample whose quarter it is has none.
double bilinear(const Samples& samples, double x, double y) {
    const auto ownColumn = static_cast<int64_t>(std::floor(x)), ownRow = static_cast<int64_t>(std::floor(y));
    if (std::isnan(samples(ownColumn, ownRow))) return kNone;
    const auto column = static_cast<int64_t>(std::floor(x - 0.5)), row = static_cast<int64_t>(std::floor(y - 0.5));
    const double u = x - 0.5 - static_cast<double>(column), v = y - 0.5 - static_cast<double>(row);
    double corners[4] = {samples(column, row), samples(column + 1, row), samples(column, row + 1),
                         samples(column + 1, row + 1)};
    double sum = 0;
    int count = 0;
    for (const double corner : corners)
        if (!std::isnan(corner)) {
            sum += corner;
            ++count;
        }
    for (double& corner : corners)
        if (std::isnan(corner)) corner = sum / count;
    return (1 - v) * ((1 - u) * corners[0] + u * corners[1]) + v * ((1 - u) * corners[2] + u * corners[3]);
}

Samples samplesOf(const Grid<float>& heights) {
    return [&](int64_t column, int64_t row) {
        const bool inside = column >= 0 && row >= 0 && column < heights.width() && row < heights.size().height;
        return inside ? static_cast<double>(heights.at(column, row)) : kNone;
    };
}

/// Of a tile, counted from its core's corner.
Samples samplesOf(const HeightTile& tile) {
    return [&](int64_t column, int64_t row) {
        const uint16_t code = tile.codes.at(column + kHeightApron, row + kHeightApron);
        return code == kNoSurface ? kNone : tile.encoding.height(code);
    };
}

/// Greatest distance of a tile's surfaces from the finest ones, at nine places of each finest cell beneath it.
double greatestDistance(const HeightTile& tile, const Grid<float>& heights, uint32_t finestLevel) {
    const Samples coarse = samplesOf(tile), fine = samplesOf(heights);
    const int64_t side = int64_t{1} << (finestLevel - tile.id.level);
    const GridRect core = Tiling::coreSamples(tile.id);
    const GridRect beneath = intersection({core.x * side, core.y * side, core.width * side, core.height * side},
                                          {0, 0, heights.width(), heights.size().height});
    double greatest = 0;
    const auto take = [&](double a, double b) {
        if (!std::isnan(a) && !std::isnan(b)) greatest = std::max(greatest, std::abs(a - b));
    };
    for (int64_t row = beneath.y; row < beneath.y + beneath.height; ++row)
        for (int64_t column = beneath.x; column < beneath.x + beneath.width; ++column) {
            take(coarse(column / side - core.x, row / side - core.y), fine(column, row));
            for (const double down : {0.01, 0.5, 0.99})
                for (const double across : {0.01, 0.5, 0.99}) {
                    const double x = static_cast<double>(column) + across, y = static_cast<double>(row) + down;
                    take(bilinear(coarse, x / static_cast<double>(side) - static_cast<double>(core.x),
                                  y / static_cast<double>(side) - static_cast<double>(core.y)),
                         bilinear(fine, x, y));
                }
        }
    return greatest;
}

/// Single holes and a larger one.
void punch(Grid<float>& heights, int ofThousand, test::Random& random) {
    for (float& height : heights.cells())
        if (random.below(1000) < static_cast<uint64_t>(ofThousand)) height = kNoHeight;
    if (ofThousand == 0) return;
    for (int64_t y = 40; y < 61; ++y)
        for (int64_t x = 1000; x < 1047; ++x) heights.at(x, y) = kNoHeight;
}

struct Terrain {
    const char* name;
    double mostAbove;  ///< error over the greatest distance that is found, at most
    std::function<double(int64_t x, int64_t y, test::Random& random)> height;
};

TEST(SurfaceError, BoundsBothSurfacesBetweenSamplesToo) {
    const std::vector<Terrain> terrains = {
        {"rough", 1.25,
         [](int64_t x, int64_t y, test::Random& random) {
             return 40 * std::sin(static_cast<double>(x) / 50) + 0.3 * static_cast<double>(y) +
                    0.01 * static_cast<double>(random.below(400));
         }},
        {"noise", 1.05,
         [](int64_t, int64_t, test::Random& random) { return 0.1 * static_cast<double>(random.below(5000)); }},
        {"cliff along a tile's border", 1.75, [](int64_t x, int64_t, test::Random&) { return x < 1024 ? 0.0 : 900.0; }},
        {"slanted cliff", 1.25, [](int64_t x, int64_t y, test::Random&) { return 3 * x + y < 2000 ? -120.0 : 777.0; }},
        {"checkerboard", 1.05, [](int64_t x, int64_t y, test::Random&) { return (x + y) % 2 == 0 ? 50.0 : -50.0; }},
        {"checkerboard of 4 x 4", 1.75,
         [](int64_t x, int64_t y, test::Random&) { return (x / 4 + y / 4) % 2 == 0 ? 50.0 : -50.0; }},
        {"spikes", 1.25, [](int64_t, int64_t, test::Random& random) { return random.below(3000) == 0 ? 256.0 : 0.0; }},
        {"plane", 1.05,
         [](int64_t x, int64_t y, test::Random&) {
             return 0.5 * static_cast<double>(x) + 0.25 * static_cast<double>(y);
         }},
    };
    test::Random random(81);
    for (const Terrain& terrain : terrains)
        for (const int holes : {0, 3, 300}) {
            SCOPED_TRACE(testing::Message() << terrain.name << ", " << holes << " holes of 1000");
            Grid<float> heights =
                makeHeights({1100, 90}, [&](int64_t x, int64_t y) { return terrain.height(x, y, random); });
            punch(heights, holes, random);
            const TemporaryDirectory directory;
            (void)buildTestDataset(GridHeights(heights), directory / "out", {.jobs = 2, .depth = 1});
            for (const auto& [id, tile] : readHeightTiles(directory / "out")) {
                const double greatest = greatestDistance(tile, heights, 2);
                EXPECT_GE(tile.record.error, greatest) << id;
                // And not much more: a half of a code's step, and what the bound is worth.
                if (holes > 0 || id.level == 2) continue;
                EXPECT_LE(tile.record.error, terrain.mostAbove * greatest + 0.5 * tile.encoding.metresPerCode()) << id;
            }
            EXPECT_EQ(verifyDataset(openDataset(directory / "out"), 2, kNeverStop).faults.size(), 0u);
        }
}

TEST(SurfaceError, ACliffBetweenSamplesOfEveryLevelIsNotTakenForExact) {
    // Each level's samples have the cliff exactly, as columns do; a bilinear surface is wider by its own spacing. The
    // errors of the tiles on its two sides were 0, so they were drawn from any distance, 225 m off.
    const TemporaryDirectory directory;
    const Grid<float> heights = makeHeights({2048, 32}, [](int64_t x, int64_t) { return x < 1024 ? 0.0 : 900.0; });
    (void)buildTestDataset(GridHeights(heights), directory / "out", {.depth = 1});
    const auto tiles = readHeightTiles(directory / "out");
    EXPECT_EQ(tiles.at({2, 1, 0}).record.error, 0);
    EXPECT_EQ(tiles.at({2, 2, 0}).record.error, 0);
    // A quarter of the cliff one level up, 3/8 at the ground's rim, where missing corners stand at the mean of both
    // sides; and what is added for rounding. At the root the range of heights bounds it.
    const double rounding = 900 * 0x1p-19 + 1e-4;
    for (const uint32_t side : {0u, 1u}) EXPECT_NEAR(tiles.at({1, side, 0}).record.error, 337.5, rounding);
    EXPECT_NEAR(tiles.at({0, 0, 0}).record.error, 675, 2 * rounding);
}

TEST(SurfaceError, GrowsToThreeQuartersOfACliffAndNoFurther) {
    const TemporaryDirectory directory;
    const Grid<float> heights = makeHeights({16384, 4}, [](int64_t x, int64_t) { return x < 8192 ? 0.0 : 800.0; });
    (void)buildTestDataset(GridHeights(heights), directory / "out", {.jobs = 2, .depth = 2});
    const HeightRecord root = readHeightTiles(directory / "out").at({0, 0, 0}).record;
    EXPECT_GE(root.error, 400 * (1 - 1.0 / 32));
    EXPECT_NEAR(root.error, 600, 0.01);
}

TEST(SurfaceError, ADatasetWhoseErrorsHoldAtSamplesOnlyIsStillVerified) {
    const TemporaryDirectory directory;
    const Grid<float> heights = makeHeights({1024, 32}, [](int64_t x, int64_t) { return x < 512 ? 0.0 : 900.0; });
    (void)buildTestDataset(GridHeights(heights), directory / "out");
    const auto claim = [&](bool everywhere) {
        rewriteArchive(directory / "out" / kHeightsFile, [&](Payloads& payloads, std::string& text) {
            HeightTile root = decodeHeightTile(payloads.at({0, 0, 0})).value();
            root.record.error = 0;
            payloads.at({0, 0, 0}) = encodeHeightTile(root);
            DatasetMetadata metadata = metadataFromJson(Json::parse(text).value()).value();
            metadata.levelErrors[0] = 0;
            metadata.errorsHoldEverywhere = everywhere;
            text = toJson(metadata).dump();
        });
        return verifyDataset(openDataset(directory / "out"), 1, kNeverStop).faults;
    };
    EXPECT_TRUE(claim(false).empty());
    const auto faults = claim(true);
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_EQ(faults[0].where, "heights 0/0/0");
    EXPECT_NE(faults[0].what.find("but its children prove 337"), std::string::npos) << faults[0].what;
}

}  // namespace
}  // namespace terray
