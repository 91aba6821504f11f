#include "client/output/picture.h"

#include <fstream>
#include <limits>
#include <memory>

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "common/error.h"
#include "tests/common/temporary_directory.h"

namespace terray {
namespace {

using test::TemporaryDirectory;

constexpr GridSize kSize{37, 21};  // no multiple of anything

Grid<std::array<uint8_t, 4>> bytePicture() {
    Grid<std::array<uint8_t, 4>> picture(kSize);
    for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width; ++x)
            picture.at(x, y) = {static_cast<uint8_t>(7 * x), static_cast<uint8_t>(12 * y), static_cast<uint8_t>(x * y),
                                255};
    return picture;
}

MeasuredPicture measuredPicture() {
    MeasuredPicture picture{.colour = Grid<glm::vec4>(kSize),
                            .depthMetres = Grid<float>(kSize, std::numeric_limits<float>::infinity()),
                            .positionOrigin = {400123.25, 5200456.5, -0.125},
                            .position = Grid<glm::vec3>(kSize),
                            .normal = Grid<glm::vec3>(kSize),
                            .nodeLevel = Grid<uint32_t>(kSize),
                            .steps = Grid<uint32_t>(kSize),
                            .hit = Grid<uint32_t>(kSize)};
    for (int y = 1; y < kSize.height; ++y)  // row 0 is sky
        for (int x = 0; x < kSize.width; ++x) {
            const auto fx = static_cast<float>(x);
            const auto fy = static_cast<float>(y);
            picture.colour.at(x, y) = {fx / 64, fy / 32, 2.5f, 1};  // halves hold these exactly
            picture.depthMetres.at(x, y) = 1234.567f * fx + fy;
            picture.position.at(x, y) = {fx * 0.1f, -fy * 0.3f, fx * fy};
            picture.normal.at(x, y) = {0.6f, 0, 0.8f};
            picture.nodeLevel.at(x, y) = static_cast<uint32_t>(x % 20);
            picture.steps.at(x, y) = static_cast<uint32_t>(x * 1000 + y);
            picture.hit.at(x, y) = 1;
        }
    return picture;
}

template <class T>
Grid<T> channel(Imf::InputFile& file, const char* name, Imf::PixelType type) {
    const Imf::Channel* found = file.header().channels().findChannel(name);
    EXPECT_NE(found, nullptr) << name;
    Grid<T> grid(kSize);
    if (found == nullptr) return grid;
    EXPECT_EQ(found->type, type) << name;
    Imf::FrameBuffer pixels;
    pixels.insert(name, Imf::Slice(type, reinterpret_cast<char*>(grid.cells().data()), sizeof(T),
                                   sizeof(T) * static_cast<size_t>(kSize.width)));
    file.setFrameBuffer(pixels);
    file.readPixels(0, static_cast<int>(kSize.height) - 1);
    return grid;
}

TEST(Png, ComesBackByteForByte) {
    const TemporaryDirectory directory;
    const auto picture = bytePicture();
    writePng(directory / "a.png", picture.view());
    EXPECT_EQ(directory.entries(), 1u);

    const auto input = OIIO::ImageInput::open((directory / "a.png").string());
    ASSERT_TRUE(input);
    ASSERT_EQ(input->spec().width, kSize.width);
    ASSERT_EQ(input->spec().height, kSize.height);
    ASSERT_EQ(input->spec().nchannels, 4);
    Grid<std::array<uint8_t, 4>> back(kSize);
    ASSERT_TRUE(input->read_image(0, 0, 0, 4, OIIO::TypeDesc::UINT8, back.cells().data()));
    EXPECT_EQ(back, picture);
}

TEST(Png, WritesAWindowOfALargerPicture) {
    const TemporaryDirectory directory;
    const auto picture = bytePicture();
    const auto window = picture.view().window({5, 3, 11, 9});
    writePng(directory / "a.png", window);
    const auto input = OIIO::ImageInput::open((directory / "a.png").string());
    ASSERT_TRUE(input);
    Grid<std::array<uint8_t, 4>> back(window.size());
    ASSERT_TRUE(input->read_image(0, 0, 0, 4, OIIO::TypeDesc::UINT8, back.cells().data()));
    for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 11; ++x) EXPECT_EQ(back.at(x, y), window.at(x, y));
}

