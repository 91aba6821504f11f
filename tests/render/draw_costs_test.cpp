// The hybrid's cost model: what it tells of a node before it is drawn, what it learns from times, and how it chooses.

#include "client/render/draw_costs.h"

#include <cmath>

#include <gtest/gtest.h>

#include "client/render/node_parameters.h"

namespace terray {
namespace {

/// A box of 100 m around the origin, seen from the south: 512 texels of 100 / 512 m, codes of 1 m from 0 to 100.
interop::NodeParameters boxFrom(const View& view) {
    const double spacing = 100.0 / 512;
    interop::NodeParameters node{};
    node.eye = {(view.eye.x + 50) / spacing, (50 - view.eye.y) / spacing, view.eye.z + 50, spacing};
    node.right.w = 1;
    node.boxMin = {0, 0, 0, 0};
    node.boxMax = {512, 512, 100, 0};
    node.source.w = 8;
    return node;
}

View viewFrom(const glm::dvec3& eye) {
    View view{.eye = eye, .width = 400, .height = 200};  // looks north, 1 at the lower and upper edge per 2 of depth
    return view;
}

TEST(NodeWork, PixelsAreTheAreaOfTheBoxesOutlineInThePicture) {
    // From 450 m before its front face: 100 m at depth 450 is 100 / 450 * 200 pixels.
    const View far = viewFrom({0, -500, 0});
    const double side = 100.0 / 450 * far.focalPixels();
    EXPECT_NEAR(coveredPixels(boxFrom(far), far), side * side, 1e-3 * side * side);
    // In a picture that is narrower than the box.
    View narrow = far;
    narrow.width = 20;
    EXPECT_NEAR(coveredPixels(boxFrom(narrow), narrow), 20 * side, 0.02 * side);
    // From within it is all of the picture, behind the eye none of it.
    EXPECT_NEAR(coveredPixels(boxFrom(viewFrom({0, 0, 0})), viewFrom({0, 0, 0})), 400 * 200, 1);
    EXPECT_EQ(coveredPixels(boxFrom(viewFrom({0, 500, 0})), viewFrom({0, 500, 0})), 0);
}

TEST(NodeWork, FlatRaysTakeMoreStepsThanSteepOnes) {
    const auto stepsFrom = [](const glm::dvec3& eye) { return workOf(boxFrom(viewFrom(eye)), viewFrom(eye), 7).steps; };
    EXPECT_GT(stepsFrom({0, -500, 0}), stepsFrom({0, -300, 600}));
    EXPECT_GT(stepsFrom({0, -300, 600}), stepsFrom({0, -1, 500}));
    EXPECT_EQ(workOf(boxFrom(viewFrom({0, -500, 0})), viewFrom({0, -500, 0}), 7).triangles, 7);
}

TEST(DrawCosts, AreFoundAgainFromTimesThatFollowThem) {
    const DrawCosts truth{.castNode = 0.02,
                          .castPixel = 3e-5,
                          .castStep = 2e-6,
                          .meshNode = 0.3,
                          .meshPixel = 1e-5,
                          .meshTriangle = 4e-4};
    std::vector<CostSample> samples;
    for (const double pixels : {500.0, 20'000.0, 400'000.0})
        for (const double steps : {9.0, 17.0, 25.0})
            for (const double triangles : {100.0, 5'000.0, 300'000.0}) {
                const NodeWork work{.pixels = pixels, .steps = steps, .triangles = triangles};
                constexpr double kEmpty = 3;  // of every frame
                samples.push_back({.work = work,
                                   .castMs = kEmpty + truth.castMs(work),
                                   .meshMs = kEmpty + truth.meshMs(work),
                                   .emptyMs = kEmpty,
                                   .makeMs = triangles < 1'000 ? 10.0 : 25.0});
            }
    const DrawCosts found = fittedCosts(samples);
    for (double DrawCosts::*cost : {&DrawCosts::castNode, &DrawCosts::castPixel, &DrawCosts::castStep,
                                    &DrawCosts::meshNode, &DrawCosts::meshPixel, &DrawCosts::meshTriangle})
        EXPECT_NEAR(found.*cost, truth.*cost, 1e-6 * truth.*cost);
    EXPECT_DOUBLE_EQ(found.meshMake, 20) << "the mean of 10, 25 and 25";
    // Times that fall with the steps are no reason for a step to cost less than nothing.
    for (CostSample& sample : samples) sample.castMs = 1 + 1e-5 * sample.work.pixels * (30 - sample.work.steps);
    const DrawCosts odd = fittedCosts(samples);
    EXPECT_GE(std::min({odd.castNode, odd.castPixel, odd.castStep}), 0);
    EXPECT_GT(odd.castMs(samples.back().work), 0);
}

TEST(HybridChoice, TakesTheCheaperWayAndStaysWithItUntilTheOtherIsMuchCheaper) {
    const DrawCosts costs{.castPixel = 1, .meshTriangle = 1};
    const std::vector<DrawNode> nodes{{.cell = {1, 0, 0}}, {.cell = {1, 1, 0}}};
    HybridChoice choice;
    const auto choose = [&](double pixels, double triangles) {
        const std::vector<NodeWork> work{{.pixels = pixels, .triangles = triangles}, {.pixels = 1, .triangles = 100}};
        const std::vector<uint8_t> chosen = choice.choose(nodes, work, costs);
        EXPECT_EQ(chosen[1], 0) << "of the other node";
        return chosen[0] == 1;
    };
    EXPECT_FALSE(choose(100, 90)) << "a tenth does not pay for making triangles";
    EXPECT_TRUE(choose(100, 60));
    EXPECT_TRUE(choose(90, 100)) << "nor is it a reason to flip";
    EXPECT_TRUE(choose(100, 90));
    EXPECT_FALSE(choose(70, 100));
    EXPECT_FALSE(choose(100, 90)) << "nor back";
    EXPECT_TRUE(choose(100, 60));
    // A cell that was not drawn in between begins anew.
    EXPECT_TRUE(choice.choose({}, {}, costs).empty());
    EXPECT_FALSE(choose(100, 90));
}

TEST(HybridChoice, MakesATilesTrianglesOnceTheyWouldHaveSavedTheirOwnTime) {
    const DrawCosts costs{.castPixel = 1, .meshTriangle = 1, .meshMake = 100};
    HybridChoice choice;
    // Two cells of one tile; together they save 20 + 10 a frame.
    const std::vector<DrawNode> nodes{{.cell = {2, 0, 0}, .heightTile = {1, 0, 0}},
                                      {.cell = {2, 1, 0}, .heightTile = {1, 0, 0}}};
    std::vector<NodeWork> work{{.pixels = 40, .triangles = 20, .isMade = false},
                               {.pixels = 30, .triangles = 20, .isMade = false}};
    for (int frame = 0; frame < 3; ++frame)
        EXPECT_EQ(choice.choose(nodes, work, costs), (std::vector<uint8_t>{0, 0})) << frame;
    EXPECT_EQ(choice.choose(nodes, work, costs), (std::vector<uint8_t>{1, 1})) << "after 3 x 30 and 20 ms";
    for (NodeWork& node : work) node.isMade = true;
    EXPECT_EQ(choice.choose(nodes, work, costs), (std::vector<uint8_t>{1, 1}));
    // A tile that is there costs nothing to begin with; one that is out of sight for a while is not forgotten.
    HybridChoice other;
    EXPECT_EQ(other.choose(nodes, work, costs), (std::vector<uint8_t>{1, 1}));
    for (NodeWork& node : work) node.isMade = false;
    HybridChoice interrupted;
    for (int frame = 0; frame < 3; ++frame) {
        EXPECT_EQ(interrupted.choose(nodes, work, costs), (std::vector<uint8_t>{0, 0})) << frame;
        (void)interrupted.choose({}, {}, costs);
    }
    EXPECT_EQ(interrupted.choose(nodes, work, costs), (std::vector<uint8_t>{1, 1}));
}

}  // namespace
}  // namespace terray
