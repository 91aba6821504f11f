#include "client/view/view.h"

#include <cmath>
#include <fstream>

#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "client/render/gl_context.h"
#include "client/view/picture_in_parts.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

using test::TemporaryDirectory;

constexpr GridSize kSize{96, 64};

class ViewTest : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shared_ = std::make_unique<TemporaryDirectory>();
        std::filesystem::create_directory(*shared_ / "dataset");
        AnalyticDataset({.finestLevel = 1, .imageryLevel = 1}).write(*shared_ / "dataset");
    }
    static void TearDownTestSuite() { shared_.reset(); }

    static std::string dataset() { return (*shared_ / "dataset").string(); }
    std::string out(const std::string& name) const { return (own_ / name).string(); }
    static ExitCode view(const std::vector<std::string>& arguments) {
        try {
            return runView(arguments);
        } catch (const Error& error) {
            return error.code();
        }
    }
    std::vector<std::string> headless(const std::string& name, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> all{dataset(), "--headless", "--size", "96x64", "--out", out(name)};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }

    static std::string bytesOf(const std::string& path) {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    }

    static inline std::unique_ptr<TemporaryDirectory> shared_;
    TemporaryDirectory own_;
};

TEST_F(ViewTest, WritesAnOverviewAsPng) {
    ASSERT_EQ(view(headless("a.png")), ExitCode::ok);
    const auto input = OIIO::ImageInput::open(out("a.png"));
    ASSERT_TRUE(input);
    EXPECT_EQ(input->spec().width, 96);
    EXPECT_EQ(input->spec().height, 64);
    EXPECT_EQ(own_.entries(), 1u);
}

TEST_F(ViewTest, WritesWhatIsKnownOfEachPixelAsExr) {
    ASSERT_EQ(view(headless("a.exr", {"--camera", "401000,5198000,1500,20,-30,50"})), ExitCode::ok);
    Imf::InputFile file(out("a.exr").c_str());
    const auto read = [&](const char* name, Imf::PixelType type, auto grid) {
        Imf::FrameBuffer pixels;
        pixels.insert(name, Imf::Slice(type, reinterpret_cast<char*>(grid.cells().data()), 4, 4 * kSize.width));
        file.setFrameBuffer(pixels);
        file.readPixels(0, kSize.height - 1);
        return grid;
    };
    const auto hit = read("ray.hit", Imf::UINT, Grid<uint32_t>(kSize));
    const auto steps = read("ray.steps", Imf::UINT, Grid<uint32_t>(kSize));
    const auto depth = read("depth.metres", Imf::FLOAT, Grid<float>(kSize));
    const auto normal = read("normal.z", Imf::FLOAT, Grid<float>(kSize));
    int64_t hits = 0;
    for (size_t n = 0; n < hit.cells().size(); ++n) {
        EXPECT_EQ(hit.cells()[n] == 1, std::isfinite(depth.cells()[n]));
        if (hit.cells()[n] == 0) continue;
        ++hits;
        EXPECT_GT(steps.cells()[n], 0u);
        EXPECT_GT(normal.cells()[n], 0.5f);  // kSteepest is 1.2: cosines from 0.64
    }
    EXPECT_GT(hits, kSize.count() / 2);
}

TEST_F(ViewTest, TheSameViewIsTheSameFile) {
    ASSERT_EQ(view(headless("a.png")), ExitCode::ok);
    ASSERT_EQ(view(headless("b.png")), ExitCode::ok);
    EXPECT_EQ(bytesOf(out("a.png")), bytesOf(out("b.png")));
}

TEST_F(ViewTest, InPartsIsTheSameFileAsInOnePiece) {
    const std::vector<std::string> camera{"--camera", "401000,5198000,1500,20,-30,50", "--shadows", "on"};
    const auto drawn = [&](const std::string& name, const std::string& part) {
        std::vector<std::string> more = camera;
        if (!part.empty()) more.insert(more.end(), {"--part-size", part});
        EXPECT_EQ(view(headless(name, more)), ExitCode::ok);
        return bytesOf(out(name));
    };
    const std::string whole = drawn("whole.png", "");
    for (const char* part : {"48x32", "32x64", "1000x7", "95x63"})
        EXPECT_EQ(drawn(part + std::string(".png"), part), whole);
    EXPECT_EQ(view(headless("a.exr", {"--part-size", "48x32"})), ExitCode::usage);
    EXPECT_EQ(view(headless("a.png", {"--part-size", "0x32"})), ExitCode::usage);
}

