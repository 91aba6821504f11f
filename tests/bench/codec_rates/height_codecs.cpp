// Bytes per sample and MB/s of ways to keep heights, over rasters and over noise: the table of REPORT.md.
//
// usage: height_codec_rates NAME=FILE[,SPACING[,SCALE]] ...
//   SPACING  metres, for a plain image; SCALE  metres for one unit of it
// Terray's own codecs work on tiles of 516 x 516 codes, quantum 1 cm; those of GDAL on a TIFF in memory, cut into tiles
// of 512 x 512. One thread, its processor time; MB of what is decoded, 2 bytes a code, 4 a float.

#include <cstdio>
#include <cstring>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>

#include "common/check.h"
#include "common/error.h"
#include "common/height_planes.h"
#include "common/zstd_block.h"
#include "preprocess/height_samples.h"
#include "preprocess/raster_files.h"
#include "tests/bench/codec_rates/rates.h"

namespace terray::bench {
namespace {

constexpr double kQuantum = 0.01;

struct Terrain {
    std::string name;
    Grid<float> heights;
    std::vector<HeightTile> tiles;
};

struct Row {
    std::string codec;
    double bytesPerSample = 0;
    double encodeRate = 0;  ///< MB/s
    double decodeRate = 0;
};

void print(const Terrain& terrain, const Row& row) {
    std::printf("| %s | %s | %.3f | %.0f | %.0f |\n", terrain.name.c_str(), row.codec.c_str(), row.bytesPerSample,
                row.encodeRate, row.decodeRate);
    std::fflush(stdout);
}

std::vector<HeightTile> tilesOf(const Grid<float>& heights) {
    std::vector<HeightTile> tiles;
    for (int64_t y = 0; y < heights.size().height; y += kTileCore)
        for (int64_t x = 0; x < heights.width(); x += kTileCore) {
            Grid<float> window({kHeightTileSide, kHeightTileSide}, kNoHeight);
            for (int64_t row = 0; row < kHeightTileSide; ++row)
                for (int64_t column = 0; column < kHeightTileSide; ++column) {
                    const int64_t from = x + column - kHeightApron;
                    const int64_t line = y + row - kHeightApron;
                    if (from >= 0 && line >= 0 && from < heights.width() && line < heights.size().height)
                        window.at(column, row) = heights.at(from, line);
                }
            const GridView<const float> core =
                std::as_const(window).view().window({kHeightApron, kHeightApron, kTileCore, kTileCore});
            auto tile = makeHeightTile(
                {.id = {}, .mean = window.view(), .core = {core, core, core}, .quantum = kQuantum, .children = {}});
            if (tile) tiles.push_back(std::move(*tile));
        }
    return tiles;
}

/// A codec of one tile: to bytes, and back.
template <class Encode, class Decode>
Row measureTiles(const Terrain& terrain, std::string name, const Encode& encode, const Decode& decode) {
    std::vector<Bytes> packed(terrain.tiles.size());
    Row row{.codec = std::move(name)};
    const double cells = static_cast<double>(terrain.tiles.size()) * kHeightTileSide * kHeightTileSide;
    row.encodeRate = 2e-6 * cells / leastSeconds([&] {
                         for (size_t i = 0; i < packed.size(); ++i) packed[i] = encode(terrain.tiles[i]);
                     });
    row.decodeRate = 2e-6 * cells / leastSeconds([&] {
                         for (size_t i = 0; i < packed.size(); ++i) decode(packed[i], terrain.tiles[i]);
                     });
    for (const Bytes& bytes : packed) row.bytesPerSample += static_cast<double>(bytes.size()) / cells;
    return row;
}

ByteView codesOf(const HeightTile& tile) {
    return std::as_bytes(tile.codes.cells());
}

void measureOwn(const Terrain& terrain) {
    Bytes scratch(sizeof(uint16_t) * kHeightTileSide * kHeightTileSide);
    print(terrain,
          measureTiles(
              terrain, "codes, raw",
              [](const HeightTile& tile) { return Bytes(codesOf(tile).begin(), codesOf(tile).end()); },
              [&](const Bytes& bytes, const HeightTile&) { std::memcpy(scratch.data(), bytes.data(), bytes.size()); }));
    print(terrain, measureTiles(
                       terrain, "codes, zstd 1", [](const HeightTile& tile) { return zstdCompress(codesOf(tile), 1); },
                       [&](const Bytes& bytes, const HeightTile&) {
                           if (!zstdDecompress(bytes, scratch))
                               throw Error(ExitCode::internal, "zstd does not come back");
                       }));
    print(terrain, measureTiles(terrain, "**Terray (planar, zigzag, zstd 1)**", encodeHeightTile,
                                [](const Bytes& bytes, const HeightTile& tile) {
                                    if (decodeHeightTile(bytes).value().codes != tile.codes)
                                        throw Error(ExitCode::internal, "a tile does not come back");
                                }));
}

/// A TIFF in memory, by GDAL.
void measureGdal(const Terrain& terrain, const std::string& name, const std::vector<std::string>& storage) {
    constexpr const char* kFile = "/vsimem/codec.tif";
    const auto width = static_cast<int>(terrain.heights.width());
    const auto height = static_cast<int>(terrain.heights.size().height);
    CPLStringList options;
    for (const char* option : {"TILED=YES", "BLOCKXSIZE=512", "BLOCKYSIZE=512"}) options.AddString(option);
    for (const std::string& option : storage) options.AddString(option.c_str());
    Grid<float> cells = terrain.heights;
    const double megabytes = 4e-6 * static_cast<double>(cells.size().count());
    GDALDriver& tiff = *GetGDALDriverManager()->GetDriverByName("GTiff");
    const auto pass = [&](GDALDataset& file, GDALRWFlag way) {
        if (file.GetRasterBand(1)->RasterIO(way, 0, 0, width, height, cells.cells().data(), width, height, GDT_Float32,
                                            0, 0, nullptr) != CE_None)
            throw Error(ExitCode::internal, "GDAL cannot " + std::string(way == GF_Write ? "write " : "read ") + name);
    };
    Row row{.codec = name};
    row.encodeRate =
        megabytes / leastSeconds([&] {
            const GDALDatasetUniquePtr file(tiff.Create(kFile, width, height, 1, GDT_Float32, options.List()));
            file->GetRasterBand(1)->SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
            pass(*file, GF_Write);
        });
    row.decodeRate = megabytes / leastSeconds([&] {
                         const GDALDatasetUniquePtr file(GDALDataset::Open(kFile));
                         pass(*file, GF_Read);
                     });
    VSIStatBufL status;
    TERRAY_CHECK_OP(VSIStatL(kFile, &status), ==, 0);
    row.bytesPerSample = static_cast<double>(status.st_size) / static_cast<double>(cells.size().count());
    VSIUnlink(kFile);
    print(terrain, row);
}

Grid<float> noise() {
    // Each sample between 0 and 100 m, independent of all others.
    Grid<float> heights({2048, 2048});
    std::mt19937 random(1);
    for (float& height : heights.cells()) height = static_cast<float>(random()) * (100.0f / 4294967296.0f);
    return heights;
}

Grid<float> readFile(const std::string& description) {
    std::vector<std::string> parts;
    std::istringstream text(description);
    for (std::string part; std::getline(text, part, ',');) parts.push_back(part);
    HeightSourceOptions options{.files = {parts.at(0)}};
    if (parts.size() > 1) options.spacing = std::stod(parts[1]);
    if (parts.size() > 2) options.heightScale = std::stod(parts[2]);
    const auto source = openGdalHeights(options);
    const GridSize size = source->info().size;
    Grid<float> heights(size);
    source->openReader()->read({0, 0, size.width, size.height}, heights.view());
    return heights;
}

void measure(const std::string& name, Grid<float> heights) {
    Terrain terrain{.name = name, .heights = std::move(heights), .tiles = {}};
    terrain.tiles = tilesOf(terrain.heights);
    measureOwn(terrain);
    measureGdal(terrain, "GDAL ZSTD 1, PREDICTOR=3 (floats, exact)", {"COMPRESS=ZSTD", "ZSTD_LEVEL=1", "PREDICTOR=3"});
    measureGdal(terrain, "GDAL ZSTD 9, PREDICTOR=3 (floats, exact)", {"COMPRESS=ZSTD", "ZSTD_LEVEL=9", "PREDICTOR=3"});
    measureGdal(terrain, "GDAL LERC, 5 mm", {"COMPRESS=LERC", "MAX_Z_ERROR=0.005"});
    measureGdal(terrain, "GDAL LERC_ZSTD 1, 5 mm", {"COMPRESS=LERC_ZSTD", "ZSTD_LEVEL=1", "MAX_Z_ERROR=0.005"});
}

}  // namespace
}  // namespace terray::bench

int main(int count, char** arguments) {
    using namespace terray::bench;
    GDALAllRegister();
    std::printf("| heights | codec | bytes a sample | encode, MB/s | decode, MB/s |\n|---|---|---|---|---|\n");
    const int code = measureFiles("height_codec_rates", count, arguments,
                                  [](const auto& name, const auto& file) { measure(name, readFile(file)); });
    if (code == 0) measure("noise, 0 to 100 m", noise());
    return code;
}
