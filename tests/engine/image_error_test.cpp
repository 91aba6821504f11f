#include <cmath>
#include <fstream>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "client/bench/bench.h"
#include "client/output/picture.h"
#include "common/json.h"
#include "common/reference/picture_error.h"
#include "tests/common/temporary_directory.h"

namespace terray {
namespace {

class ImageErrorTest : public testing::Test {
  protected:
    [[nodiscard]] std::string in(const std::string& name) const { return (directory_ / name).string(); }
    std::string write(const std::string& name, uint8_t grey, GridSize size = {12, 8}) const {
        std::filesystem::create_directories(std::filesystem::path(in(name)).parent_path());
        writePng(in(name), Grid<Rgba>(size, {grey, grey, grey, 255}).view());
        return in(name);
    }
    static Json compared(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "image-error");
        arguments.emplace_back("--json");
        testing::internal::CaptureStdout();
        const ExitCode code = runBench(arguments);
        const std::string out = testing::internal::GetCapturedStdout();
        EXPECT_EQ(code, ExitCode::ok);
        return Json::parse(out).value();
    }
    static void expectRefusal(const std::vector<std::string>& arguments, ExitCode code, const std::string& text) {
        try {
            (void)runBench(arguments);
            ADD_FAILURE() << "not refused";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), code) << error.what();
            EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
        }
    }

    test::TemporaryDirectory directory_;
};

TEST_F(ImageErrorTest, TellsWhatTheLibraryMeasures) {
    const std::string a = write("a.png", 100);
    const std::string b = write("b.png", 110);
    const Json json = compared({a, b, "--pixels-per-degree", "30"});
    const Json& picture = json.find("pictures")->array().at(0);
    EXPECT_NEAR(picture.numberAt("psnrDb").value(), 20 * std::log10(25.5), 1e-9);
    EXPECT_EQ(picture.numberAt("differing").value(), 1);
    EXPECT_EQ(picture.numberAt("greatestDifference").value(), 10);
    const Grid<Rgba> first = readPicture(a);
    const Grid<Rgba> second = readPicture(b);
    const Grid<float> flip = flipOf(first.view(), second.view(), 30);
    EXPECT_EQ(json.numberAt("flipMean").value(), spreadOf(flip.cells()).mean);
}

TEST_F(ImageErrorTest, EqualPicturesHaveNoError) {
    const std::string a = write("a.png", 100);
    const Json json = compared({a, a});
    EXPECT_EQ(json.numberAt("flipMean").value(), 0);
    EXPECT_TRUE(json.find("pictures")->array().at(0).find("psnrDb")->isNull());
}

TEST_F(ImageErrorTest, WritesAMapThatIsBlackWhereNothingDiffers) {
    const std::string a = write("a.png", 100, {60, 40});
    Grid<Rgba> spoilt = readPicture(a);
    spoilt.at(5, 5) = {255, 255, 255, 255};
    writePng(in("b.png"), spoilt.view());
    (void)compared({a, in("b.png"), "--map", in("map.png")});
    const Grid<Rgba> map = readPicture(in("map.png"));
    ASSERT_EQ(map.size(), spoilt.size());
    EXPECT_EQ(map.at(59, 39), heatColour(0));
    EXPECT_GT(map.at(5, 5)[0], 200);
}

TEST_F(ImageErrorTest, ComparesTheFramesOfTwoRuns) {
    for (const char* frame : {"frame_00000.png", "frame_00001.png"}) {
        write(std::string("a/frames/") + frame, 100);
        write(std::string("b/frames/") + frame, 100);
    }
    write("b/frames/frame_00001.png", 140);
    const Json json = compared({in("a"), in("b")});
    EXPECT_EQ(json.find("pictures")->array().size(), 2U);
    EXPECT_EQ(json.stringAt("worst").value(), "frame_00001.png");
    const Json& worst = json.find("pictures")->array().at(1);
    EXPECT_DOUBLE_EQ(json.numberAt("flipMean").value(), worst.numberAt("flipMean").value() / 2);
}

TEST_F(ImageErrorTest, RefusesWhatCannotBeCompared) {
    const std::string a = write("a.png", 100);
    const std::string small = write("small.png", 100, {11, 8});
    write("run/frames/frame_00000.png", 100);
    write("longer/frames/frame_00000.png", 100);
    write("longer/frames/frame_00001.png", 100);
    std::filesystem::create_directory(in("empty"));
    std::ofstream(in("text.png")) << "no picture";
    expectRefusal({"image-error", a, small}, ExitCode::input, "12x8");
    expectRefusal({"image-error", a, in("missing.png")}, ExitCode::input, "missing.png");
    expectRefusal({"image-error", a, in("text.png")}, ExitCode::input, "text.png");
    expectRefusal({"image-error", a, in("run")}, ExitCode::input, "expected two pictures");
    expectRefusal({"image-error", in("run"), in("longer")}, ExitCode::input, "frame_00001.png");
    expectRefusal({"image-error", in("run"), in("empty")}, ExitCode::input, "--frames");
    expectRefusal({"image-error", in("longer"), in("longer"), "--map", in("m.png")}, ExitCode::usage, "--map");
    expectRefusal({"image-error", a, a, "--pixels-per-degree", "0"}, ExitCode::usage, "1 to 1000");
}

TEST(ReadPicture, SpreadsGreyAndRefusesSixteenBits) {
    const test::TemporaryDirectory directory;
    const auto write = [&](const std::string& name, int channels, OIIO::TypeDesc type) {
        const std::string path = (directory / name).string();
        const auto output = OIIO::ImageOutput::create(path);
        const std::vector<uint16_t> pixels(8, 0x4040);
        OIIO::ImageSpec spec(2, 1, channels, type);
        spec.attribute("oiio:UnassociatedAlpha", 1);
        EXPECT_TRUE(output->open(path, spec));
        EXPECT_TRUE(output->write_image(type, pixels.data()));
        EXPECT_TRUE(output->close());
        return path;
    };
    EXPECT_EQ(readPicture(write("grey.png", 1, OIIO::TypeDesc::UINT8)).at(1, 0), (Rgba{64, 64, 64, 255}));
    EXPECT_EQ(readPicture(write("colour.png", 3, OIIO::TypeDesc::UINT8)).at(1, 0), (Rgba{64, 64, 64, 255}));
    // Not multiplied by its alpha, though OpenImageIO would like to.
    EXPECT_EQ(readPicture(write("both.png", 4, OIIO::TypeDesc::UINT8)).at(1, 0), (Rgba{64, 64, 64, 64}));
    EXPECT_THROW((void)readPicture(write("deep.png", 3, OIIO::TypeDesc::UINT16)), Error);
}

}  // namespace
}  // namespace terray
