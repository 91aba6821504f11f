#include <memory>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>

#include "client/output/picture.h"
#include "common/error.h"

namespace terray {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& reason) {
    throw Error(ExitCode::input, "cannot read the picture " + path.string() + ": " + reason);
}

/// Grey, grey with alpha, or three or four channels as they come.
Rgba pixelOf(const uint8_t* channels, int count) {
    constexpr uint8_t kOpaque = 255;
    if (count < 3) return {channels[0], channels[0], channels[0], count == 2 ? channels[1] : kOpaque};
    return {channels[0], channels[1], channels[2], count == 4 ? channels[3] : kOpaque};
}

}  // namespace

Grid<Rgba> readPicture(const std::filesystem::path& path) {
    constexpr int kMostSide = 65536;
    OIIO::ImageSpec asStored;
    asStored.attribute("oiio:UnassociatedAlpha", 1);
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path.string(), &asStored);
    if (!input) refuse(path, OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.format != OIIO::TypeDesc::UINT8 || spec.nchannels < 1 || spec.nchannels > 4)
        refuse(path, "found " + std::to_string(spec.nchannels) + " channels of " + spec.format.c_str() +
                         ", expected 1 to 4 of 8 bits");
    if (spec.width < 1 || spec.height < 1 || spec.width > kMostSide || spec.height > kMostSide)
        refuse(path, "found " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                         " pixels, expected sides of 1 to " + std::to_string(kMostSide));

    Grid<Rgba> picture({spec.width, spec.height});
    std::vector<uint8_t> row(static_cast<size_t>(spec.width) * static_cast<size_t>(spec.nchannels));
    for (int y = 0; y < spec.height; ++y) {
        if (!input->read_scanline(y + spec.y, 0, OIIO::TypeDesc::UINT8, row.data())) refuse(path, input->geterror());
        for (int x = 0; x < spec.width; ++x) picture.at(x, y) = pixelOf(&row[x * spec.nchannels], spec.nchannels);
    }
    return picture;
}

}  // namespace terray
