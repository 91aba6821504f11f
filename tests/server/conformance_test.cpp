// The server over loopback sockets, byte by byte.
#include <gtest/gtest.h>

#include "tests/server/running_server.h"

namespace terray::server {
namespace {

class Conformance : public testing::Test {
  protected:
    RunningServer running_;
};

TEST_F(Conformance, SendsTilesWithTheirHeaders) {
    const RawAnswer tile = running_.get("/small/heights/2/1/1?v=" + running_.version());
    EXPECT_EQ(200, tile.status);
    EXPECT_EQ(smallTile("heights", {2, 1, 1}), tile.body);
    EXPECT_EQ(std::to_string(tile.body.size()), tile.field("content-length"));
    EXPECT_EQ("application/vnd.terray.heights", tile.field("content-type"));
    EXPECT_EQ("\"" + running_.version() + "\"", tile.field("etag"));
    EXPECT_EQ("public, max-age=31536000, immutable", tile.field("cache-control"));
    EXPECT_EQ("*", tile.field("access-control-allow-origin"));
    EXPECT_EQ("bytes", tile.field("accept-ranges"));
    EXPECT_EQ("nosniff", tile.field("x-content-type-options"));
    EXPECT_TRUE(tile.field("date").ends_with(" GMT"));
    EXPECT_TRUE(tile.field("server").starts_with("terray-server/"));
}

TEST_F(Conformance, KeepsTheConnectionOverEveryKindOfAnswer) {
    RawClient client = running_.client();
    const std::string tag = "If-None-Match: \"" + running_.version() + "\"\r\n";
    EXPECT_EQ(200, client.ask("GET", "/small/heights/0/0/0").status);
    EXPECT_EQ(200, client.ask("HEAD", "/small/heights/0/0/0").status);
    EXPECT_EQ(304, client.ask("GET", "/small/heights/0/0/0", tag).status);
    EXPECT_EQ(204, client.ask("GET", "/small/heights/2/3/3").status);
    EXPECT_EQ(204, client.ask("OPTIONS", "/").status);
    EXPECT_EQ(206, client.ask("GET", "/small/heights.pmtiles", "Range: bytes=1-2\r\n").status);
    EXPECT_EQ(416, client.ask("GET", "/small/heights.pmtiles", "Range: bytes=999999-\r\n").status);
    EXPECT_EQ(404, client.ask("GET", "/nowhere").status);
    EXPECT_EQ(405, client.ask("POST", "/").status);
    EXPECT_EQ(501, client.ask("BREW", "/").status);
    EXPECT_EQ(400, client.ask("GET", "/%zz").status);
    EXPECT_EQ(412, client.ask("GET", "/", "If-Match: \"x\"\r\n").status);
    EXPECT_EQ(200, client.ask("GET", "/health").status);
    EXPECT_EQ(1, running_.metric("terray_server_connections_expired_total") + 1) << "none was closed";
}

TEST_F(Conformance, AnswersPipelinedRequestsInTheirOrder) {
    RawClient client = running_.client();
    std::string requests;
    for (uint32_t i = 0; i < 400; ++i)
        requests += "GET /small/heights/2/" + std::to_string(i % 4) + "/1 HTTP/1.1\r\nHost: x\r\n\r\n";
    client.send(requests);
    for (uint32_t i = 0; i < 400; ++i) {
        const auto answer = client.answer();
        ASSERT_TRUE(answer) << i;
        EXPECT_EQ(smallTile("heights", {2, i % 4, 1}), answer->body) << i;
    }
}

TEST_F(Conformance, TakesRequestsThatComeByteByByte) {
    RawClient client = running_.client();
    for (const char byte : std::string("GET /health HTTP/1.1\r\nHost: x\r\n\r\n")) client.send({&byte, 1});
    EXPECT_EQ(200, client.answer()->status);
}

TEST_F(Conformance, EndsTheConnectionWhenAsked) {
    RawClient modern = running_.client();
    const RawAnswer last = modern.ask("GET", "/health", "Connection: close\r\n");
    EXPECT_EQ("close", last.field("connection"));
    EXPECT_TRUE(modern.isEnded());
    RawClient old = running_.client();
    old.send("GET /health HTTP/1.0\r\n\r\n");
    EXPECT_EQ(200, old.answer()->status);
    EXPECT_TRUE(old.isEnded());
    RawClient kept = running_.client();
    kept.send("GET /health HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
    EXPECT_EQ("keep-alive", kept.answer()->field("connection"));
    EXPECT_EQ(200, kept.ask("GET", "/health").status);
}

TEST_F(Conformance, AnswersBadRequestsAndEndsTheConnection) {
    const std::pair<int, std::string> cases[] = {
        {400, "rubbish\r\n\r\n"},
        {400, "GET / HTTP/1.1\r\n\r\n"},
        {505, "GET / HTTP/3.0\r\nHost: x\r\n\r\n"},
        {414, "GET /" + std::string(100000, 'a')},
        {431, "GET / HTTP/1.1\r\nHost: x\r\n" + std::string(9000, 'a')},
        {413, "GET / HTTP/1.1\r\nHost: x\r\nContent-Length: 70000\r\n\r\n" + std::string(70000, 'a')},
        {413, "GET / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"},
        {405, "POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 4\r\n\r\nabcdGET /health HTTP/1.1\r\nHost: x\r\n\r\n"},
    };
    for (const auto& [status, bytes] : cases) {
        RawClient client = running_.client();
        client.send(bytes);
        const auto answer = client.answer();
        ASSERT_TRUE(answer) << bytes.substr(0, 60);
        EXPECT_EQ(status, answer->status) << bytes.substr(0, 60);
        EXPECT_EQ("close", answer->field("connection"));
        EXPECT_FALSE(client.answer()) << "what follows a body is never taken for a request";
    }
}

TEST(ConformanceOfTiles, IsTheSameWithAndWithoutACache) {
    constexpr uint64_t kBudgets[] = {0, 1, 40000, uint64_t{1} << 20};  // 1: nothing fits, 40000: a few do
    for (const uint64_t budget : kBudgets) {
        RunningServer running({.threads = 2, .cacheBytes = budget});
        RawClient client = running.client();
        for (int round = 0; round < 3; ++round)
            for (uint64_t hilbert = 0; hilbert < hilbertId({kSmallLevel + 1, 0, 0}); ++hilbert) {
                const TileId id = tileFromHilbert(hilbert).value();
                const RawAnswer tile = client.ask("GET", "/small/heights/" + toString(id));
                if (id == kEmptyTile) {
                    EXPECT_EQ(204, tile.status);
                } else {
                    EXPECT_EQ(smallTile("heights", id), tile.body) << id << " with " << budget;
                }
            }
    }
}

TEST(ConformanceOfTiles, SendsThemWholeWhenTheClientHasToBeWaitedFor) {
    // 100 answers of half a megabyte without reading any: the kernel soon holds all it may.
    const std::string large(500'000, 'x');
    RunningServer running({}, [&](const auto& directory) { writeSmallDataset(directory, true, 1, large); });
    RawClient client = running.client();
    for (int i = 0; i < 100; ++i) client.request("GET", "/small/heights/2/" + std::to_string(i % 4) + "/1");
    for (uint32_t i = 0; i < 100; ++i) {
        const auto answer = client.answer();
        ASSERT_TRUE(answer) << i;
        ASSERT_EQ(smallTile("heights", {2, i % 4, 1}) + large, answer->body) << i;
    }
}

TEST(ConformanceOfTiles, AnswersATileThatCannotBeReadWith500) {
    RunningServer running;
    std::filesystem::resize_file(running.directory() / "heights.pmtiles", 4000);  // as a failing disk: it was opened
    RawClient client = running.client();
    EXPECT_EQ(500, client.ask("GET", "/small/heights/2/2/2").status);
    EXPECT_EQ(200, client.ask("GET", "/health").status) << "the connection and the server go on";
}

TEST(ConformanceOfLargeArchives, GivesPartsBeyondFourGigabytes) {
    constexpr uint64_t kSize = 6'000'000'000, kPlace = 5'500'000'000;
    const std::string text = "far out";
    RunningServer running({}, [&](const auto& directory) { growHeights(directory, kSize, kPlace, text); });
    RawClient client = running.client();
    const RawAnswer head = client.ask("HEAD", "/small/heights.pmtiles");
    EXPECT_EQ("6000000000", head.field("content-length"));
    const RawAnswer part = client.ask("GET", "/small/heights.pmtiles", "Range: bytes=5500000000-5500000006\r\n");
    EXPECT_EQ(206, part.status);
    EXPECT_EQ(text, part.body);
    EXPECT_EQ("bytes 5500000000-5500000006/6000000000", part.field("content-range"));
    const RawAnswer last = client.ask("GET", "/small/heights.pmtiles", "Range: bytes=-1\r\n");
    EXPECT_EQ("bytes 5999999999-5999999999/6000000000", last.field("content-range"));
    const RawAnswer large = client.ask("GET", "/small/heights.pmtiles", "Range: bytes=5495000000-5504999999\r\n");
    EXPECT_EQ(10'000'000, large.body.size()) << "in several turns of a megabyte";
    EXPECT_EQ(text, large.body.substr(5'000'000, text.size()));
}

TEST(ConformanceOfAddresses, ListensAtIpv6) {
    RunningServer running({.listen = "[::1]:0"});
    EXPECT_TRUE(running.server().addresses().front().starts_with("[::1]:"));
    RawClient client(running.port(), "::1");
    EXPECT_EQ(200, client.ask("GET", "/health").status);
}

}  // namespace
}  // namespace terray::server
