#include "client/stream/web_dataset.h"

#include <chrono>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "client/stream/open_dataset.h"
#include "client/stream/pager.h"
#include "client/stream/web_address.h"
#include "common/error.h"
#include "tests/common/temporary_directory.h"
#include "tests/stream/written_dataset.h"
#include "tests/support/fault_server.h"

namespace terray::test {
namespace {

/// Levels 0..1 of heights (5 tiles), 0..3 of imagery (85 tiles).
const FakeDataset& dataset() {
    static const FakeDataset made =
        buildDataset([](int64_t x, int64_t y) { return 100 + 0.1 * static_cast<double>(x % 64 + y % 48); },
                     {.samples = {1024, 1024}, .imageryLevel = 3});
    return made;
}

std::vector<TileRequest> allTiles() {
    std::vector<TileRequest> all;
    for (const auto& [id, tile] : dataset().heights) all.push_back({TileLayer::heights, id, 1});
    for (const auto& [id, tile] : dataset().imagery) all.push_back({TileLayer::imagery, id, 1});
    return all;
}

/// Quick to give up, quick to come back.
const WebOptions kHasty{.http = {.connections = 4,
                                 .attempts = 4,
                                 .stallSeconds = 1,
                                 .deadlineMs = 5000,
                                 .firstBackOffMs = 5,
                                 .longestBackOffMs = 20}};

class WebDataset : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        setenv("no_proxy", "*", 1);
        folder_ = std::make_unique<TemporaryDirectory>();
        for (const size_t entries : {4096, 8}) {
            const auto directory = *folder_ / ("of" + std::to_string(entries));
            std::filesystem::create_directory(directory);
            writeDataset(dataset(), directory, entries);
        }
    }
    static void TearDownTestSuite() { folder_.reset(); }

    std::string address(const std::string& path = "/of4096") const { return server_.address() + path; }
    /// What opening ends with.
    static Error refusal(const std::string& place) {
        try {
            (void)openWebDataset(place, kHasty);
        } catch (const Error& error) {
            return error;
        }
        return {ExitCode::ok, ""};
    }
    static void expectWhole(const LoadedTile& tile) {
        if (tile.layer == TileLayer::heights)
            EXPECT_TRUE(*tile.heights == dataset().heights.at(tile.id)) << tile.id;
        else
            EXPECT_TRUE(*tile.imagery == dataset().imagery.at(tile.id)) << tile.id;
    }
    /// Wants all tiles until all have come, for so many frames at most. @return how many came
    static size_t load(Pager& pager, int frames) {
        std::set<std::pair<TileLayer, TileId>> loaded;
        for (int frame = 0; frame < frames && loaded.size() < allTiles().size(); ++frame) {
            std::vector<TileRequest> missing;
            for (const TileRequest& request : allTiles())
                if (!loaded.contains({request.layer, request.id})) missing.push_back(request);
            pager.want(missing);
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            for (const LoadedTile& tile : pager.takeLoaded(1000)) {
                expectWhole(tile);
                EXPECT_TRUE(loaded.insert({tile.layer, tile.id}).second) << "delivered twice";
            }
        }
        return loaded.size();
    }
    static void loadAll(Pager& pager) {
        EXPECT_EQ(load(pager, 5000), allTiles().size());
        EXPECT_TRUE(pager.takeFailed().empty());
    }
    static void expectBalanced(const PagerStatistics& count) {
        EXPECT_EQ(count.requested + count.hostHits, count.delivered + count.failed + count.cancelled);
    }

    static std::unique_ptr<TemporaryDirectory> folder_;
    FaultServer server_{folder_->path()};
};

std::unique_ptr<TemporaryDirectory> WebDataset::folder_;

TEST_F(WebDataset, GivesTheSameTilesAsTheDirectory) {
    for (const char* path : {"/of4096", "/of4096/", "/of4096/heights.pmtiles", "/of8/heights.pmtiles?key=1#top"}) {
        const auto local = openLocalDataset(*folder_ / std::string(path).substr(1, path[3] == '8' ? 3 : 6));
        const auto web = openWebDataset(address(path), kHasty);
        EXPECT_EQ(web->metadata(), local->metadata());
        EXPECT_EQ(web->contentHash(), local->contentHash());
        for (const TileRequest& tile : allTiles())
            EXPECT_EQ(*web->read(tile.layer, tile.id), *local->read(tile.layer, tile.id)) << tile.id;
        EXPECT_FALSE(web->read(TileLayer::heights, {3, 0, 0}).ok());
    }
}

