#include "client/engine/upload_pace.h"

#include <gtest/gtest.h>

namespace terray {
namespace {

TEST(UploadPace, GivesUploadsTheirShareOfAFramesTime) {
    UploadPace pace(1'000'000'000, 0.5);
    EXPECT_EQ(pace.bytes(), 1u << 20) << "nothing is known yet";
    pace.learn(2, 1'000'000, 40);  // 0.5 MB a millisecond
    EXPECT_NEAR(static_cast<double>(pace.bytes()), 0.5 * 40 * 0.5e6, 1);
    for (int frame = 0; frame < 200; ++frame) pace.learn(1, 1'000'000, 10);
    EXPECT_NEAR(static_cast<double>(pace.bytes()), 0.5 * 10 * 1e6, 1e3) << "uploads and frames have become faster";
}

TEST(UploadPace, BelievesAtOnceThatUploadsCostMore) {
    UploadPace pace(1'000'000'000, 0.5);
    for (int frame = 0; frame < 10; ++frame) pace.learn(1, 1'000'000, 10);
    pace.learn(100, 1'000'000, 10);
    EXPECT_NEAR(static_cast<double>(pace.bytes()), 0.5 * 10 * 1e4, 1);
    pace.learn(1, 1'000'000, 10);
    EXPECT_LT(pace.bytes(), 60'000u) << "one cheap frame proves little";
    pace.learn(0, 0, 10);
    EXPECT_LT(pace.bytes(), 60'000u) << "a frame without uploads proves nothing";
}

TEST(UploadPace, NeverExceedsTheBytesOfAFrame) {
    UploadPace pace(1000, 10);
    EXPECT_EQ(pace.bytes(), 1000u);
    pace.learn(1e-6, 1'000'000, 1000);
    EXPECT_EQ(pace.bytes(), 1000u);
}

}  // namespace
}  // namespace terray
