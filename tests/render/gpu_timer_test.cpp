#include "client/render/gpu_timer.h"

#include <numeric>
#include <set>

#include "client/render/frame_targets.h"
#include "tests/render/gl_test.h"

namespace terray {
namespace {

using GpuTimerTest = GlTest;

/// Work that takes the GPU some time.
void clearMany(const FrameTargets& targets) {
    for (int i = 0; i < 20; ++i) {
        const GLuint value = 0;
        glClearTexImage(targets.node.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
    }
}

double& of(std::array<double, kGpuPasses>& times, GpuPass pass) {
    return times.at(static_cast<size_t>(pass));
}

TEST_F(GpuTimerTest, GivesTimeToThePassesThatWereEnteredOnly) {
    const FrameTargets targets(512, 512, {});
    GpuTimer timer;
    timer.enter(GpuPass::id);
    clearMany(targets);
    timer.enter(GpuPass::resolve);
    clearMany(targets);
    auto times = timer.finishFrame();
    EXPECT_GT(of(times, GpuPass::id), 0);
    EXPECT_GT(of(times, GpuPass::resolve), 0);
    EXPECT_EQ(of(times, GpuPass::upload), 0);
    EXPECT_EQ(of(times, GpuPass::march), 0);
}

TEST_F(GpuTimerTest, AddsUpAPassThatIsEnteredManyTimes) {
    const FrameTargets targets(512, 512, {});
    GpuTimer timer;
    for (int i = 0; i < 50; ++i) {
        timer.enter(GpuPass::id);
        timer.enter(GpuPass::march);
        clearMany(targets);
    }
    auto times = timer.finishFrame();
    EXPECT_GE(of(times, GpuPass::id), 0);
    EXPECT_GT(of(times, GpuPass::march), of(times, GpuPass::id));  // a thousand clears against none
}

TEST_F(GpuTimerTest, StartsEveryFrameAtZero) {
    const FrameTargets targets(64, 64, {});
    GpuTimer timer;
    timer.enter(GpuPass::upload);
    clearMany(targets);
    auto times = timer.finishFrame();
    EXPECT_GT(of(times, GpuPass::upload), 0);
    timer.enter(GpuPass::march);
    clearMany(targets);
    times = timer.finishFrame();
    EXPECT_EQ(of(times, GpuPass::upload), 0);
    EXPECT_GT(of(times, GpuPass::march), 0);
}

TEST_F(GpuTimerTest, AFrameWithoutPassesTakesNoTime) {
    GpuTimer timer;
    const auto times = timer.finishFrame();
    EXPECT_EQ(std::accumulate(times.begin(), times.end(), 0.0), 0);
}

TEST(GpuPass, HasItsOwnName) {
    std::set<std::string_view> names;
    for (size_t i = 0; i < kGpuPasses; ++i) names.insert(name(static_cast<GpuPass>(i)));
    EXPECT_EQ(names, (std::set<std::string_view>{"upload", "edit", "id", "march", "shadow", "resolve", "overlay"}));
}

}  // namespace
}  // namespace terray