TEST_F(WebDataset, PagesSideBySideOverFewConnections) {
    server_.setDelayMs(2);
    const auto web = openWebDataset(address("/of8"), kHasty);
    const uint64_t before = server_.connections();
    Pager pager(*web, {.decodeThreads = 2});
    loadAll(pager);
    expectBalanced(pager.statistics());
    EXPECT_GT(server_.mostAtATime(), 1);
    EXPECT_LE(server_.mostAtATime(), 4);
    EXPECT_LE(server_.connections() - before, 4u) << "connections are used again";
    EXPECT_GT(pager.statistics().reads.receivedBytes, pager.statistics().bytesRead) << "leaf directories came, too";
}

TEST_F(WebDataset, OpensWithFewRequests) {
    (void)openWebDataset(address(), kHasty);
    EXPECT_LE(server_.requests(), 4u) << "head and root tile of each archive";
}

TEST_F(WebDataset, TakesBackReadsThatAreNoLongerWanted) {
    const auto web = openWebDataset(address(), kHasty);
    server_.setFault(Fault::stall);
    Pager pager(*web, {});
    pager.want(allTiles());
    while (server_.faults() < 4) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    pager.want({});
    pager.waitUntilSettled();  // would take a second and more by the stalls alone
    expectBalanced(pager.statistics());
    EXPECT_EQ(pager.statistics().cancelled, pager.statistics().requested);
    server_.setFault(Fault::none);
    loadAll(pager);
}

TEST_F(WebDataset, GivesUpReadsAheadForWhatIsWanted) {
    const auto web = openWebDataset(address(), kHasty);
    Pager pager(*web, {});
    const uint64_t before = server_.requests();
    server_.setDelayMs(300);
    pager.want({}, {{TileLayer::imagery, {3, 5, 2}, 1}, {TileLayer::heights, {1, 1, 1}, 1}});
    while (server_.requests() < before + 4) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    server_.setDelayMs(0);
    pager.want({{TileLayer::heights, {1, 0, 1}, 1}});
    pager.waitUntilSettled();
    EXPECT_EQ(pager.takeLoaded(10).size(), 1u);
    EXPECT_EQ(pager.statistics().prefetch.cancelled, 2u);
    EXPECT_EQ(pager.statistics().prefetch.tiles, 0u);
    expectBalanced(pager.statistics());
    loadAll(pager);
}

TEST_F(WebDataset, FetchesNothingTwiceThatTheDiskCacheHolds) {
    const TemporaryDirectory cache;
    WebOptions options = kHasty;
    options.diskCache.directory = cache.path();
    for (const bool first : {true, false}) {
        const auto web = openWebDataset(address("/of8"), options);
        const uint64_t before = server_.requests();
        Pager pager(*web, {.decodeThreads = 2});
        loadAll(pager);
        EXPECT_EQ(pager.statistics().reads.receivedBytes > 0, first);
        EXPECT_EQ(server_.requests() > before, first);
    }
    // A tile that came damaged and was kept so is fetched past the cache.
    options.diskCache.directory = cache / "other";
    const auto web = openWebDataset(address("/of8"), options);
    Pager pager(*web, {.decodeThreads = 2, .healMs = 0});
    server_.setFault(Fault::corrupt, 0.5);
    (void)load(pager, 50);
    server_.setFault(Fault::none);
    pager.want({});
    pager.waitUntilSettled();
    (void)pager.takeLoaded(1000);
    (void)pager.takeFailed();
    loadAll(pager);
}

TEST_F(WebDataset, SaysWhyItCannotBeOpened) {
    EXPECT_EQ(refusal(address("/nowhere")).code(), ExitCode::dataset);
    EXPECT_NE(std::string(refusal(address("/nowhere")).what()).find("404"), std::string::npos);
    EXPECT_EQ(refusal("http://name:word@host/a").code(), ExitCode::usage);
    EXPECT_EQ(refusal("http:///a").code(), ExitCode::usage);
    server_.setFault(Fault::noRanges);
    EXPECT_EQ(refusal(address()).code(), ExitCode::dataset);
    EXPECT_NE(std::string(refusal(address()).what()).find("range requests"), std::string::npos);
    for (const Fault fault : {Fault::status500, Fault::refuse, Fault::truncate, Fault::wrongLength}) {
        server_.setFault(fault);
        EXPECT_EQ(refusal(address()).code(), ExitCode::network) << static_cast<int>(fault);
    }
    server_.kill();
    EXPECT_EQ(refusal(address()).code(), ExitCode::network);
    EXPECT_NE(std::string(refusal(address()).what()).find(address()), std::string::npos);
}

