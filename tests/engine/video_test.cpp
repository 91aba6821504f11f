// Videos of flights, through the ffmpeg that is installed: all frames, the right ones, the same after a break.

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "client/bench/bench.h"
#include "client/bench/encoder.h"
#include "client/stream/flight.h"
#include "common/bytes.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"
#include "tests/support/run_program.h"

namespace terray {
namespace {

using test::readFile;
using test::TemporaryDirectory;

constexpr int kWidth = 64, kHeight = 48;

class VideoTest : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shared_ = std::make_unique<TemporaryDirectory>();
        std::filesystem::create_directory(*shared_ / "dataset");
        const AnalyticDataset dataset({.finestLevel = 1, .imageryLevel = 1});
        dataset.write(*shared_ / "dataset");
        saveFlight(standardTour(dataset, 2), *shared_ / "tour.json", nullptr);
    }
    static void TearDownTestSuite() { shared_.reset(); }

    static std::string dataset() { return (*shared_ / "dataset").string(); }
    std::string in(const std::string& name) const { return (own_ / name).string(); }
    /// 21 frames in segments of 4, the last one of 1.
    std::vector<std::string> command(const std::string& name, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> all{"video",     dataset(), "--flight", (*shared_ / "tour.json").string(),
                                     "--size",    "64x48",   "--fps",    "10",
                                     "--segment", "4",       "--out",    in(name)};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    static ExitCode bench(const std::vector<std::string>& arguments, std::string* why = nullptr) {
        try {
            return runBench(arguments);
        } catch (const Error& error) {
            if (why != nullptr) *why = error.what();
            return error.code();
        }
    }
    /// What an installed program prints.
    static std::string told(std::vector<std::string> words) {
        const ProgramResult result = execute({.program = "/usr/bin/env", .arguments = std::move(words)});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return result.out;
    }
    /// Brightness of the pixels of one frame of a video or picture, row by row from the top, 0 to 255.
    std::vector<double> brightnessOf(const std::string& path, int frame) const {
        told({"ffmpeg", "-loglevel", "error", "-y", "-i", path, "-vf", "select=eq(n\\," + std::to_string(frame) + ")",
              "-frames:v", "1", "-pix_fmt", "rgb24", "-f", "rawvideo", in("rgb.raw")});
        const Bytes rgb = readFile(own_ / "rgb.raw");
        std::vector<double> brightness;
        for (size_t n = 0; n + 2 < rgb.size(); n += 3)
            brightness.push_back(0.299 * std::to_integer<int>(rgb[n]) + 0.587 * std::to_integer<int>(rgb[n + 1]) +
                                 0.114 * std::to_integer<int>(rgb[n + 2]));
        return brightness;
    }

    static inline std::unique_ptr<TemporaryDirectory> shared_;
    TemporaryDirectory own_;
};

TEST_F(VideoTest, HoldsEachFrameOfTheFlightAtItsRateAndSize) {
    ASSERT_EQ(bench(command("a.mp4")), ExitCode::ok);
    EXPECT_EQ(told({"ffprobe", "-v", "error", "-count_frames", "-select_streams", "v", "-show_entries",
                    "stream=codec_name,width,height,r_frame_rate,nb_read_frames", "-of", "csv=p=0", in("a.mp4")}),
              "h264,64,48,10/1,21\n");
    EXPECT_FALSE(std::filesystem::exists(in("a.mp4.parts")));
}

#if TERRAY_WITH_OUTPUT
TEST_F(VideoTest, ItsFramesAreThoseOfAReplay) {
    ASSERT_EQ(bench(command("a.mkv", {"--quality", "0", "--launch", "compute"})), ExitCode::ok);
    ASSERT_EQ(bench({"replay", dataset(), "--flight", (*shared_ / "tour.json").string(), "--size", "64x48", "--fps",
                     "10", "--launch", "compute", "--wait-for-tiles", "--frames", "--out", in("run")}),
              ExitCode::ok);
    for (const int frame : {0, 7, 20}) {
        char name[32];
        std::snprintf(name, sizeof(name), "run/frames/frame_%05d.png", frame);
        const std::vector<double> filmed = brightnessOf(in("a.mkv"), frame), drawn = brightnessOf(in(name), 0);
        ASSERT_EQ(filmed.size(), size_t{kWidth} * kHeight);
        ASSERT_EQ(drawn.size(), filmed.size());
        double sum = 0;
        for (size_t n = 0; n < drawn.size(); ++n) sum += std::abs(filmed[n] - drawn[n]);
        // Of 255: colours are stored for 2 x 2 pixels and in steps; brightness is what they are rounded around.
        EXPECT_LT(sum / static_cast<double>(drawn.size()), 3) << frame;
    }
}
#endif

TEST_F(VideoTest, BrokenOffAndGoneOnWithItIsTheSameFile) {
    ASSERT_EQ(bench(command("whole.mp4", {"--launch", "raster"})), ExitCode::ok);
    const ProgramRun run{
        .program = TERRAY_BENCH_PROGRAM,
        .arguments = command("broken.mp4", {"--launch", "raster"}),
        .interruptWhen = [&] { return std::filesystem::exists(in("broken.mp4.parts/segment_00001.mp4")); }};
    ASSERT_EQ(execute(run).exitCode, static_cast<int>(ExitCode::interrupted)) << "the program was too fast";
    ASSERT_FALSE(std::filesystem::exists(in("broken.mp4")));
    const auto kept = std::filesystem::last_write_time(in("broken.mp4.parts/segment_00001.mp4"));
    std::ofstream(own_ / "broken.mp4.parts" / "unfinished_segment_00002.mp4") << "cut sh";

    std::string why;
    EXPECT_EQ(bench(command("broken.mp4", {"--resume", "--launch", "compute"}), &why), ExitCode::usage);
    EXPECT_NE(why.find("its launch was \"raster\""), std::string::npos) << why;
    EXPECT_EQ(std::filesystem::last_write_time(in("broken.mp4.parts/segment_00001.mp4")), kept);

    ASSERT_EQ(bench(command("broken.mp4", {"--resume", "--launch", "raster"}), &why), ExitCode::ok) << why;
    EXPECT_EQ(readFile(own_ / "broken.mp4"), readFile(own_ / "whole.mp4"));
    EXPECT_FALSE(std::filesystem::exists(in("broken.mp4.parts")));
}

TEST_F(VideoTest, ResumedWithoutPartsItBegins) {
    EXPECT_EQ(bench(command("a.mp4", {"--resume"})), ExitCode::ok);
    EXPECT_EQ(bench(command("a.mp4")), ExitCode::output) << "it exists";
    EXPECT_EQ(bench(command("a.mp4", {"--force"})), ExitCode::ok);
}

TEST_F(VideoTest, WithoutAnEncoderItSaysSoBeforeItDraws) {
    std::string why;
    EXPECT_EQ(bench(command("a.mp4", {"--ffmpeg", in("none")}), &why), ExitCode::unsupported);
    EXPECT_NE(why.find("Debian package ffmpeg"), std::string::npos) << why;
    EXPECT_EQ(bench(command("a.mp4", {"--ffmpeg", "false"}), &why), ExitCode::output);
    EXPECT_NE(why.find("exit code 1"), std::string::npos) << why;
    EXPECT_FALSE(std::filesystem::exists(in("a.mp4.parts")));
}

TEST_F(VideoTest, AnEncoderThatFailsIsQuoted) {
    {
        std::ofstream script(own_ / "fails");
        script << "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\necho no such codec >&2\nexit 3\n";
    }
    std::filesystem::permissions(own_ / "fails", std::filesystem::perms::owner_all);
    std::string why;
    EXPECT_EQ(bench(command("a.mp4", {"--ffmpeg", in("fails")}), &why), ExitCode::output);
    EXPECT_NE(why.find("no such codec"), std::string::npos) << why;
    EXPECT_FALSE(std::filesystem::exists(in("a.mp4")));
}

TEST_F(VideoTest, BadUseHasItsCode) {
    EXPECT_EQ(bench(command("a.avi")), ExitCode::usage);
    constexpr std::pair<const char*, const char*> kBad[] = {
        {"--size", "63x48"}, {"--fps", "0"}, {"--quality", "52"}, {"--segment", "0"}};
    for (const auto& [option, value] : kBad)
        EXPECT_EQ(bench({"video", dataset(), "--flight", (*shared_ / "tour.json").string(), "--out", in("a.mp4"),
                         option, value}),
                  ExitCode::usage)
            << option;
    EXPECT_FALSE(std::filesystem::exists(in("a.mp4.parts")));
}

TEST(Encoder, HandsAllBytesOver) {
    const TemporaryDirectory directory;
    const Bytes bytes(3'000'000, std::byte{7});  // more than a pipe holds
    Encoder encoder("sh", {"-c", "cat > " + (directory / "copy").string()}, directory / "log");
    encoder.write(bytes);
    encoder.finish();
    EXPECT_EQ(readFile(directory / "copy"), bytes);
}

}  // namespace
}  // namespace terray
