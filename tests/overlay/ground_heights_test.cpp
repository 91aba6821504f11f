#include "client/overlay/ground_heights.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/common/random.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

TEST(GroundHeights, AreThoseOfTheFinestSamples) {
    const AnalyticDataset dataset({.finestLevel = 2, .spacing = 4});
    GroundHeights heights(dataset);
    const GroundRect ground = dataset.metadata().groundBounds();
    test::Random random(1);
    for (int i = 0; i < 300; ++i) {
        const double x = random.between(ground.west, ground.east);
        const double y = random.between(ground.south + 1e-6, ground.north);
        const auto height = heights.at({x, y});
        ASSERT_TRUE(height.has_value());
        // The sample's centre is within half a cell.
        const double centreX = ground.west + (std::floor((x - ground.west) / 4) + 0.5) * 4;
        const double centreY = ground.north - (std::floor((ground.north - y) / 4) + 0.5) * 4;
        EXPECT_NEAR(*height, AnalyticDataset::heightAt(centreX, centreY), dataset.metadata().quantum);
    }
}

TEST(GroundHeights, EndAtTheDatasetsEdge) {
    const AnalyticDataset dataset({.finestLevel = 1, .spacing = 4});
    GroundHeights heights(dataset);
    const GroundRect ground = dataset.metadata().groundBounds();
    EXPECT_TRUE(heights.at({ground.west, ground.north}).has_value());
    EXPECT_TRUE(heights.at({ground.east - 1e-3, ground.south + 1e-3}).has_value());
    EXPECT_FALSE(heights.at({ground.west - 1e-3, ground.north}).has_value());
    EXPECT_FALSE(heights.at({ground.east, ground.north}).has_value());
    EXPECT_FALSE(heights.at({ground.west, ground.south}).has_value());
}

TEST(GroundHeights, OfNeighboursAreReadOnce) {
    const AnalyticDataset dataset({.finestLevel = 2, .spacing = 4});
    GroundHeights heights(dataset);
    const GroundRect ground = dataset.metadata().groundBounds();
    for (int i = 0; i < 100; ++i) (void)heights.at({ground.west + i, ground.north - i});
    EXPECT_EQ(dataset.reads(), 3u) << "root, and two below";
}

TEST(GroundHeights, OfATileThatCannotBeReadAreAnError) {
    AnalyticDataset dataset({.finestLevel = 1, .spacing = 4});
    dataset.lose(TileLayer::heights, TileId{}.child(0));
    GroundHeights heights(dataset);
    const GroundRect ground = dataset.metadata().groundBounds();
    try {
        (void)heights.at({ground.west, ground.north});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::dataset);
    }
}

}  // namespace
}  // namespace terray