TEST_F(WebDataset, RefusesAnArchiveThatWasReplaced) {
    const TemporaryDirectory own;  // with noise, or all of it would come with the first request
    Random random(1);
    writeDataset(buildDataset([&](int64_t, int64_t) { return random.uniform(0, 100); }, {.samples = {1024, 1024}}),
                 own.path());
    const FaultServer server(own.path());
    const auto web = openWebDataset(server.address() + "/" + kHeightsFile, kHasty);
    ASSERT_TRUE(web->read(TileLayer::heights, {1, 1, 0}).ok());
    std::filesystem::resize_file(own / kHeightsFile, std::filesystem::file_size(own / kHeightsFile) + 1);
    const auto read = web->read(TileLayer::heights, {1, 1, 0});
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.failure().message.find("replaced"), std::string::npos) << read.failure().message;
}

/// Every fault, at first always and then now and then: what is asked for meanwhile comes or fails, and once the fault
/// has ended everything comes.
class WebFaults : public WebDataset, public testing::WithParamInterface<Fault> {};

TEST_P(WebFaults, EndWithEveryTileLoadedAndEveryRequestSettledOnce) {
    const auto web = openWebDataset(address("/of8"), kHasty);
    Pager pager(*web, {.decodeThreads = 2, .healMs = 20});
    server_.setFault(GetParam());
    pager.want({{TileLayer::heights, {1, 0, 1}, 1}, {TileLayer::imagery, {3, 5, 2}, 1}});
    pager.waitUntilSettled();
    EXPECT_TRUE(pager.takeLoaded(10).empty());
    const std::vector<FailedTile> failed = pager.takeFailed();
    EXPECT_EQ(failed.size(), 2u);
    for (const FailedTile& tile : failed) {
        EXPECT_NE(tile.loss, Loss::forGood) << tile.message;
        EXPECT_NE(tile.message.find(toString(tile.id)), std::string::npos) << tile.message;
    }
    for (uint64_t seed = 1; seed <= 3; ++seed) {
        server_.setFault(GetParam(), 0.2, seed);
        (void)load(pager, 50);
        pager.want({});
        pager.waitUntilSettled();
        expectBalanced(pager.statistics());
    }
    server_.setFault(Fault::none);
    (void)pager.takeLoaded(1000);
    (void)pager.takeFailed();
    loadAll(pager);
    expectBalanced(pager.statistics());
}

INSTANTIATE_TEST_SUITE_P(Each, WebFaults,
                         testing::Values(Fault::refuse, Fault::reset, Fault::truncate, Fault::corrupt, Fault::stall,
                                         Fault::status500, Fault::status503, Fault::wrongLength, Fault::wrongRange,
                                         Fault::noRanges));

TEST_F(WebDataset, GoesOnWhenAKilledServerComesBack) {
    const auto web = openWebDataset(address(), kHasty);
    Pager pager(*web, {.decodeThreads = 2});
    server_.setDelayMs(2);
    pager.want(allTiles());
    while (pager.statistics().delivered < 5) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    server_.kill();
    pager.waitUntilSettled();
    expectBalanced(pager.statistics());
    const std::vector<FailedTile> failed = pager.takeFailed();
    ASSERT_FALSE(failed.empty());
    for (const FailedTile& tile : failed) EXPECT_EQ(tile.loss, Loss::unreachable) << tile.message;
    (void)pager.takeLoaded(1000);
    server_.restart();
    loadAll(pager);
    expectBalanced(pager.statistics());
}

TEST(OpenDataset, TakesADirectoryWithoutAServer) {
    const TemporaryDirectory folder;
    writeDataset(dataset(), folder.path());
    EXPECT_EQ(openDataset(folder.path().string())->metadata(), dataset().metadata);
}

}  // namespace
}  // namespace terray::test
