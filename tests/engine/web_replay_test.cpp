#include <filesystem>
#include <memory>

#include <gtest/gtest.h>

#include "client/bench/bench.h"
#include "common/error.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"
#include "tests/support/fault_server.h"

namespace terray {
namespace {

using test::TemporaryDirectory;

/// Flights over one dataset, from its directory and from a web server.
class WebReplay : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        setenv("no_proxy", "*", 1);
        shared_ = std::make_unique<TemporaryDirectory>();
        std::filesystem::create_directory(*shared_ / "dataset");
        AnalyticDataset({.finestLevel = 1, .imageryLevel = 2}).write(*shared_ / "dataset");
        ASSERT_EQ(bench({"tour", dataset(), "--seconds", "2", "--out", flight()}), ExitCode::ok);
        ASSERT_EQ(replay(dataset(), "local"), ExitCode::ok);
    }
    static void TearDownTestSuite() { shared_.reset(); }

    static std::string dataset() { return (*shared_ / "dataset").string(); }
    static std::string flight() { return (*shared_ / "tour.json").string(); }
    static ExitCode bench(const std::vector<std::string>& arguments) {
        try {
            return runBench(arguments);
        } catch (const Error& error) {
            return error.code();
        }
    }
    static ExitCode replay(const std::string& place, const std::string& name) {
        return bench({"replay", place, "--flight", flight(), "--out", (*shared_ / name).string(), "--size", "160x90",
                      "--fps", "2", "--warm-up", "0", "--frames", "--wait-for-tiles", "--force", "--launch", "raster"});
    }
    /// Picture by picture, byte by byte.
    static void expectSameFrames(const std::string& name) {
        size_t frames = 0;
        for (const auto& entry : std::filesystem::directory_iterator(shared_->path() / "local" / "frames")) {
            const auto other = shared_->path() / name / "frames" / entry.path().filename();
            ASSERT_TRUE(std::filesystem::exists(other)) << other;
            EXPECT_EQ(test::readFile(entry.path()), test::readFile(other)) << other;
            ++frames;
        }
        EXPECT_EQ(frames, 5u);
    }

    static std::unique_ptr<TemporaryDirectory> shared_;
    FaultServer server_{shared_->path()};
};

std::unique_ptr<TemporaryDirectory> WebReplay::shared_;

TEST_F(WebReplay, DrawsTheSameFramesAsFromTheDirectory) {
    ASSERT_EQ(replay(server_.address() + "/dataset", "web"), ExitCode::ok);
    expectSameFrames("web");
    ASSERT_EQ(replay(server_.address() + "/dataset/heights.pmtiles", "file"), ExitCode::ok);
    expectSameFrames("file");
}

TEST_F(WebReplay, DrawsTheSameFramesFromAServerThatFailsNowAndThen) {
    for (const Fault fault : {Fault::reset, Fault::corrupt, Fault::status500}) {
        server_.setFault(fault, 0.08);
        ASSERT_EQ(replay(server_.address() + "/dataset", "faulty"), ExitCode::ok) << static_cast<int>(fault);
        expectSameFrames("faulty");
    }
    EXPECT_GT(server_.faults(), 3u);
}

TEST_F(WebReplay, EndsWithTheExitCodeOfTheNetworkWhenNobodyAnswers) {
    server_.kill();
    EXPECT_EQ(replay(server_.address() + "/dataset", "dead"), ExitCode::network);
    EXPECT_FALSE(std::filesystem::exists(shared_->path() / "dead" / "summary.json"));
}

TEST_F(WebReplay, EndsWithTheExitCodeOfDatasetsWhereThereIsNone) {
    EXPECT_EQ(replay(server_.address() + "/elsewhere", "none"), ExitCode::dataset);
}

}  // namespace
}  // namespace terray
