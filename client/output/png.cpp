#include <memory>
#include <span>
#include <string>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "client/output/picture.h"
#include "common/error.h"
#include "common/output_file.h"

namespace terray {

void writePng(const std::filesystem::path& path, GridView<const std::array<uint8_t, 4>> srgb) {
    constexpr int kChannels = 4;
    constexpr int kCompression = 4;  // of zlib's 1 to 9
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("png");
    if (!output)
        throw Error(ExitCode::output,
                    "cannot write " + path.string() + ": OpenImageIO's PNG writer: " + OIIO::geterror());

    OIIO::ImageSpec spec(static_cast<int>(srgb.width()), static_cast<int>(srgb.height()), kChannels,
                         OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("png:compressionLevel", kCompression);
    // Into memory first: OpenImageIO 2.4 does not notice a full disk.
    std::vector<unsigned char> encoded;
    OIIO::Filesystem::IOVecOutput memory(encoded);
    const auto bytesPerRow = static_cast<OIIO::stride_t>(srgb.stride()) * kChannels;
    const bool written = output->set_ioproxy(&memory) && output->open(path.string(), spec) &&
                         output->write_image(OIIO::TypeDesc::UINT8, srgb.data(), OIIO::AutoStride, bytesPerRow) &&
                         output->close();
    if (!written) throw Error(ExitCode::output, "cannot encode " + path.string() + ": " + output->geterror());
    writeWholeFile(path, std::as_bytes(std::span(encoded)));
}

}  // namespace terray
