#include "common/parallel.h"

#include <numeric>
#include <optional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "common/error.h"

namespace terray {
namespace {

TEST(Parallel, DoesEveryItemOnceOnWorkersInRange) {
    for (const int jobs : {1, 2, 7}) {
        std::vector<std::atomic<int>> done(100);
        const std::atomic<bool> stop = false;
        forEachParallel(done.size(), jobs, stop, [&](int worker, size_t item) {
            EXPECT_GE(worker, 0);
            EXPECT_LT(worker, jobs);
            ++done[item];
        });
        for (const auto& count : done) EXPECT_EQ(count, 1);
    }
    const std::atomic<bool> stop = false;
    forEachParallel(0, 3, stop, [](int, size_t) { FAIL() << "there was nothing to do"; });
}

TEST(Parallel, DoesTheItemsThatItIsGivenAndEndsWithAFailureToGiveOne) {
    const std::atomic<bool> stop = false;
    std::atomic<int> left = 50;
    std::atomic<int> sum = 0;
    const auto next = [&]() -> std::optional<size_t> {
        const int item = --left;
        return item < 0 ? std::nullopt : std::optional(static_cast<size_t>(item));
    };
    forEachParallel(next, 3, stop, [&](int, size_t item) { sum += static_cast<int>(item); });
    EXPECT_EQ(sum, 49 * 50 / 2);
    const auto failing = []() -> std::optional<size_t> { throw std::runtime_error("nobody answers"); };
    EXPECT_THROW(forEachParallel(failing, 3, stop, [](int, size_t) { FAIL() << "nothing was given"; }),
                 std::runtime_error);
}

TEST(Parallel, ReportsTheFailureOfTheLowestItemAndStops) {
    const std::atomic<bool> stop = false;
    std::atomic<int> done = 0;
    try {
        forEachParallel(100000, 4, stop, [&](int, size_t item) {
            ++done;
            if (item >= 10) throw std::runtime_error(std::to_string(item));
        });
        FAIL() << "no failure was reported";
    } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "10");
    }
    EXPECT_LT(done, 100);
}

TEST(Parallel, AStopRequestEndsTheWork) {
    std::atomic<bool> stop = false;
    std::atomic<int> done = 0;
    try {
        forEachParallel(100000, 2, stop, [&](int, size_t) {
            if (++done == 5) stop = true;
        });
        FAIL() << "the stop went unseen";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::interrupted);
    }
    EXPECT_LT(done, 100);
}

}  // namespace
}  // namespace terray
