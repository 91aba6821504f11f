// Datasets that several processes build together. The processes are threads here, with a post office between them that
// is as slow to deliver as it likes; tests/preprocess/mpi_test.cpp runs true ones.

#include <array>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "common/error.h"
#include "preprocess/block_team.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

/// Messages of all to all.
class PostOffice {
  public:
    explicit PostOffice(int count) : boxes_(static_cast<size_t>(count)) {}

    void post(int from, int to, ByteView bytes) {
        const std::scoped_lock lock(mutex_);
        boxes_.at(static_cast<size_t>(to)).push_back({from, Bytes(bytes.begin(), bytes.end())});
    }
    std::optional<Ranks::Message> fetch(int rank) {
        const std::scoped_lock lock(mutex_);
        auto& box = boxes_.at(static_cast<size_t>(rank));
        if (box.empty() || ++asked_ % 3 == 0) return {};  // now and then a message takes longer
        Ranks::Message message = std::move(box.front());
        box.pop_front();
        return message;
    }
    [[nodiscard]] int count() const { return static_cast<int>(boxes_.size()); }

  private:
    std::mutex mutex_;
    std::vector<std::deque<Ranks::Message>> boxes_;
    int asked_ = 0;
};

class ThreadRanks final : public Ranks {
  public:
    ThreadRanks(PostOffice& office, int rank) : office_(office), rank_(rank) {}
    [[nodiscard]] int rank() const override { return rank_; }
    [[nodiscard]] int count() const override { return office_.count(); }
    [[nodiscard]] int onThisMachine() const override { return office_.count(); }
    [[nodiscard]] std::string name() const override { return "process " + std::to_string(rank_); }
    void send(int to, ByteView message) override { office_.post(rank_, to, message); }
    [[nodiscard]] std::optional<Message> receive() override { return office_.fetch(rank_); }

  private:
    PostOffice& office_;
    int rank_;
};

class Team : public testing::Test {
  protected:
    Team() : heights_(makeHills({2100, 1600}, 5, 3)) {
        if (!TERRAY_WITH_STB) return;
        Grid<Rgba> texels({700, 500}, Rgba{60, 90, 30, 255});
        for (int64_t y = 0; y < 500; ++y)
            for (int64_t x = 0; x < 700; ++x) texels.at(x, y)[0] = static_cast<uint8_t>(x * y);
        photo_ = gridPhoto(std::move(texels), 1);
    }

    [[nodiscard]] BuildRequest request(const std::string& out) const {
        return {.out = directory_ / out, .jobs = 2, .optionsText = "test", .blockDepth = 1, .stop = &stop_};
    }
    /// Builds with `count` processes; each may see other heights. @return what the leader failed of, if it did
    std::optional<Error> buildTogether(int count, const BuildRequest& common,
                                       const std::function<const HeightSource&(int rank)>& heightsOf) {
        PostOffice office(count);
        std::optional<Error> failure;
        {
            std::vector<std::jthread> others;
            for (int rank = 1; rank < count; ++rank)
                others.emplace_back([&, rank] { runMember(office, rank, common, heightsOf(rank)); });
            ThreadRanks ranks(office, 0);
            BuildRequest own = common;
            own.ranks = &ranks;
            try {
                summary_ = buildDataset(heightsOf(0), photo_, own);
            } catch (const Error& error) {
                failure.emplace(error);
                stop_ = true;  // which is what ending all processes comes to
            }
        }
        stop_ = false;
        return failure;
    }
    void runMember(PostOffice& office, int rank, BuildRequest request, const HeightSource& heights) const {
        ThreadRanks ranks(office, rank);
        request.ranks = &ranks;
        try {
            (void)buildDataset(heights, photo_, request);
        } catch (const std::exception& error) {
            TeamMember::giveUp(ranks, error, std::chrono::seconds(0));
        }
    }
    void expectSame(const std::string& one, const std::string& other) const {
        for (const char* name : {kHeightsFile, kImageryFile}) {
            if (!photo_ && name == kImageryFile) continue;
            EXPECT_EQ(readFile(directory_ / one / name), readFile(directory_ / other / name)) << name;
        }
    }

    TemporaryDirectory directory_;
    GridHeights heights_;
    OpenPhoto photo_;
    mutable std::atomic<bool> stop_ = false;
    BuildSummary summary_;
};

TEST_F(Team, BuildsTheSameBytesForAnyCountOfProcesses) {
    (void)buildDataset(heights_, photo_, request("alone"));
    for (const int count : {2, 3, 5}) {
        SCOPED_TRACE(count);
        const auto failure =
            buildTogether(count, request("together"), [&](int) -> const HeightSource& { return heights_; });
        ASSERT_FALSE(failure) << failure->what();
        EXPECT_EQ(summary_.processes, count);
        EXPECT_EQ(directory_.names(), (std::vector<std::string>{"alone", "together"}));
        expectSame("alone", "together");
        std::filesystem::remove_all(directory_ / "together");
    }
}

