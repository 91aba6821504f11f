// The draw list's geometry: front to back, nothing culled that a ray meets, every visible place covered once.

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/stream/selection.h"
#include "client/stream/selection_geometry.h"
#include "tests/stream/views.h"

namespace terray::test {
namespace {

/// Where a ray is inside a box, by slabs; empty when enter >= leave.
struct Inside {
    double enter = 0;
    double leave = std::numeric_limits<double>::infinity();
};

void cut(Inside& inside, double eye, double direction, double low, double high) {
    if (direction == 0) {
        if (eye < low || eye > high) inside.leave = -1;
        return;
    }
    const double a = (low - eye) / direction, b = (high - eye) / direction;
    inside.enter = std::max(inside.enter, std::min(a, b));
    inside.leave = std::min(inside.leave, std::max(a, b));
}

glm::dvec3 randomRay(const View& view, Random& random) {
    return view.direction(random.uniform(0, view.width), random.uniform(0, view.height));
}

TEST(SelectionOrder, NoRayMeetsALaterNodeBeforeAnEarlierOne) {
    const FakeDataset& dataset = hillyDataset();
    Random random(1);
    size_t pairs = 0;
    for (int round = 0; round < 400; ++round) {
        const TileTree tree = randomTree(dataset, random);
        const View view = overSomeEarth(randomView(dataset, random), random);
        const auto nodes = select(tree, view, {}).nodes;
        for (int sample = 0; sample < 60; ++sample) {
            const glm::dvec3 ray = randomRay(view, random);
            double reached = 0;  // the farthest that a node before this one begins or ends
            for (const DrawNode& node : nodes) {
                const GroundRect square = tree.tiling().bounds(node.cell);
                Inside inside;
                cut(inside, view.eye.x, ray.x, square.west, square.east);
                cut(inside, view.eye.y, ray.y, square.south, square.north);
                if (inside.leave <= inside.enter) continue;
                const double rounding = 1e-9 * (1 + reached);
                ASSERT_GE(inside.enter, reached - rounding) << node.cell << " in round " << round;
                pairs += reached > 0 ? 1 : 0;
                reached = inside.leave;
            }
        }
    }
    EXPECT_GT(pairs, 5000u);
}

TEST(SelectionOrder, AShuffledListIsSortedIntoTheOrderOfItsSelection) {
    const FakeDataset& dataset = hillyDataset();
    Random random(5);
    for (int round = 0; round < 200; ++round) {
        const TileTree tree = randomTree(dataset, random);
        const View view = randomView(dataset, random);
        const std::vector<DrawNode> selected = select(tree, view, {}).nodes;
        std::vector<DrawNode> nodes(selected.rbegin(), selected.rend());
        for (size_t n = 1; n < nodes.size(); ++n)
            std::swap(nodes[n], nodes[static_cast<size_t>(random.uniform(0, static_cast<double>(n)))]);
        sortFrontToBack(nodes, tree.tiling(), view.eye);
        for (size_t n = 0; n < nodes.size(); ++n) ASSERT_EQ(nodes[n].cell, selected[n].cell) << round;
    }
}

TEST(SelectionOrder, FrustumKeepsEveryBoxThatARayMeets) {
    Random random(2);
    const FakeDataset& dataset = hillyDataset();
    int met = 0, dropped = 0;
    for (int round = 0; round < 20000; ++round) {
        const View view = randomView(dataset, random);
        const glm::dvec3 corner =
            view.eye + glm::dvec3(random.uniform(-900, 900), random.uniform(-900, 900), random.uniform(-300, 300));
        const double size = std::pow(10.0, random.uniform(-3, 2.5));
        const Box box{corner, corner + size * glm::dvec3(1, 1, random.uniform(0, 1))};
        const bool kept = Frustum(view).mayMeet(box);
        dropped += kept ? 0 : 1;
        // Aim at the box itself, so that many rays meet it.
        const glm::dvec3 target = box.min + (box.max - box.min) * random.uniform(0, 1) - view.eye;
        const double depth = glm::dot(target, view.forward);
        const bool inPicture = depth > 0 && std::abs(glm::dot(target, view.right)) <= depth * view.tanHalfWidth() &&
                               std::abs(glm::dot(target, view.up)) <= depth * view.tanHalfHeight;
        met += inPicture ? 1 : 0;
        ASSERT_TRUE(kept || !inPicture) << round;
    }
    EXPECT_GT(met, 1000);
    EXPECT_GT(dropped, 1000);
}

TEST(SelectionOrder, EveryVisiblePlaceIsCoveredByExactlyOneNode) {
    const FakeDataset& dataset = hillyDataset();
    Random random(3);
    int visible = 0, overCurvedEarth = 0;
    for (int round = 0; round < 300; ++round) {
        const TileTree tree = randomTree(dataset, random);
        View view = overSomeEarth(randomView(dataset, random), random);
        if (random.chance(0.5)) view = exaggerated(view, std::pow(10.0, random.uniform(-1, 1)));
        const auto nodes = select(tree, view, {}).nodes;
        for (int sample = 0; sample < 100; ++sample) {
            const glm::dvec2 place = randomPlace(dataset, random);
            glm::dvec3 offset = glm::dvec3(place, view.exaggeration * groundHeight(dataset, place)) - view.eye;
            if (view.earth) offset.z -= view.earth->drop(glm::dvec2(offset));
            const double depth = glm::dot(offset, view.forward);
            if (depth <= 0 || std::abs(glm::dot(offset, view.right)) > depth * view.tanHalfWidth() ||
                std::abs(glm::dot(offset, view.up)) > depth * view.tanHalfHeight)
                continue;
            ++visible;
            overCurvedEarth += view.earth ? 1 : 0;
            const auto covers = [&](const DrawNode& node) {
                const GroundRect square = tree.tiling().bounds(node.cell);
                return place.x >= square.west && place.x < square.east && place.y > square.south &&
                       place.y <= square.north;
            };
            // A stand-in may lie so much lower or higher than the finest ground that its box is out of sight there.
            const auto count = std::count_if(nodes.begin(), nodes.end(), covers);
            ASSERT_LE(count, 1) << round;
            if (count == 0) ADD_FAILURE() << "round " << round << " place " << place.x << ", " << place.y;
        }
    }
    EXPECT_GT(visible - overCurvedEarth, 1000);
    EXPECT_GT(overCurvedEarth, 1000);
}

TEST(SelectionOrder, OverACurvedEarthABoxHoldsAllThatItsCellShows) {
    const Tiling& tiling = hillyDataset().metadata.tiling;
    Random random(4);
    for (int round = 0; round < 500; ++round) {
        const View view = overSomeEarth(randomView(hillyDataset(), random), random);
        const TileId cell{3, static_cast<uint32_t>(random.uniform(0, 8)), static_cast<uint32_t>(random.uniform(0, 8))};
        const HeightRange heights{-50, 200};
        const Box box = seenBoxOf(cell, heights, tiling, view), onMap = boxOf(cell, heights, tiling);
        if (!view.earth) {
            EXPECT_EQ(box.min, onMap.min);
            EXPECT_EQ(box.max, onMap.max);
            continue;
        }
        for (int sample = 0; sample < 50; ++sample) {
            const glm::dvec3 place(random.uniform(onMap.min.x, onMap.max.x), random.uniform(onMap.min.y, onMap.max.y),
                                   sample % 2 == 0 ? heights.min : heights.max);
            const double seen = place.z - view.earth->drop(glm::dvec2(place - view.eye));
            ASSERT_GE(seen, box.min.z - 1e-9);
            ASSERT_LE(seen, box.max.z + 1e-9);
        }
    }
}

TEST(SelectionOrder, DistanceIsToTheNearestPointOfTheBox) {
    const Box box{{0, 0, 0}, {10, 20, 30}};
    EXPECT_EQ(distanceTo(box, {5, 5, 5}).value(), 0);
    EXPECT_EQ(distanceTo(box, {-3, 5, 34}).value(), 5);
    EXPECT_EQ(distanceTo(box, {10, 20, 31}).value(), 1);
}

}  // namespace
}  // namespace terray::test
