#include "common/reference/dataset_heights.h"

#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/reference/ground_caster.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

DatasetHeights heightsOf(const TileSource& source) {
    return {source.metadata(), [&source](const TileId& id) { return source.read(TileLayer::heights, id); }};
}

TEST(DatasetHeights, AreTheSamplesOfTheFinestLevel) {
    const AnalyticDataset dataset({.finestLevel = 2});
    const DatasetHeights heights = heightsOf(dataset);
    ASSERT_EQ(heights.size(), (GridSize{2048, 2048}));
    const GridRect rect{500, 1020, 40, 30};  // over the borders of four tiles
    const Grid<double> read = heights.read(rect);
    const Tiling& tiling = dataset.metadata().tiling;
    const double bound = heights.upperBound(rect);
    for (int64_t y = 0; y < rect.height; ++y)
        for (int64_t x = 0; x < rect.width; ++x) {
            const double east = tiling.west + (static_cast<double>(rect.x + x) + 0.5) * tiling.finestSpacing;
            const double north = tiling.north - (static_cast<double>(rect.y + y) + 0.5) * tiling.finestSpacing;
            ASSERT_NEAR(read.at(x, y), AnalyticDataset::heightAt(east, north), dataset.metadata().quantum);
            ASSERT_LE(read.at(x, y), bound);
        }
}

TEST(DatasetHeights, MayBeToldAsBeforeTheyWereRounded) {
    const AnalyticDataset dataset({.finestLevel = 1});
    const auto read = [&](const TileId& id) { return dataset.read(TileLayer::heights, id); };
    const DatasetHeights stored = heightsOf(dataset);
    const DatasetHeights undone(dataset.metadata(), read, Rounding::undone);
    const GridRect rect{480, 500, 64, 30};
    const Grid<double> before = undone.read(rect);
    const Grid<double> after = stored.read(rect);
    double sum = 0, most = 0;
    for (int64_t y = 0; y < rect.height; ++y)
        for (int64_t x = 0; x < rect.width; ++x) {
            const double moved = before.at(x, y) - after.at(x, y);
            sum += moved;
            most = std::max(most, std::abs(moved));
            ASSERT_LE(before.at(x, y), undone.upperBound({rect.x + x, rect.y + y, 1, 1}));
        }
    const double half = dataset.metadata().quantum / 2;
    EXPECT_LE(most, half);
    EXPECT_GT(most, 0.99 * half);
    EXPECT_NEAR(sum / static_cast<double>(rect.width * rect.height), 0, 0.05 * half) << "without preference up or down";
    EXPECT_EQ(undone.read({500, 510, 1, 1}).at(0, 0), before.at(20, 10)) << "the same each time";
}

TEST(DatasetHeights, WorkForADatasetOfOneTile) {
    const AnalyticDataset dataset({.finestLevel = 0});
    const DatasetHeights heights = heightsOf(dataset);
    EXPECT_FALSE(std::isnan(heights.read({511, 511, 1, 1}).at(0, 0)));
    const uint64_t reads = dataset.reads();
    for (int n = 0; n < 10; ++n) EXPECT_GT(heights.upperBound({0, 0, 512, 512}), 0);
    EXPECT_LE(dataset.reads(), reads + 1) << "bounds are kept";
}

TEST(DatasetHeights, ATileThatCannotBeReadIsADatasetError) {
    AnalyticDataset dataset({.finestLevel = 1});
    dataset.lose(TileLayer::heights, {1, 1, 0});
    const DatasetHeights heights = heightsOf(dataset);
    EXPECT_NO_THROW((void)heights.read({0, 0, 512, 512}));
    try {
        (void)heights.read({510, 0, 4, 4});
        ADD_FAILURE() << "read what is lost";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::dataset);
        EXPECT_NE(std::string(error.what()).find("1/1/0"), std::string::npos) << error.what();
    }
}

TEST(GroundCasterMemory, ABudgetOfOneSquareAndManyThreadsChangeNoAnswer) {
    const AnalyticDataset dataset({.finestLevel = 2});
    const DatasetHeights heights = heightsOf(dataset);
    const GroundCaster roomy(heights, dataset.metadata().tiling, -1e4);
    const GroundCaster narrow(heights, dataset.metadata().tiling, -1e4, 1);
    const GroundRect ground = dataset.metadata().groundBounds();
    View view;
    view.eye = {ground.west - 100, ground.south - 100, 1500};
    const auto directionOf = [&](int n) { return glm::dvec3(0.2 + 0.1 * n, 2.2 - 0.1 * n, -0.2 - 0.02 * (n % 7)); };
    std::array<std::optional<double>, 20> expected;
    for (size_t n = 0; n < expected.size(); ++n) expected[n] = roomy.meet(view, directionOf(static_cast<int>(n)));
    EXPECT_TRUE(expected[3]);
    const auto compareAll = [&] {
        for (size_t n = 0; n < expected.size(); ++n)
            EXPECT_EQ(narrow.meet(view, directionOf(static_cast<int>(n))), expected[n]) << n;
    };
    const std::jthread other(compareAll);
    compareAll();
}

}  // namespace
}  // namespace terray