TEST(SpillShare, OfTwoProcessesNeverMeetInAUnit) {
    std::atomic<uint64_t> end = 0;
    const auto more = [&](uint64_t bytes) { return end.fetch_add(bytes); };
    std::array<SpillShare, 2> shares;
    std::map<uint64_t, size_t> owners;  // of units
    uint64_t written = 0;
    for (uint64_t n = 0; n < 2000; ++n) {
        const uint64_t bytes = n % 97 == 0 ? 40'000'000 : 1 + n * 7919 % 300'000;
        const size_t process = n * 13 % 7 % 2;
        const uint64_t place = shares.at(process).take(bytes, more);
        for (uint64_t unit = place / SpillShare::kUnit; unit <= (place + bytes - 1) / SpillShare::kUnit; ++unit)
            EXPECT_EQ(owners.try_emplace(unit, process).first->second, process) << n;
        written += bytes;
    }
    EXPECT_LT(end, 2 * written);
}

TEST_F(Team, ReallySharesTheBlocks) {
    // Each process has heights of its own that count their reads; a reader that waits gives the others time.
    std::vector<std::unique_ptr<GridHeights>> heights;
    std::vector<std::atomic<int>> reads(3);
    for (size_t rank = 0; rank < 3; ++rank) {
        heights.push_back(std::make_unique<GridHeights>(makeHills({2100, 1600}, 5, 3)));
        heights.back()->onRead_ = [&reads, rank] {
            ++reads[rank];
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        };
    }
    const auto failure = buildTogether(
        3, request("out"), [&](int rank) -> const HeightSource& { return *heights[static_cast<size_t>(rank)]; });
    ASSERT_FALSE(failure) << failure->what();
    EXPECT_EQ(reads[0] + reads[1] + reads[2], 3 * 2);  // the blocks of the finest level, each once
    for (const auto& count : reads) EXPECT_GT(count, 0);
}

TEST_F(Team, TheLeaderReportsWhatAnotherProcessFailedOfAndItCanBeGoneOnWith) {
    (void)buildDataset(heights_, photo_, request("alone"));
    GridHeights failing(makeHills({2100, 1600}, 5, 3));
    GridHeights slow(makeHills({2100, 1600}, 5, 3));
    failing.onRead_ = [] { throw Error(ExitCode::input, "the disk of this machine is gone"); };
    slow.onRead_ = [] { std::this_thread::sleep_for(std::chrono::milliseconds(100)); };
    BuildRequest whole = request("out");
    whole.jobs = 1;
    const auto failure =
        buildTogether(2, whole, [&](int rank) -> const HeightSource& { return rank == 0 ? slow : failing; });
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->code(), ExitCode::input);
    EXPECT_NE(std::string(failure->what()).find("process 1: the disk of this machine is gone"), std::string::npos)
        << failure->what();
    EXPECT_EQ(directory_.names(), (std::vector<std::string>{"alone", "out.partial"}));

    whole.resume = true;
    const auto resumed = buildTogether(3, whole, [&](int) -> const HeightSource& { return heights_; });
    ASSERT_FALSE(resumed) << resumed->what();
    expectSame("alone", "out");
}

TEST_F(Team, ABuildByManyCanBeGoneOnWithByOneAndTheOtherWayRound) {
    (void)buildDataset(heights_, photo_, request("alone"));
    for (const bool begunByMany : {true, false}) {
        std::atomic<int> reads = 0;
        GridHeights dying(makeHills({2100, 1600}, 5, 3));
        dying.onRead_ = [&] {
            if (++reads == 4) throw Error(ExitCode::input, "the power is gone");
        };
        BuildRequest common = request("out");
        EXPECT_TRUE(
            buildTogether(begunByMany ? 3 : 1, common, [&](int) -> const HeightSource& { return dying; }).has_value());
        common.resume = true;
        const auto failure =
            buildTogether(begunByMany ? 1 : 3, common, [&](int) -> const HeightSource& { return heights_; });
        ASSERT_FALSE(failure) << failure->what();
        expectSame("alone", "out");
        std::filesystem::remove_all(directory_ / "out");
    }
}

TEST_F(Team, AProcessThatSeesOtherSourcesIsNamed) {
    GridHeights others(makeHills({2100, 1599}, 5, 3));
    const auto failure = buildTogether(2, request("out"),
                                       [&](int rank) -> const HeightSource& { return rank == 0 ? heights_ : others; });
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->code(), ExitCode::usage);
    EXPECT_NE(std::string(failure->what()).find("process 1: sees something else than process 0"), std::string::npos)
        << failure->what();
}

TEST_F(Team, AWholeDatasetLeavesNothingToDoForAnybody) {
    (void)buildDataset(heights_, photo_, request("out"));
    BuildRequest again = request("out");
    again.resume = true;
    const auto failure = buildTogether(3, again, [&](int) -> const HeightSource& { return heights_; });
    EXPECT_FALSE(failure) << failure->what();
}

}  // namespace
}  // namespace terray
