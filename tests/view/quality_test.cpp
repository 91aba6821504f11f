#include "client/view/quality.h"

#include <cmath>

#include <gtest/gtest.h>

namespace terray {
namespace {

/// A machine that takes `fullMs` for a full frame, in proportion to pixels, and half of that by tiles.
double frameMs(const Quality& quality, double fullMs) {
    return fullMs * quality.scale() * quality.scale() * (0.5 + 0.5 / quality.toleranceFactor());
}

/// After so many moving frames at 60 a second.
Quality flown(double targetFps, double fullMs, int frames) {
    Quality quality;
    quality.setTarget(targetFps);
    for (int n = 0; n < frames; ++n) quality.tell(frameMs(quality, fullMs), 1.0 / 60, true);
    return quality;
}

TEST(Quality, HoldsTheRateThatTheMachineCanReach) {
    for (const double fullMs : {20.0, 40.0, 60.0, 80.0}) {
        const Quality quality = flown(30, fullMs, 300);
        EXPECT_LT(frameMs(quality, fullMs), 1.12 * 1000 / 30) << fullMs;
        if (fullMs < 30) {
            EXPECT_EQ(quality.scale(), 1) << "nothing is given up in vain";
            EXPECT_EQ(quality.toleranceFactor(), 1);
        }
    }
}

TEST(Quality, GivesUpPixelsBeforeTilesAndNoMoreThanItMay) {
    const Quality little = flown(30, 40, 300);
    EXPECT_LT(little.scale(), 1);
    EXPECT_EQ(little.toleranceFactor(), 1);
    const Quality all = flown(30, 1000, 300);
    EXPECT_EQ(all.scale(), Quality::kLeastScale);
    EXPECT_EQ(all.toleranceFactor(), Quality::kMostTolerance);
}

TEST(Quality, IsFullAtRestAndComesBackWithTheMotion) {
    Quality quality = flown(30, 1000, 300);
    quality.tell(1, 0.1, false);
    EXPECT_TRUE(quality.sharpening());
    EXPECT_LT(quality.scale(), 1) << "a moment's rest is none";
    quality.tell(1, 0.2, false);
    EXPECT_FALSE(quality.sharpening());
    EXPECT_EQ(quality.scale(), 1);
    EXPECT_EQ(quality.toleranceFactor(), 1);
    quality.tell(1000, 0.1, true);
    EXPECT_EQ(quality.scale(), Quality::kLeastScale);
}

TEST(Quality, WithoutATargetIsAlwaysFull) {
    EXPECT_EQ(flown(0, 1000, 100).scale(), 1);
    EXPECT_EQ(flown(0, 1000, 100).toleranceFactor(), 1);
}

TEST(Quality, SettlesInsteadOfSwinging) {
    Quality quality = flown(30, 60, 300);
    double least = 1, most = 0;
    for (int n = 0; n < 100; ++n) {
        quality.tell(frameMs(quality, 60), 1.0 / 60, true);
        least = std::min(least, quality.scale());
        most = std::max(most, quality.scale());
    }
    EXPECT_LE(most - least, 0.126) << "a step of an eighth at most";
}

}  // namespace
}  // namespace terray
