// What craters and strokes do to heights, and the bounds of it.

#include "common/terrain_edit.h"

#include <cmath>

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "common/edit_bounds.h"
#include "tests/common/random.h"
#include "tests/support/edited_tile.h"

namespace terray {
namespace {

using Kind = TerrainEdit::Kind;

TerrainEdit crater(glm::dvec2 centre, double radius, double depth, double rim) {
    return {.kind = Kind::crater, .line = {{centre, centre}}, .radius = radius, .height = depth, .rim = rim};
}

double after(const TerrainEdit& edit, double height, glm::dvec2 place) {
    return editedHeight(height, place, std::span(&edit, 1));
}

TEST(TerrainEdit, ACraterIsABowlWithARimAsDeepAndHighAsItSays) {
    const TerrainEdit edit = crater({100, 200}, 50, 30, 8);
    const auto at = [&](double distance) { return after(edit, 1000, {100 + 0.6 * distance, 200 - 0.8 * distance}); };
    EXPECT_NEAR(at(0), 970, 1e-9);
    EXPECT_NEAR(at(25), 970 + 38 * 0.25, 1e-9);
    EXPECT_NEAR(at(50), 1008, 1e-9);
    EXPECT_NEAR(at(75), 1000 + 8 * 0.25, 1e-9);
    EXPECT_EQ(at(100), 1000);
    EXPECT_EQ(at(1000), 1000);
    for (const double joint : {50.0, 100.0}) EXPECT_NEAR(at(joint - 1e-7), at(joint + 1e-7), 1e-6);
}

TEST(TerrainEdit, StrokesHaveTheirFullEffectAlongTheLineAndEndAtTheirRadius) {
    const std::vector<glm::dvec2> points = {{0, 0}, {100, 0}, {100, 100}};
    TerrainEdit edit{.kind = Kind::raise, .line = segmentsThrough(points), .radius = 20, .full = 10, .height = -6};
    EXPECT_EQ(after(edit, 50, {40, 10}), 44);
    EXPECT_EQ(after(edit, 50, {110, 60}), 44);
    EXPECT_NEAR(after(edit, 50, {40, -15}), 47, 1e-12) << "half way";
    EXPECT_NEAR(after(edit, 50, {-12.5, 0}), 50 - 6 * (1 - 0.0625 * 2.5), 1e-12) << "beyond the end";
    EXPECT_EQ(after(edit, 50, {40, 20}), 50);
    edit.kind = Kind::level;
    edit.height = 300;
    EXPECT_EQ(after(edit, -7.3, {40, 5}), 300);
    EXPECT_NEAR(after(edit, 100, {40, 15}), 200, 1e-12);
    EXPECT_EQ(after(edit, -7.3, {40, 20}), -7.3) << "to the last bit";
}

TEST(TerrainEdit, OrderMatters) {
    const TerrainEdit raise{.kind = Kind::raise, .line = {{}}, .radius = 10, .full = 5, .height = 40};
    const TerrainEdit level{.kind = Kind::level, .line = {{}}, .radius = 10, .full = 5, .height = 100};
    EXPECT_EQ(editedHeight(7, {0, 0}, std::vector{raise, level}), 100);
    EXPECT_EQ(editedHeight(7, {0, 0}, std::vector{level, raise}), 140);
}

TEST(TerrainEdit, KeepsTheOrderOfHeightsAndTheirDistanceAtMost) {
    test::Random random(2);
    const GroundRect ground{0, 0, 5000, 5000};
    for (int round = 0; round < 200; ++round) {
        const EditList edits = randomEdits([&](double a, double b) { return random.between(a, b); }, ground, 1, 8);
        const glm::dvec2 place(random.between(0, 5000), random.between(0, 5000));
        const double low = random.between(-500, 500), high = low + random.between(0, 300);
        const double moved = editedHeight(high, place, edits) - editedHeight(low, place, edits);
        EXPECT_GE(moved, -1e-9);
        EXPECT_LE(moved, high - low + 1e-9);
    }
}

TEST(TerrainEdit, ThoseNearARectangleDoThereWhatAllDo) {
    test::Random random(3);
    const auto uniform = [&](double a, double b) { return random.between(a, b); };
    int left = 0, changed = 0;
    for (int round = 0; round < 300; ++round) {
        const EditList edits = randomEdits(uniform, {0, 0, 5000, 5000}, 1, 12);
        const double west = uniform(0, 4500), south = uniform(0, 4500);
        const GroundRect rect{west, south, west + uniform(0, 500), south + uniform(0, 500)};
        const EditList near = editsNear(edits, rect);
        left += near.size() < edits.size() ? 1 : 0;
        for (int i = 0; i < 20; ++i) {
            const glm::dvec2 place(uniform(rect.west, rect.east), uniform(rect.south, rect.north));
            EXPECT_EQ(editedHeight(50, place, near), editedHeight(50, place, edits)) << "to the last bit";
            changed += editedHeight(50, place, near) != 50 ? 1 : 0;
        }
    }
    EXPECT_GT(left, 250);
    EXPECT_GT(changed, 500);
}

TEST(EditBounds, HoldEveryHeightAndEveryDifference) {
    test::Random random(4);
    const auto uniform = [&](double a, double b) { return random.between(a, b); };
    double closest = 1e9, tightest = 0;
    for (int round = 0; round < 1000; ++round) {
        const EditList edits = randomEdits(uniform, {0, 0, 1000, 1000}, 1, static_cast<int>(uniform(1, 7)));
        const double west = uniform(-100, 1000), south = uniform(-100, 1000), side = std::pow(10, uniform(-1, 3));
        const GroundRect rect{west, south, west + side, south + side};
        const HeightSpan before{uniform(-400, 0), uniform(0, 400)};
        const double apart = side * uniform(0, 0.3);
        const EditList near = editsNear(edits, rect);
        const EditBounds bounds = editBounds(near, rect, before, apart);
        for (int i = 0; i < 60; ++i) {
            const glm::dvec2 place(uniform(rect.west, rect.east), uniform(rect.south, rect.north));
            const double turn = uniform(0, 6.2831853);
            const glm::dvec2 beside = glm::clamp(place + apart * glm::dvec2(std::cos(turn), std::sin(turn)),
                                                 glm::dvec2(rect.west, rect.south), glm::dvec2(rect.east, rect.north));
            const double height = uniform(before.lowest, before.highest);
            const double here = editedHeight(height, place, edits), there = editedHeight(height, beside, edits);
            ASSERT_GE(here, bounds.heights.lowest - 1e-9);
            ASSERT_LE(here, bounds.heights.highest + 1e-9);
            ASSERT_LE(std::abs(here - there), bounds.variation + 1e-9);
            closest = std::min(closest, bounds.heights.highest - here);
            if (bounds.variation > 1) tightest = std::max(tightest, std::abs(here - there) / bounds.variation);
        }
    }
    EXPECT_LT(closest, 0.1) << "bounds that nothing comes near to are none";
    EXPECT_GT(tightest, 0.8);
}

TEST(EditBounds, OfGroundThatNoEditReachesAreThoseItHad) {
    const TerrainEdit edit = crater({0, 0}, 10, 5, 1);
    const EditBounds bounds = editBounds(std::span(&edit, 1), {20, 0, 30, 10}, {3, 9}, 2);
    EXPECT_EQ(bounds.heights, (HeightSpan{3, 9}));
    EXPECT_EQ(bounds.variation, 0);
}

TEST(TerrainEdit, ValidEditsAreAsTheirCommentsSay) {
    const TerrainEdit good = crater({0, 0}, 10, 5, 1);
    EXPECT_TRUE(valid(std::vector{good}));
    EXPECT_TRUE(valid(EditList{}));
    const auto broken = [&](const auto& change) {
        TerrainEdit edit = good;
        change(edit);
        return !valid(std::vector{good, edit});
    };
    EXPECT_TRUE(broken([](TerrainEdit& e) { e.line.clear(); }));
    EXPECT_TRUE(broken([](TerrainEdit& e) { e.line[0].to.x = 1; }));
    EXPECT_TRUE(broken([](TerrainEdit& e) { e.line[0].from.x = e.line[0].to.x = std::nan(""); }));
    EXPECT_TRUE(broken([](TerrainEdit& e) { e.radius = 0; }));
    EXPECT_TRUE(broken([](TerrainEdit& e) { e.full = 10; }));
    EXPECT_TRUE(broken([](TerrainEdit& e) { e.height = -1; }));
    EXPECT_TRUE(broken([](TerrainEdit& e) { e.rim = -1; }));
    EXPECT_FALSE(broken([](TerrainEdit& e) { e.height = 6e6; }));
    EXPECT_FALSE(valid(EditList(2, crater({0, 0}, 10, 6e6, 1)))) << "together";
}

TEST(TerrainEdit, FootprintsHoldAllThatChanges) {
    test::Random random(5);
    const auto uniform = [&](double a, double b) { return random.between(a, b); };
    for (const TerrainEdit& edit : randomEdits(uniform, {0, 0, 100, 100}, 1, 60)) {
        const GroundRect rect = footprint(edit);
        for (int i = 0; i < 200; ++i) {
            const glm::dvec2 place(uniform(-100, 200), uniform(-100, 200));
            const bool inside =
                place.x > rect.west && place.x < rect.east && place.y > rect.south && place.y < rect.north;
            EXPECT_TRUE(inside || after(edit, 3, place) == 3);
        }
    }
}

}  // namespace
}  // namespace terray
