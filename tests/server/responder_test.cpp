// Answers without sockets: what is where, conditions, ranges, caching.
#include "server/responder.h"

#include <gtest/gtest.h>

#include "common/json.h"
#include "tests/common/temporary_directory.h"
#include "tests/server/small_dataset.h"

namespace terray::server {
namespace {

class Responder : public testing::Test {
  protected:
    Responder() {
        writeSmallDataset(directory_ / "small");
        writeSmallDataset(directory_ / "bare", false);
        catalogue_ = openCatalogue({{"small", directory_ / "small"}, {"bare", directory_ / "bare"}});
    }
    [[nodiscard]] Response ask(const std::string& target, Request request = {}) const {
        if (request.method.empty()) request.method = "GET";
        request.target = target;
        return respond(request, *catalogue_, metrics_);
    }
    [[nodiscard]] std::string version() const { return catalogue_->find("small")->version; }
    [[nodiscard]] std::string tag() const { return "\"" + version() + "\""; }

    /// What a client would get as the body.
    static std::string bodyOf(const Response& response) {
        if (const auto* text = std::get_if<std::string>(&response.body)) return *text;
        const auto* slice = std::get_if<ArchiveSlice>(&response.body);
        if (slice == nullptr) return {};
        const auto bytes = slice->archive->reader().source().read(slice->range.offset, slice->range.length).value();
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    static bool has(const Response& response, const std::string& field) {
        return ("\r\n" + response.fields).find("\r\n" + field + "\r\n") != std::string::npos;
    }

    test::TemporaryDirectory directory_;
    std::shared_ptr<const Catalogue> catalogue_;
    Metrics metrics_;
};

TEST_F(Responder, GivesEachStoredTileItsOwnBytes) {
    for (const TileId id : {TileId{0, 0, 0}, TileId{1, 1, 0}, TileId{2, 2, 3}}) {
        const Response tile = ask("/small/heights/" + toString(id));
        EXPECT_EQ(200, tile.status);
        EXPECT_EQ(smallTile("heights", id), bodyOf(tile));
        EXPECT_TRUE(has(tile, "Content-Type: application/vnd.terray.heights"));
    }
    const Response photo = ask("/small/imagery/3/7/0");
    EXPECT_EQ(smallTile("imagery", {3, 7, 0}), bodyOf(photo));
    EXPECT_TRUE(has(photo, "Content-Type: application/vnd.terray.imagery"));
}

TEST_F(Responder, TellsEmptyTilesFromThoseBeyondThePyramid) {
    EXPECT_EQ(204, ask("/small/heights/" + toString(kEmptyTile)).status);
    EXPECT_EQ(204, ask("/small/imagery/3/7/7").status);
    for (const char* address : {"3/0/0", "2/4/0", "2/0/4", "1/2/0", "32/0/0", "99999999999/0/0", "-1/0/0", "02/0/0",
                                "2/+1/0", "2/1/0x1", "a/b/c", "2/1", "2/1/1/1", "2//1", "2/1/1.bin", ""})
        EXPECT_EQ(404, ask(std::string("/small/heights/") + address).status) << address;
}

TEST_F(Responder, HasNothingElseToOffer) {
    for (const char* target : {"/none/metadata.json", "/small", "/small/", "/small/metadata", "/small/heights",
                               "/bare/imagery/0/0/0", "/bare/imagery.pmtiles", "/small/heights.pmtiles/", "/healthy",
                               "//", "/small/heights.pmtiles.tmp", "/Small/metadata.json"})
        EXPECT_EQ(404, ask(target).status) << target;
}

TEST_F(Responder, NeverLeavesTheDatasets) {
    for (const char* target :
         {"/../../../../etc/passwd", "/small/../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd",
          "/small/%2e%2e%2fsmall%2fheights.pmtiles", "/small/heights/../heights.pmtiles", "/..%2f..%2fetc%2fpasswd",
          "/small/heights.pmtiles%00", "/.", "/..", "/~root", "/small\\..\\..", "/@list", "/small//heights.pmtiles"})
        EXPECT_EQ(404, ask(target).status) << target;
}

TEST_F(Responder, DescribesTheDatasets) {
    const auto catalogue = Json::parse(bodyOf(ask("/"))).value();
    ASSERT_EQ(2, catalogue.find("datasets")->array().size());
    const Json& small = catalogue.find("datasets")->array()[1];
    EXPECT_EQ("small", small.stringAt("name").value());
    EXPECT_EQ(3, small.numberAt("heightLevels").value());
    EXPECT_EQ(4, small.numberAt("imageryLevels").value());
    const std::string link = small.find("links")->stringAt("metadata").value();
    const Response metadata = ask("/" + link);
    EXPECT_EQ(200, metadata.status);
    const auto json = Json::parse(bodyOf(metadata)).value();
    EXPECT_EQ(version(), json.stringAt("datasetVersion").value());
    EXPECT_EQ("3.0.0", json.stringAt("tilejson").value());
    EXPECT_EQ(kSmallLevel, json.numberAt("maxzoom").value());
    EXPECT_EQ(9.05, json.find("center")->array()[0].number());
    EXPECT_EQ(catalogue_->find("small")->metadata, metadataFromJson(json).value()) << "as the archive's own metadata";
    EXPECT_EQ(nullptr, Json::parse(bodyOf(ask("/bare/metadata.json")))->find("layers")->find("imagery"));
}

TEST_F(Responder, IsImmutableOnlyUnderItsOwnVersion) {
    const std::string immutable = "Cache-Control: public, max-age=31536000, immutable";
    const std::string revalidate = "Cache-Control: public, max-age=0, must-revalidate";
    for (const std::string target :
         {"/small/metadata.json", "/small/heights/0/0/0", "/small/imagery.pmtiles", "/small/heights/2/3/3"}) {
        EXPECT_TRUE(has(ask(target + "?v=" + version()), immutable)) << target;
        EXPECT_TRUE(has(ask(target + "?x=1&v=" + version()), immutable)) << target;
        EXPECT_TRUE(has(ask(target), revalidate)) << target;
        EXPECT_TRUE(has(ask(target + "?v=0123456789abcdef"), revalidate)) << target;
    }
    EXPECT_TRUE(has(ask("/?v=" + version()), revalidate));
    for (const char* target : {"/health", "/metrics", "/none/x"})
        EXPECT_TRUE(has(ask(target), "Cache-Control: no-store")) << target;
}

TEST_F(Responder, AnswersConditions) {
    const std::string target = "/small/heights/1/0/0";
    const Response same = ask(target, {.ifNoneMatch = tag()});
    EXPECT_EQ(304, same.status);
    EXPECT_TRUE(has(same, "ETag: " + tag()));
    EXPECT_EQ(0, same.bytesToSend());
    EXPECT_EQ(304, ask(target, {.ifNoneMatch = "\"x\", W/" + tag()}).status);
    EXPECT_EQ(200, ask(target, {.ifNoneMatch = "\"x\""}).status);
    EXPECT_EQ(200, ask(target, {.ifMatch = tag()}).status);
    EXPECT_EQ(412, ask(target, {.ifMatch = "\"x\""}).status);
    EXPECT_EQ(404, ask("/small/heights/9/0/0", {.ifNoneMatch = "*"}).status) << "what is not there has no version";
    EXPECT_EQ(304, ask("/", {.ifNoneMatch = "*"}).status);
}

TEST_F(Responder, GivesPartsOfArchivesAndTiles) {
    const std::string whole = readText(directory_ / "small" / "heights.pmtiles");
    const std::string size = std::to_string(whole.size());
    const Response part = ask("/small/heights.pmtiles", {.range = "bytes=5-10"});
    EXPECT_EQ(206, part.status);
    EXPECT_EQ(whole.substr(5, 6), bodyOf(part));
    EXPECT_TRUE(has(part, "Content-Range: bytes 5-10/" + size));
    EXPECT_EQ(whole, bodyOf(ask("/small/heights.pmtiles")));
    EXPECT_EQ(whole.substr(whole.size() - 3), bodyOf(ask("/small/heights.pmtiles", {.range = "bytes=-3"})));

    const Response beyond = ask("/small/heights.pmtiles", {.range = "bytes=" + size + "-"});
    EXPECT_EQ(416, beyond.status);
    EXPECT_TRUE(has(beyond, "Content-Range: bytes */" + size));
    EXPECT_EQ(smallTile("heights", {0, 0, 0}).substr(4, 3),
              bodyOf(ask("/small/heights/0/0/0", {.range = "bytes=4-6"})));
    EXPECT_EQ(200, ask("/", {.range = "bytes=0-1"}).status);
    EXPECT_EQ(200, ask("/small/heights.pmtiles", {.method = "HEAD", .range = "bytes=0-1"}).status);
}

TEST_F(Responder, GivesThePartOnlyOfTheVersionThatIfRangeNames) {
    const auto status = [&](const std::string& ifRange) {
        return ask("/small/heights.pmtiles", {.ifRange = ifRange, .range = "bytes=0-1"}).status;
    };
    EXPECT_EQ(206, status(tag()));
    EXPECT_EQ(200, status("\"x\""));
    EXPECT_EQ(200, status("W/" + tag()));
    EXPECT_EQ(200, status("Sun, 06 Nov 1994 08:49:37 GMT"));
}

TEST_F(Responder, KnowsItsMethods) {
    const Response head = ask("/small/heights/0/0/0", {.method = "HEAD"});
    EXPECT_EQ(0, head.bytesToSend());
    EXPECT_EQ(smallTile("heights", {0, 0, 0}).size(), lengthOf(head.body));
    const Response options = ask("/small/heights/0/0/0", {.method = "OPTIONS"});
    EXPECT_EQ(204, options.status);
    EXPECT_TRUE(has(options, "Access-Control-Allow-Methods: GET, HEAD, OPTIONS"));
    EXPECT_EQ(204, ask("*", {.method = "OPTIONS"}).status);
    EXPECT_EQ(400, ask("*").status);
    for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "TRACE", "CONNECT"}) {
        EXPECT_EQ(405, ask("/", {.method = method}).status) << method;
        EXPECT_TRUE(has(ask("/", {.method = method}), "Allow: GET, HEAD, OPTIONS")) << method;
    }
    EXPECT_EQ(501, ask("/", {.method = "BREW"}).status);
    EXPECT_EQ(501, ask("/", {.method = "get"}).status) << "methods are told apart by case";
}

TEST_F(Responder, TakesNoBodies) {
    const Response response = ask("/small/heights/0/0/0", {.hasBody = true});
    EXPECT_EQ(413, response.status);
    EXPECT_TRUE(response.closes);
    EXPECT_TRUE(ask("/", {.method = "POST", .hasBody = true}).closes);
}

TEST_F(Responder, LetsScriptsOfOtherSitesRead) {
    for (const char* target : {"/", "/small/heights/0/0/0", "/small/heights/9/9/9", "/small/heights/2/3/3"})
        EXPECT_TRUE(has(ask(target), "Access-Control-Allow-Origin: *")) << target;
}

TEST_F(Responder, CountsInPrometheusFormat) {
    metrics_.count(206, 1000, std::chrono::microseconds(700), true);
    metrics_.count(404, 10, std::chrono::microseconds(20000000), false);
    const std::string text = bodyOf(ask("/metrics"));
    for (const char* line :
         {"terray_server_answers_total{status=\"2xx\"} 1", "terray_server_answers_total{status=\"4xx\"} 1",
          "terray_server_sent_bytes_total 1010", "terray_server_answers_cut_short_total 1",
          "terray_server_answer_seconds_bucket{le=\"0.001\"} 1", "terray_server_answer_seconds_bucket{le=\"+Inf\"} 2",
          "terray_server_datasets 2"})
        EXPECT_NE(std::string::npos, text.find("\n" + std::string(line) + "\n")) << line;
    EXPECT_TRUE(has(ask("/metrics"), "Content-Type: text/plain; version=0.0.4; charset=utf-8"));
}

TEST(WriteHead, TellsLengthConnectionAndDate) {
    Response response = refusal(404, "gone");
    const std::string date = imfDate(784111777);
    EXPECT_EQ("Sun, 06 Nov 1994 08:49:37 GMT", date);
    const std::string head = writeHead(response, {.version = 10, .keepAlive = true, .date = date});
    EXPECT_TRUE(head.starts_with("HTTP/1.1 404 Not Found\r\nDate: " + date + "\r\n"));
    EXPECT_NE(std::string::npos, head.find("\r\nContent-Length: 5\r\nConnection: keep-alive\r\n\r\n"));
    response.status = 304;
    EXPECT_EQ(std::string::npos, writeHead(response, {.date = date}).find("Content-Length"));
    EXPECT_NE(std::string::npos, writeHead(response, {.keepAlive = false, .date = date}).find("Connection: close\r\n"));
}

}  // namespace
}  // namespace terray::server
