// A build that is killed, stopped or out of space is gone on with, and ends in the same bytes.

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/error.h"
#include "tests/preprocess/disk_calls.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

/// Heights of 3 x 2 tiles over three levels, in three blocks, and where photos can be compressed one on top.
class Resume : public testing::Test {
  protected:
    Resume() : heights_(makeHills({1100, 600}, 5, 3)) {
        if (!TERRAY_WITH_STB) return;
        Grid<Rgba> texels({300, 200}, Rgba{60, 90, 30, 255});
        for (int64_t y = 0; y < 200; ++y)
            for (int64_t x = 0; x < 300; ++x) texels.at(x, y)[0] = static_cast<uint8_t>(x * y);
        photo_ = gridPhoto(std::move(texels), 0);
    }

    [[nodiscard]] BuildRequest request(bool resume, int jobs = 1) const {
        return {.out = directory_ / "out",
                .resume = resume,
                .jobs = jobs,
                .optionsText = "test",
                .blockDepth = 1,
                .stop = &stop_};
    }
    void build(const BuildRequest& request) const { (void)buildDataset(heights_, photo_, request); }

    /// Builds in a process of its own that is killed at its `fatal`-th disk call. @return whether it lived to its end
    [[nodiscard]] bool survives(int fatal, const BuildRequest& request) const {
        const pid_t child = ::fork();
        if (child == 0) {
            std::atomic<int> calls = 0;
            const DiskWatch watch([&](const DiskCall&) { return ++calls == fatal; });
            const Error error = refusal([&] { build(request); });
            std::fputs(error.code() == ExitCode::ok ? "" : error.what(), stderr);
            std::_Exit(static_cast<int>(error.code()));
        }
        int status = 0;
        EXPECT_EQ(::waitpid(child, &status, 0), child);
        EXPECT_TRUE(!WIFEXITED(status) || WEXITSTATUS(status) == 0);
        return WIFEXITED(status);
    }
    /// Disk calls of a whole build; its dataset becomes the one that others are compared with.
    int buildWhole() {
        std::atomic<int> calls = 0;
        {
            const DiskWatch watch([&](const DiskCall&) { return ++calls, false; });
            build(request(false));
        }
        for (const char* name : {kHeightsFile, kImageryFile})
            if (std::filesystem::exists(directory_ / "out" / name)) whole_[name] = readFile(directory_ / "out" / name);
        std::filesystem::remove_all(directory_ / "out");
        return calls;
    }
    /// Goes on with the build; OUT must then be the whole dataset alone.
    void expectResumed(const BuildRequest& request) {
        build(request);
        EXPECT_EQ(directory_.names(), std::vector<std::string>{"out"});
        expectWhole();
        std::filesystem::remove_all(directory_ / "out");
        std::filesystem::remove_all(directory_ / "out.partial");
    }
    void expectWhole() const {
        for (const auto& [name, bytes] : whole_) EXPECT_EQ(readFile(directory_ / "out" / name), bytes) << name;
        EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory_ / "out"), {}),
                  static_cast<ptrdiff_t>(whole_.size()));
    }
    [[nodiscard]] static Error refusal(const std::function<void()>& work) {
        try {
            work();
        } catch (const Error& error) {
            return error;
        }
        return {ExitCode::ok, "it went well"};
    }
    /// Stops a build after its first block, so that there is something to resume.
    void begin(const BuildRequest& request) {
        int reads = 0;
        heights_.onRead_ = [&] {
            if (++reads == 2) throw Error(ExitCode::input, "the network is down");
        };
        const Error error = refusal([&] { build(request); });
        EXPECT_EQ(error.code(), ExitCode::input);
        EXPECT_NE(std::string(error.what()).find("--resume"), std::string::npos) << error.what();
        heights_.onRead_ = {};
    }

    TemporaryDirectory directory_;
    GridHeights heights_;
    OpenPhoto photo_;
    std::atomic<bool> stop_ = false;
    std::map<std::string, Bytes> whole_;
};

TEST_F(Resume, ABuildKilledAtAnyCallToTheDiskEndsInTheSameBytes) {
    const int calls = buildWhole();
    constexpr int kLastCalls = 14;  // writing the archives, giving OUT its name, clearing up
    ASSERT_GT(calls, 40);
    std::set<int> moments;
    std::mt19937 random(3);
    while (moments.size() < 22) moments.insert(static_cast<int>(random() % static_cast<uint32_t>(calls)) + 1);
    for (int call = calls - kLastCalls; call <= calls; ++call) moments.insert(call);
    for (const int fatal : moments) {
        SCOPED_TRACE("killed at call " + std::to_string(fatal) + " of " + std::to_string(calls));
        EXPECT_FALSE(survives(fatal, request(false)));
        expectResumed(request(true));
    }
    EXPECT_TRUE(survives(calls + 1, request(false)));
    expectWhole();
}

TEST_F(Resume, ABuildKilledAgainAndAgainEndsInTheSameBytesForAnyJobs) {
    const int calls = buildWhole();
    std::mt19937 random(20);
    for (int round = 0; round < 3; ++round) {
        int kills = 0;
        for (int jobs = 1;
             !survives(static_cast<int>(random() % static_cast<uint32_t>(calls / 2)) + 1, request(true, jobs));
             jobs = 3 - jobs)
            ASSERT_LT(++kills, 200);
        expectWhole();
        std::filesystem::remove_all(directory_ / "out");
        std::filesystem::remove_all(directory_ / "out.partial");
    }
}

