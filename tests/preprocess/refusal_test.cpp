// Builds that cannot be finished end with the right kind of error, and leave nothing behind but what is worth keeping.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

/// How a build that is to fail is run.
struct Attempt {
    const std::atomic<bool>* stop = nullptr;
    int jobs = 2;
};

/// Builds into a directory of its own; expects an error, and after it nothing, or what another run can go on with.
Error refusal(const HeightSource& heights, const Attempt& attempt = {}) {
    const TemporaryDirectory directory;
    BuildRequest request;
    request.out = directory / "out";
    request.jobs = attempt.jobs;
    request.stop = attempt.stop;
    Error found(ExitCode::ok, "the build went well");
    try {
        (void)buildDataset(heights, {}, request);
    } catch (const Error& error) {
        found = error;
    }
    const bool isKept = std::string(found.what()).find("--resume") != std::string::npos;
    EXPECT_EQ(directory.names(), isKept ? std::vector<std::string>{"out.partial"} : std::vector<std::string>{});
    return found;
}

TEST(Refusal, ASourceWithoutAnyHeight) {
    const Error error = refusal(GridHeights(Grid<float>({700, 600}, kNoHeight)));
    EXPECT_EQ(error.code(), ExitCode::input);
    EXPECT_NE(std::string(error.what()).find("no valid height"), std::string::npos);
}

TEST(Refusal, AnEmptySource) {
    GridHeights source(Grid<float>({1, 1}, 1.0f));
    source.info_.size = {0, 5};
    EXPECT_EQ(refusal(source).code(), ExitCode::input);
    source.info_.size = {5, 5};
    source.info_.spacing = 0;
    EXPECT_EQ(refusal(source).code(), ExitCode::input);
}

TEST(Refusal, AnUndeclaredNodataValueIsNamedWithItsPlace) {
    Grid<float> heights({700, 600}, 5.0f);
    heights.at(650, 20) = -std::numeric_limits<float>::max();
    const Error error = refusal(GridHeights(heights));
    EXPECT_EQ(error.code(), ExitCode::input);
    EXPECT_NE(std::string(error.what()).find("column 650, row 20"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("--nodata"), std::string::npos);
}

TEST(Refusal, ASourceThatCannotBeReadToItsEnd) {
    for (const int failing : {1, 2, 4}) {
        GridHeights source(makeHills({2100, 2100}, 1, 0));
        std::atomic<int> reads = 0;
        source.onRead_ = [&] {
            if (++reads == failing) throw Error(ExitCode::input, "cannot read a.tif: it is cut short");
        };
        const Error error = refusal(source);
        EXPECT_EQ(error.code(), ExitCode::input);
        EXPECT_EQ(std::string(error.what()).find("cannot read a.tif: it is cut short"), 0u);
    }
}

TEST(Refusal, AnInterruptedBuild) {
    for (const int jobs : {1, 2}) {
        GridHeights source(makeHills({2100, 2100}, 1, 0));
        std::atomic<bool> stop = false;
        std::atomic<int> reads = 0;
        source.onRead_ = [&] {
            if (++reads == 2) stop = true;
        };
        EXPECT_EQ(refusal(source, {.stop = &stop, .jobs = jobs}).code(), ExitCode::interrupted);
        EXPECT_LE(reads, 3);
    }
}

}  // namespace
}  // namespace terray
