// Limits, time-outs, reload and the end of a server.
#include <thread>

#include <gtest/gtest.h>

#include "tests/server/running_server.h"

namespace terray::server {
namespace {

using std::chrono::milliseconds;

constexpr const char* kHealth = "GET /health HTTP/1.1\r\nHost: x\r\n\r\n";

TEST(Timeouts, EndIdleConnections) {
    RunningServer running({.idleTimeout = milliseconds(300)});
    RawClient silent = running.client();
    RawClient used = running.client();
    EXPECT_EQ(200, used.ask("GET", "/health").status);
    EXPECT_TRUE(silent.isEnded());
    EXPECT_TRUE(used.isEnded());
    EXPECT_EQ(2, running.metric("terray_server_connections_expired_total"));
}

TEST(Timeouts, AnswerAHeadThatTakesTooLongWith408) {
    RunningServer running({.headTimeout = milliseconds(300)});
    RawClient slow = running.client();
    slow.send("GET /health HT");
    const auto answer = slow.answer();
    ASSERT_TRUE(answer);
    EXPECT_EQ(408, answer->status);
    EXPECT_TRUE(slow.isEnded());
}

TEST(Timeouts, AreNotPutOffByBytesThatTrickle) {
    RunningServer running({.headTimeout = milliseconds(400)});
    RawClient slow = running.client();
    int sent = 0;
    while (sent < 40 && running.metric("terray_server_connections_expired_total") == 0) {
        slow.send(sent++ == 0 ? "G" : "E");
        std::this_thread::sleep_for(milliseconds(50));
    }
    EXPECT_LT(sent, 40);
}

TEST(Timeouts, EndAnswersThatNobodyTakes) {
    RunningServer running({.idleTimeout = milliseconds(400)},
                          [](const auto& directory) { growHeights(directory, 1'000'000'000, 0, ""); });
    RawClient lazy = running.client();
    lazy.request("GET", "/small/heights.pmtiles");
    while (running.metric("terray_server_answers_cut_short_total") == 0) std::this_thread::sleep_for(milliseconds(20));
    EXPECT_EQ(1, running.metric("terray_server_connections_expired_total"));
}

TEST(Connections, TakeThePlaceOfTheLongestIdle) {
    RunningServer running({.maxConnections = 4});
    std::vector<RawClient> clients;
    for (int i = 0; i < 4; ++i) {
        clients.push_back(running.client());
        EXPECT_EQ(200, clients.back().ask("GET", "/health").status);
    }
    RawClient fifth = running.client();
    EXPECT_EQ(200, fifth.ask("GET", "/health").status);
    EXPECT_TRUE(clients.front().isEnded());
    EXPECT_EQ(200, clients.back().ask("GET", "/health").status);
}

TEST(Connections, AreRefusedWith503WhenNoneIsIdle) {
    RunningServer running({.maxConnections = 3});
    // A connection is busy once the server has read the beginning of a request; until then a newer one may take its
    // place. So each one that comes in stays, with a request begun, until one is refused.
    std::vector<RawClient> busy;
    int status = 200;
    while (status == 200) {
        RawClient next = running.client();
        next.send(kHealth);
        const auto answer = next.answer();
        status = answer ? answer->status : 0;
        if (status == 503) {
            EXPECT_EQ("1", answer->field("retry-after"));
        }
        next.send("GET /health HT");
        if (status == 200) busy.push_back(std::move(next));
    }
    EXPECT_EQ(503, status);
    int answered = 0;
    for (RawClient& client : busy) {
        client.send("TP/1.1\r\nHost: x\r\n\r\n");
        const auto answer = client.answer();
        if (answer && answer->status == 200) ++answered;
    }
    EXPECT_EQ(answered, 3) << "those that are in stay in";
}

TEST(Reload, ShowsToRequestsThatFollow) {
    RunningServer running;
    RawClient client = running.client();
    const RawAnswer before = client.ask("GET", "/small/heights/1/1/1");
    writeSmallDataset(running.directory(), true, 2);
    EXPECT_EQ(before.body, client.ask("GET", "/small/heights/1/1/1").body) << "not before it is told to";
    running.server().reload(reloadCatalogue({{"small", running.directory()}}, running.catalogue(),
                                            [](const std::string& text) { ADD_FAILURE() << text; }));
    const RawAnswer after =
        client.ask("GET", "/small/heights/1/1/1", "If-None-Match: " + before.field("etag") + "\r\n");
    EXPECT_EQ(200, after.status);
    EXPECT_EQ(smallTile("heights", {1, 1, 1}, 2), after.body);
    EXPECT_NE(before.field("etag"), after.field("etag"));
}

TEST(Stop, FinishesAnswersUnderWayAndEndsIdleConnections) {
    constexpr uint64_t kSize = 50'000'000;  // more than the kernel holds for a client that does not read
    RunningServer running({.threads = 2}, [](const auto& directory) { growHeights(directory, kSize, 0, ""); });
    RawClient idle = running.client();
    EXPECT_EQ(200, idle.ask("GET", "/health").status);
    RawClient busy = running.client();
    busy.request("GET", "/small/heights.pmtiles");
    size_t received = busy.drop(1000);
    running.server().stop(milliseconds(20000));
    EXPECT_TRUE(idle.isEnded());
    EXPECT_FALSE(running.server().hasEnded());
    while (const size_t count = busy.drop(1 << 20)) received += count;
    EXPECT_GT(received, kSize);
    running.server().join();
    EXPECT_TRUE(running.server().hasEnded());
}

TEST(Stop, IsOverWhenItsGraceIs) {
    RunningServer running({}, [](const auto& directory) { growHeights(directory, 1'000'000'000, 0, ""); });
    RawClient lazy = running.client();
    lazy.request("GET", "/small/heights.pmtiles");
    EXPECT_GT(lazy.drop(1000), 0);
    running.server().stop(milliseconds(300));
    running.server().join();
    EXPECT_TRUE(running.server().hasEnded());
}

}  // namespace
}  // namespace terray::server
