// terray-bench error --split: each cause alone, on ground that is known.

#include <fstream>

#include <gtest/gtest.h>

#include "client/bench/bench.h"
#include "client/bench/photo_compression.h"
#include "common/json.h"
#include "common/reference/picture_error.h"
#include "tests/common/temporary_directory.h"
#include "tests/stream/fake_dataset.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

std::string textOf(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

class ErrorSplitTest : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shared_ = std::make_unique<test::TemporaryDirectory>();
        std::filesystem::create_directory(*shared_ / "dataset");
        AnalyticDataset({.finestLevel = 2, .imageryLevel = 2}).write(*shared_ / "dataset");
        (void)runBench({"tour", dataset(), "--seconds", "1", "--out", (*shared_ / "tour.json").string()});
    }
    static void TearDownTestSuite() { shared_.reset(); }
    static std::string dataset() { return (*shared_ / "dataset").string(); }
    [[nodiscard]] std::string run() const { return (own_ / "run").string(); }

    ExitCode split(const std::vector<std::string>& more) {
        std::vector<std::string> all{"error",   dataset(),  "--flight", (*shared_ / "tour.json").string(),
                                     "--split", "--size",   "64x36",    "--frames",
                                     "3",       "--pixels", "0",        "--out",
                                     run(),     "--force"};
        all.insert(all.end(), more.begin(), more.end());
        try {
            return runBench(all);
        } catch (const Error& error) {
            return error.code();
        }
    }
    /// A column's statistic of a cause.
    [[nodiscard]] double at(const std::string& cause, const char* column, const char* statistic) const {
        const Json summary = Json::parse(textOf(own_ / "run" / "summary.json")).value();
        for (const Json& one : summary.find("settings")->array())
            if (one.stringAt("name").value() == cause)
                return one.find("columns")->find(column)->numberAt(statistic).value();
        ADD_FAILURE() << "no cause " << cause;
        return -1;
    }

    static inline std::unique_ptr<test::TemporaryDirectory> shared_;
    test::TemporaryDirectory own_;
};

TEST_F(ErrorSplitTest, EachCauseIsSeenAlone) {
    ASSERT_EQ(split({"--surface", "columns", "--tolerance", "4", "--anisotropy", "1"}), ExitCode::ok);
    const auto error = [&](const char* cause) { return at(cause, "error_px", "p99"); };
    EXPECT_LT(error("double, on the CPU"), 1e-9);
    EXPECT_GT(error("float, on the CPU"), 1e-6);
    EXPECT_LT(error("float, on the CPU"), 0.002);
    EXPECT_NEAR(error("float, on the GPU"), error("float, on the CPU"), 0.5 * error("float, on the CPU"));
    EXPECT_GT(error("level of detail"), 10 * error("float, on the GPU"));
    EXPECT_GT(error("surface"), 10 * error("float, on the GPU"));
    EXPECT_GE(error("all together"), error("surface"));
    EXPECT_GT(error("height steps"), error("float, on the GPU"));
    EXPECT_GT(at("surface", "flip", "mean"), 0);
    EXPECT_GT(at("photo filter and edges", "flip", "mean"), at("edges: one ray a pixel", "flip", "mean"));
    EXPECT_GE(at("streaming at full speed", "error_px", "p95"), at("the same, tiles waited for", "error_px", "p95"));
    EXPECT_EQ(runBench({"compare", run(), run(), "--fail-if", "error_px.p99>1x"}), ExitCode::ok);
    EXPECT_EQ(runBench({"compare", run(), run(), "--fail-if", "error_px.p99>0.9x"}), ExitCode::threshold);
}

TEST_F(ErrorSplitTest, ACauseThatIsNotThereChangesNothing) {
    ASSERT_EQ(split({"--surface", "bilinear", "--tolerance", "0.01", "--no-imagery"}), ExitCode::ok);
    for (const char* cause : {"level of detail", "surface"}) {
        EXPECT_EQ(at(cause, "error_px", "max"), at("float, on the GPU", "error_px", "max")) << cause;
        EXPECT_EQ(at(cause, "flip", "mean"), 0) << cause;
    }
    EXPECT_EQ(textOf(own_ / "run" / "split.csv").find("photo"), std::string::npos);
}

TEST_F(ErrorSplitTest, WritesItsTableAsDocumented) {
    ASSERT_EQ(split({}), ExitCode::ok);
    std::stringstream table(textOf(own_ / "run" / "split.csv"));
    const std::string documentation = textOf(std::filesystem::path(TERRAY_SOURCE_DIR) / "client" / "README.md");
    std::string line;
    std::getline(table, line);
    const auto commas = std::count(line.begin(), line.end(), ',');
    while (std::getline(table, line)) {
        std::string cause = line.substr(1, line.find('"', 1) - 1);
        // A photo's or a surface's name varies behind the comma.
        if (const size_t samples = cause.find(", samples"); samples != std::string::npos) cause.resize(samples);
        EXPECT_NE(documentation.find("| " + cause), std::string::npos) << "client/README.md lacks " << cause;
        EXPECT_EQ(std::count(line.begin() + static_cast<std::ptrdiff_t>(line.find('"', 1)), line.end(), ','), commas);
    }
}

TEST_F(ErrorSplitTest, BadUseIsRefused) {
    EXPECT_EQ(split({"--sweep", "surface"}), ExitCode::usage);
    EXPECT_EQ(split({"--maps"}), ExitCode::usage);
}

/// Blocks of one colour, given in 5, 6 and 5 bits.
Bytes plainBlocks(size_t bytes, uint16_t colour) {
    Bytes blocks(bytes, std::byte{0});
    for (size_t block = 0; block < bytes; block += kBc1BlockBytes)
        for (const size_t end : {size_t{0}, size_t{2}}) {
            blocks[block + end] = static_cast<std::byte>(colour & 0xff);
            blocks[block + end + 1] = static_cast<std::byte>(colour >> 8);
        }
    return blocks;
}

TEST(PhotoCompression, IsWhatLiesBetweenATileAndTheMeansOfItsChildren) {
    auto dataset = test::buildDataset([](int64_t, int64_t) { return 0.0; }, {.samples = {600, 600}, .imageryLevel = 1});
    for (auto& [id, tile] : dataset.imagery)  // greens of 32 and of 33 of 63: 130 and 134 of 255
        tile.blocks = plainBlocks(tile.blocks.size(), static_cast<uint16_t>((id.level == 0 ? 33 : 32) << 5));
    const auto measured = measurePhotoCompression(test::FakeSource(dataset));
    ASSERT_TRUE(measured.has_value());
    const Grid<Rgba> before({64, 64}, {0, 130, 0, 255});
    const Grid<Rgba> after({64, 64}, {0, 134, 0, 255});
    EXPECT_NEAR(measured->psnr, *psnr(before.view(), after.view()), 1e-6);
    const Grid<float> flip = flipOf(before.view(), after.view());
    EXPECT_NEAR(measured->flip, flip.at(32, 32), 1e-6);
}

TEST(PhotoCompression, IsNotToldWithoutAPhotoOrOfOneLevelAlone) {
    EXPECT_FALSE(measurePhotoCompression(AnalyticDataset({.finestLevel = 1})));
    EXPECT_FALSE(measurePhotoCompression(AnalyticDataset({.finestLevel = 1, .imageryLevel = 0})));
}

}  // namespace
}  // namespace terray