TEST_F(Resume, ABlockIsJournalledOnlyWhenItsBytesAreOnTheDisk) {
    std::set<int> unsynced;
    int entries = 0;
    const DiskWatch watch([&](const DiskCall& call) {
        const std::string link = "/proc/self/fd/" + std::to_string(call.descriptor);
        const bool isJournal =
            call.descriptor >= 0 && std::filesystem::read_symlink(link).filename().string() == "journal";
        const std::string name = call.name;
        if (isJournal && name == "pwrite") {
            EXPECT_TRUE(unsynced.empty());
            ++entries;
        }
        if (!isJournal && name == "pwrite") unsynced.insert(call.descriptor);
        if (name == "fdatasync") unsynced.erase(call.descriptor);
        return false;
    });
    build(request(false));
    EXPECT_GE(entries, 4);  // the heading and three blocks
}

TEST_F(Resume, AStopKeepsWhatIsDone) {
    (void)buildWhole();
    int reads = 0;
    heights_.onRead_ = [&] {
        if (++reads == 2) stop_ = true;
    };
    const Error error = refusal([&] { build(request(false)); });
    EXPECT_EQ(error.code(), ExitCode::interrupted);
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"out.partial"});
    stop_ = false;
    reads = 1000;
    expectResumed(request(true));
    EXPECT_EQ(reads, 1001);  // only the second block of two was read again
}

TEST_F(Resume, AnotherBuildIsRefusedAndNamed) {
    begin(request(false));
    BuildRequest other = request(true);
    other.optionsText = "build --crs EPSG:2056";
    const Error options = refusal([&] { build(other); });
    EXPECT_EQ(options.code(), ExitCode::usage);
    EXPECT_NE(std::string(options.what()).find("options was \"test\", and is \"build --crs EPSG:2056\""),
              std::string::npos)
        << options.what();
    heights_.info_.files = {{"alps.tif", 100, 5}};
    const Error files = refusal([&] { build(request(true)); });
    EXPECT_NE(std::string(files.what()).find("\"alps.tif\" is a new input"), std::string::npos) << files.what();
    // Nothing was lost by asking.
    heights_.info_.files = {};
    build(request(true));
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"out"});
}

TEST_F(Resume, AChangedFileIsNamedWithItsSizeAndTime) {
    heights_.info_.files = {{"alps.tif", 100, 5}, {"jura.tif", 7, 6}};
    begin(request(false));
    heights_.info_.files = {{"alps.tif", 101, 8}, {"jura.tif", 7, 6}};
    const std::string changed = refusal([&] { build(request(true)); }).what();
    EXPECT_NE(changed.find("\"alps.tif\" has changed: it had 100 bytes, modified at Unix time 5, and has 101 bytes, "
                           "modified at Unix time 8"),
              std::string::npos)
        << changed;
    EXPECT_EQ(changed.find("jura"), std::string::npos) << changed;
    heights_.info_.files = {{"jura.tif", 7, 6}, {"alps.tif", 100, 5}};
    const std::string order = refusal([&] { build(request(true)); }).what();
    EXPECT_NE(order.find("another order"), std::string::npos) << order;
    heights_.info_.files = {{"alps.tif", 100, 5}};
    const std::string missing = refusal([&] { build(request(true)); }).what();
    EXPECT_NE(missing.find("\"jura.tif\" is no longer among the inputs"), std::string::npos) << missing;
}

TEST_F(Resume, WithNothingToResumeItBuilds) {
    (void)buildWhole();
    build(request(true));
    expectWhole();
}

TEST_F(Resume, AWholeDatasetIsLeftAloneAndAnotherOneRefused) {
    (void)buildWhole();
    build(request(false));
    int reads = 0;
    heights_.onRead_ = [&] { ++reads; };
    build(request(true));
    EXPECT_EQ(reads, 0);
    BuildRequest other = request(true);
    other.optionsText = "other";
    const Error refused = refusal([&] { build(other); });
    EXPECT_EQ(refused.code(), ExitCode::usage);
    EXPECT_NE(std::string(refused.what()).find("options was \"test\""), std::string::npos) << refused.what();
    expectWhole();
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"out"});
}

TEST_F(Resume, WithoutItAnUnfinishedBuildIsStartedAnew) {
    (void)buildWhole();
    begin(request(false));
    int reads = 0;
    heights_.onRead_ = [&] { ++reads; };
    build(request(false));
    EXPECT_EQ(reads, 2);
    expectWhole();
}

TEST_F(Resume, AForcedBuildKilledAnywhereLeavesTheOldOrTheNewDataset) {
    (void)buildWhole();
    BuildRequest forced = request(true);
    forced.replace = true;
    std::mt19937 random(7);
    for (int round = 0; round < 8; ++round) {
        heights_.heights_.at(3, 3) = static_cast<float>(round);
        build(request(false));
        const Bytes old = readFile(directory_ / "out" / kHeightsFile);
        heights_.heights_ = makeHills({1100, 600}, 5, 3);
        int kills = 0;
        while (!survives(static_cast<int>(random() % 40) + 1, forced)) {
            ASSERT_LT(++kills, 200);
            const bool stands = std::filesystem::exists(directory_ / "out" / kHeightsFile);
            EXPECT_TRUE(stands || std::filesystem::exists(directory_ / "out.replaced" / kHeightsFile));
            const Bytes now = stands ? readFile(directory_ / "out" / kHeightsFile) : old;
            EXPECT_TRUE(now == old || now == whole_[kHeightsFile]);
        }
        EXPECT_EQ(directory_.names(), std::vector<std::string>{"out"});
        expectWhole();
        std::filesystem::remove_all(directory_ / "out");
    }
}

}  // namespace
}  // namespace terray
