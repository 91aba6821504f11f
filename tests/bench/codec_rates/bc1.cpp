// PSNR and MPixel/s of BC1 encoders over photos: the table of REPORT.md.
//
// usage: bc1_rates NAME=PHOTO ...     (three bands of bytes)
// Decoded by common/bc1_decode.h; PSNR over red, green and blue of all texels in whole blocks; one thread.

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <string>

#include <gdal_priv.h>

#define STB_DXT_STATIC
#define STB_DXT_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_dxt.h>
#pragma GCC diagnostic pop
#if TERRAY_HAS_SQUISH
#include <squish.h>
#endif

#include "common/bc1_decode.h"
#include "common/error.h"
#include "common/imagery_tile.h"
#include "tests/bench/codec_rates/rates.h"

namespace terray::bench {
namespace {

using EncodeBlock = std::function<void(unsigned char* block, const unsigned char* texels)>;

Grid<Rgba> readPhoto(const std::string& file) {
    const GDALDatasetUniquePtr photo(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER));
    if (!photo || photo->GetRasterCount() < 3)
        throw Error(ExitCode::input, "cannot read \"" + file + "\": expected a photo of three bands");
    const int width = photo->GetRasterXSize() / 4 * 4;
    const int height = photo->GetRasterYSize() / 4 * 4;
    Grid<Rgba> texels({width, height}, Rgba{0, 0, 0, 255});
    if (photo->RasterIO(GF_Read, 0, 0, width, height, texels.view().data(), width, height, GDT_Byte, 3, nullptr, 4,
                        GSpacing{4} * width, 1, nullptr) != CE_None)
        throw Error(ExitCode::input, "cannot read \"" + file + "\"");
    return texels;
}

Bytes encode(const Grid<Rgba>& photo, const EncodeBlock& encodeBlock) {
    Bytes blocks(static_cast<size_t>(photo.size().count()) / 16 * kBc1BlockBytes);
    auto* block = reinterpret_cast<unsigned char*>(blocks.data());
    Grid<Rgba> texels({4, 4});
    for (int64_t top = 0; top < photo.size().height; top += 4)
        for (int64_t left = 0; left < photo.width(); left += 4, block += kBc1BlockBytes) {
            for (int64_t row = 0; row < 4; ++row)
                std::memcpy(&texels.at(0, row), &photo.at(left, top + row), 4 * sizeof(Rgba));
            encodeBlock(block, texels.at(0, 0).data());
        }
    return blocks;
}

double psnr(const Grid<Rgba>& a, const Grid<Rgba>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.cells().size(); ++i)
        for (size_t channel = 0; channel < 3; ++channel) {
            const int difference = a.cells()[i][channel] - b.cells()[i][channel];
            sum += difference * difference;
        }
    return 10 * std::log10(255.0 * 255 * 3 * static_cast<double>(a.cells().size()) / sum);
}

void measure(const std::string& photoName, const Grid<Rgba>& photo, const std::string& name,
             const EncodeBlock& encodeBlock) {
    Bytes blocks;
    const double seconds = leastSeconds([&] { blocks = encode(photo, encodeBlock); });
    std::printf("| %s | %s | %.2f | %.1f |\n", photoName.c_str(), name.c_str(),
                psnr(photo, decodeBc1(blocks, photo.size())),
                1e-6 * static_cast<double>(photo.size().count()) / seconds);
    std::fflush(stdout);
}

void measurePhoto(const std::string& name, const std::string& file) {
    const Grid<Rgba> photo = readPhoto(file);
    measure(name, photo, "stb_dxt, normal",
            [](auto* block, const auto* texels) { stb_compress_dxt_block(block, texels, 0, STB_DXT_NORMAL); });
    measure(name, photo, "**stb_dxt, high quality**",
            [](auto* block, const auto* texels) { stb_compress_dxt_block(block, texels, 0, STB_DXT_HIGHQUAL); });
#if TERRAY_HAS_SQUISH
    measure(name, photo, "squish, range fit", [](auto* block, const auto* texels) {
        squish::Compress(texels, block, squish::kDxt1 | squish::kColourRangeFit);
    });
    measure(name, photo, "squish, cluster fit", [](auto* block, const auto* texels) {
        squish::Compress(texels, block, squish::kDxt1 | squish::kColourClusterFit);
    });
#endif
}

}  // namespace
}  // namespace terray::bench

int main(int count, char** arguments) {
    GDALAllRegister();
    std::printf("| photo | encoder | PSNR, dB | MPixel/s |\n|---|---|---|---|\n");
    return terray::bench::measureFiles("bc1_rates", count, arguments, terray::bench::measurePhoto);
}
