#include "client/stream/http_client.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <thread>

#include <gtest/gtest.h>

#include "tests/common/temporary_directory.h"
#include "tests/support/fault_server.h"

namespace terray::test {
namespace {

using Clock = std::chrono::steady_clock;

class HttpClientTest : public testing::Test {
  protected:
    static void SetUpTestSuite() { setenv("no_proxy", "*", 1); }
    HttpClientTest() { std::ofstream(folder_ / "file") << std::string(10000, 'x'); }

    [[nodiscard]] HttpRequest request() const { return {.url = server_.address() + "/file", .range = {100, 5000}}; }
    /// Milliseconds from now until each of `count` requests ends, by ticket.
    static std::map<uint64_t, int64_t> ends(HttpClient& client, size_t count) {
        const Clock::time_point start = Clock::now();
        std::map<uint64_t, int64_t> times;
        while (times.size() < count)
            for (const HttpEnd& end : client.wait(true)) {
                const auto passed = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start);
                EXPECT_TRUE(times.emplace(end.ticket, passed.count()).second) << "ended twice";
            }
        return times;
    }

    TemporaryDirectory folder_;
    FaultServer server_{folder_.path()};
};

TEST_F(HttpClientTest, PausesDoubleUpToTheLongest) {
    server_.setFault(Fault::status500);
    HttpClient client({.attempts = 5, .firstBackOffMs = 40, .longestBackOffMs = 100});
    client.begin(1, request());
    // A half of 40, 80, 100 and 100 ms at least, and with the other half 320 ms at most.
    const int64_t took = ends(client, 1).at(1);
    EXPECT_GE(took, 160);
    EXPECT_LT(took, 320 + 1000);  // other programs may hold us up
    EXPECT_EQ(server_.requests(), 5u);
    EXPECT_EQ(client.statistics().retries, 4u);
}

TEST_F(HttpClientTest, ClientsOfAFailedServerDoNotComeBackAtOnce) {
    server_.setFault(Fault::status500);
    constexpr int kRequests = 16;
    HttpClient client({.connections = kRequests, .attempts = 2, .firstBackOffMs = 400});
    for (uint64_t ticket = 0; ticket < kRequests; ++ticket) client.begin(ticket, request());
    std::vector<int64_t> times;
    for (const auto& [ticket, ms] : ends(client, kRequests)) times.push_back(ms);
    const auto [first, last] = std::minmax_element(times.begin(), times.end());
    // 16 uniform numbers of 200 ms lie within 50 ms once in 50 million times.
    EXPECT_GT(*last - *first, 50);
}

TEST_F(HttpClientTest, ARetryAfterHoldsAllRequestsBack) {
    server_.setFault(Fault::status503);  // Retry-After: 1
    HttpClient client({.connections = 4, .firstBackOffMs = 1});
    client.begin(1, request());
    while (server_.faults() == 0) EXPECT_TRUE(client.wait(false).empty());
    server_.setFault(Fault::none);
    (void)client.wait(false);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // until the answer has come
    (void)client.wait(false);
    client.begin(2, request());
    for (const auto& [ticket, ms] : ends(client, 2)) EXPECT_GE(ms, 900) << ticket;
    EXPECT_EQ(server_.requests(), 3u);
}

TEST_F(HttpClientTest, ARequestEndsAtItsDeadlineHoweverSteadilyItsBytesCome) {
    server_.setFault(Fault::trickle);
    HttpClient client({.attempts = 4, .deadlineMs = 300});
    const Clock::time_point start = Clock::now();
    const HttpEnd end = client.fetch(request());
    const std::chrono::duration<double> took = Clock::now() - start;
    EXPECT_FALSE(end.answer.ok());
    EXPECT_FALSE(end.reachable) << "later it may be had";
    EXPECT_GE(took.count(), 0.29);
    EXPECT_LT(took.count(), 3);
    server_.setFault(Fault::none);
    EXPECT_TRUE(client.fetch(request()).answer.ok());
}

TEST_F(HttpClientTest, WhatIsCancelledNeverEndsAndMakesRoom) {
    server_.setFault(Fault::stall);
    HttpClient client({.connections = 1});
    for (const uint64_t ticket : {1, 2, 3}) client.begin(ticket, request());
    while (server_.faults() == 0) EXPECT_TRUE(client.wait(false).empty());
    EXPECT_TRUE(client.cancel(2)) << "it waits";
    EXPECT_TRUE(client.cancel(1)) << "it is under way";
    server_.setFault(Fault::none);
    EXPECT_EQ(ends(client, 1).begin()->first, 3u);
    EXPECT_TRUE(client.wait(false).empty());
    EXPECT_FALSE(client.cancel(3)) << "it has ended";
    EXPECT_EQ(client.statistics().cancelled, 2u);
}

}  // namespace
}  // namespace terray::test