std::string bytesOf(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(Png, RowByRowIsTheSameFileAndHalfOfItIsNone) {
    const TemporaryDirectory directory;
    const auto picture = bytePicture();
    writePng(directory / "whole.png", picture.view());
    {
        PngWriter writer(directory / "bands.png", kSize);
        for (int y = 0; y < kSize.height; y += 4)
            writer.write(picture.view().window({0, y, kSize.width, std::min<int64_t>(4, kSize.height - y)}));
        writer.finish();
    }
    EXPECT_EQ(bytesOf(directory / "bands.png"), bytesOf(directory / "whole.png"));
    {
        PngWriter given(directory / "given-up.png", kSize);
        given.write(picture.view().window({0, 0, kSize.width, 7}));
        PngWriter begun(directory / "begun.png", kSize);
    }
    EXPECT_EQ(directory.entries(), 2u);
}

TEST(Exr, EveryChannelComesBackExactly) {
    const TemporaryDirectory directory;
    const MeasuredPicture picture = measuredPicture();
    writeExr(directory / "a.exr", picture);
    EXPECT_EQ(directory.entries(), 1u);

    Imf::InputFile file((directory / "a.exr").c_str());
    EXPECT_EQ(channel<float>(file, "depth.metres", Imf::FLOAT), picture.depthMetres);
    EXPECT_EQ(channel<uint32_t>(file, "node.level", Imf::UINT), picture.nodeLevel);
    EXPECT_EQ(channel<uint32_t>(file, "ray.steps", Imf::UINT), picture.steps);
    EXPECT_EQ(channel<uint32_t>(file, "ray.hit", Imf::UINT), picture.hit);
    const char* colours[] = {"R", "G", "B", "A"};
    const char* positions[] = {"position.x", "position.y", "position.z"};
    const char* normals[] = {"normal.x", "normal.y", "normal.z"};
    for (int c = 0; c < 4; ++c) {
        const auto found = channel<Imath::half>(file, colours[c], Imf::HALF);
        for (size_t n = 0; n < found.cells().size(); ++n)
            ASSERT_EQ(static_cast<float>(found.cells()[n]), picture.colour.cells()[n][c]) << colours[c];
    }
    for (int c = 0; c < 3; ++c) {
        const auto position = channel<float>(file, positions[c], Imf::FLOAT);
        const auto normal = channel<float>(file, normals[c], Imf::FLOAT);
        for (size_t n = 0; n < position.cells().size(); ++n) {
            ASSERT_EQ(position.cells()[n], picture.position.cells()[n][c]);
            ASSERT_EQ(normal.cells()[n], picture.normal.cells()[n][c]);
        }
    }
    const auto* origin = file.header().findTypedAttribute<Imf::V3dAttribute>("terray:positionOrigin");
    ASSERT_NE(origin, nullptr);
    EXPECT_EQ(origin->value(), Imath::V3d(400123.25, 5200456.5, -0.125));
}

TEST(Picture, AnUnwritablePlaceIsAnOutputErrorThatLeavesNothing) {
    const TemporaryDirectory directory;
    std::ofstream(directory / "file") << "no directory";
    const auto refused = [](const auto& write) {
        try {
            write();
        } catch (const Error& error) {
            return error.code();
        }
        return ExitCode::ok;
    };
    for (const auto& place : {directory / "missing", directory / "file"}) {
        EXPECT_EQ(refused([&] { writePng(place / "a.png", bytePicture().view()); }), ExitCode::output);
        EXPECT_EQ(refused([&] { writeExr(place / "a.exr", measuredPicture()); }), ExitCode::output);
    }
    EXPECT_EQ(directory.entries(), 1u);
}

TEST(Picture, AFullDiskIsAnOutputErrorThatLeavesNothing) {
    const TemporaryDirectory directory;
    // Both writers open NAME.partial; as a link to /dev/full it takes no byte.
    for (const char* name : {"a.png", "a.exr"}) {
        std::filesystem::create_symlink("/dev/full", directory / (std::string(name) + ".partial"));
        try {
            if (std::string_view(name).ends_with("png"))
                writePng(directory / name, bytePicture().view());
            else
                writeExr(directory / name, measuredPicture());
            ADD_FAILURE() << name << " was written to a full disk";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::output) << error.what();
        }
    }
    EXPECT_EQ(directory.entries(), 0u);
}

}  // namespace
}  // namespace terray