/// Slots for so few tiles that a part near the eye must give up detail: then all parts do, and twice the same.
TEST_F(ViewTest, PartsGiveUpDetailTogetherWhereMemoryIsTooSmall) {
    const AnalyticDataset dataset({.finestLevel = 2, .imageryLevel = 2});
    const ShaderLibrary shaders;
    const HeadlessContext context;
    EngineOptions options;
    options.selection.tolerance = Pixels(0.1);
    options.gpuHeightBytes = 6 * GpuTiles::heightUploadBytes() * 3 / 2;
    const Camera camera{.position = {402000, 5195500, 900}, .pitch = radiansFromDegrees(-9)};
    std::vector<std::string> files;
    for (const char* name : {"a.png", "b.png"}) {
        Engine engine(dataset, shaders, options, 8, 8);
        PictureInParts picture(engine, camera, out(name), {.size = {200, 150}, .part = glm::ivec2(64, 79)});
        EXPECT_EQ(picture.parts(), 12);
        int draws = 0;
        for (; !picture.finished() && draws < 200; ++draws) picture.drawNext();
        EXPECT_GT(draws, 12) << "begun again";
        EXPECT_GT(picture.report().coarsening.heights, 1);
        files.push_back(bytesOf(out(name)));
    }
    EXPECT_EQ(files[0], files[1]);
}

TEST_F(ViewTest, PutsAPinIntoThePicture) {
    ASSERT_EQ(view(headless("a.png")), ExitCode::ok);
    ASSERT_EQ(view(headless("b.png", {"--marker", "401000,5198000"})), ExitCode::ok);
    const auto bytes = [&](const std::string& name) {
        std::ifstream file(out(name), std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    EXPECT_NE(bytes("a.png"), bytes("b.png"));
}

TEST_F(ViewTest, BadUseHasItsCodes) {
    EXPECT_EQ(view({}), ExitCode::usage);
    EXPECT_EQ(view({"--help"}), ExitCode::ok);
    EXPECT_EQ(view({dataset(), "--out", out("a.png")}), TERRAY_WITH_WINDOW ? ExitCode::usage : ExitCode::unsupported);
    EXPECT_EQ(view({dataset(), "--headless"}), ExitCode::usage);
    EXPECT_EQ(view(headless("a.jpg")), ExitCode::usage);
    EXPECT_EQ(view(headless("a.png", {"--camera", "1,2,3"})), ExitCode::usage);
    EXPECT_EQ(view(headless("a.png", {"--camera", "1,2,3,4,north"})), ExitCode::usage);
    EXPECT_EQ(view(headless("a.png", {"--occlusion", "perhaps"})), ExitCode::usage);
    EXPECT_EQ(view(headless("a.png", {"--marker", "here"})), ExitCode::usage);
    EXPECT_EQ(view(headless("a.png", {"--shade", "dir"})), ExitCode::usage);
    EXPECT_EQ(view(headless("a.png", {"--shaders", out("none")})), ExitCode::usage);
    EXPECT_EQ(own_.entries(), 0u);
}

TEST_F(ViewTest, BadPlacesHaveTheirCodes) {
    EXPECT_EQ(view({out("none"), "--headless", "--out", out("a.png")}), ExitCode::dataset);
    EXPECT_EQ(view({own_.path().string(), "--headless", "--out", out("a.png")}), ExitCode::dataset);
    EXPECT_EQ(view(headless("missing/a.png")), ExitCode::output);
    EXPECT_EQ(own_.entries(), 0u);
    ASSERT_EQ(view(headless("a.png")), ExitCode::ok);
    EXPECT_EQ(view(headless("a.png")), ExitCode::output);
    EXPECT_EQ(view(headless("a.png", {"--force"})), ExitCode::ok);
}

TEST_F(ViewTest, ADamagedTileGivesNoPicture) {
    const auto copy = own_ / "damaged";
    std::filesystem::copy(dataset(), copy);
    const auto archive = copy / kHeightsFile;
    {
        std::fstream file(archive, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(archive)) - 1000);  // in the last tile
        file.write("damage", 6);
    }
    EXPECT_EQ(view({copy.string(), "--headless", "--size", "512x512", "--out", out("a.png")}), ExitCode::dataset);
    std::filesystem::resize_file(archive, 5000);
    EXPECT_EQ(view({copy.string(), "--headless", "--out", out("a.png")}), ExitCode::dataset);
    EXPECT_FALSE(std::filesystem::exists(out("a.png")));
    EXPECT_FALSE(std::filesystem::exists(out("a.png.partial")));
}

}  // namespace
}  // namespace terray
