// Writes what fuzzing starts from, a file for each input, into DIR/archive, DIR/metadata, DIR/height_tile and
// DIR/imagery_tile: the smallest inputs that the writers make of each kind. usage: terray_fuzz_seeds DIR
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "common/dataset_metadata.h"
#include "common/height_tile.h"
#include "common/imagery_tile.h"
#include "common/pmtiles.h"
#include "tests/fuzz/sealed_payload.h"

namespace terray::fuzz {
namespace {

constexpr GridSize kSide{kHeightTileSide, kHeightTileSide};

void writeFile(const std::filesystem::path& path, ByteView bytes) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void writeText(const std::filesystem::path& path, std::string_view text) {
    writeFile(path, std::as_bytes(std::span(text)));
}

/// An archive of all tiles to level 2 but one, each of one or two bytes; every fourth has those of the one before.
void writeArchive(const std::filesystem::path& path, const PmtilesWriteOptions& options, const std::string& metadata) {
    std::filesystem::create_directories(path.parent_path());
    PmtilesWriter writer(path, options);
    for (uint64_t tile = 0; tile < 21; ++tile) {
        const std::string bytes(1 + tile % 2, static_cast<char>('a' + tile - (tile % 4 == 3 ? 2 : 0)));
        if (tile != 12) writer.add(tileFromHilbert(tile).value(), std::as_bytes(std::span(bytes)));
    }
    writer.finish(metadata, {.maxZoom = 2});
}

void writeArchives(const std::filesystem::path& directory) {
    const PmtilesWriteOptions leaves{.maxRootBytes = 40, .leafEntries = 3};
    PmtilesWriteOptions packed = leaves;
    packed.internalCompression = PmtilesCompression::gzip;
    writeArchive(directory / "plain", {}, "{}");
    writeArchive(directory / "leaves", leaves, "{\"format\": 1}");
    writeArchive(directory / "packed", packed, "{}");
    writeArchive(directory / "packed_zeros", packed, std::string(size_t{1} << 20, '0'));
}

DatasetMetadata smallMetadata() {
    DatasetMetadata metadata;
    metadata.tiling = {.west = 500000.5, .north = 5.2e6, .finestSpacing = 0.25, .finestLevel = 1};
    metadata.samples = {1000, 700};
    metadata.imageryLevel = 2;
    metadata.imageryBounds = GroundRect{500010, 5.1e6, 500100, 5.2e6};
    metadata.crsName = "EPSG:32632";
    metadata.crsWkt = "PROJCRS[\"WGS 84 / UTM \u00e9\"]";
    metadata.lonLatBounds = GroundRect{179.5, -46.5, -179.5, -46};
    metadata.minHeight = -10994;
    metadata.maxHeight = 8848.86F;
    metadata.levelErrors = {8.5, 0.005};
    metadata.errorBound = 0.005;
    metadata.sources = {{"a.tif", 1, -1}, {"b\t\"\\.vrt", uint64_t{1} << 53, 1700000000}};
    return metadata;
}

void writeMetadata(const std::filesystem::path& directory) {
    writeText(directory / "small", toJson(smallMetadata()).dump(0));
    writeText(directory / "plain_image", toJson(DatasetMetadata{.samples = {1, 1}, .levelErrors = {0}}).dump());
    writeText(directory / "other_format", R"({"format": 2})");
    writeText(directory / "values",
              R"([0, -0.5e-3, 1E+300, true, false, null, "\u00e9\ud83d\ude00\n", {"a": [[{}]]}])");
}

template <class CodeOf>
HeightTile tileOf(const TileId& id, CodeOf codeOf) {
    HeightTile tile{.id = id, .codes = Grid<uint16_t>(kSide)};
    for (int64_t y = 0; y < kSide.height; ++y)
        for (int64_t x = 0; x < kSide.width; ++x) tile.codes.at(x, y) = codeOf(x, y);
    tile.record = measureRecord(tile.codes, tile.encoding, 0.5F);
    return tile;
}

void writeHeightTiles(const std::filesystem::path& directory) {
    const auto slope = [](int64_t x, int64_t y) { return static_cast<uint16_t>(1 + 3 * x + 2 * y); };
    const auto quarter = [](int64_t x, int64_t y) { return static_cast<uint16_t>(x < 256 && y < 256 ? 0 : 700); };
    writeFile(directory / "slope", encodeHeightTile(tileOf({}, slope)));
    HeightTile holes = tileOf({3, 7, 0}, quarter);
    holes.children = {HeightRecord{true, false, 1, 2, 0}, HeightRecord{}, HeightRecord{true, true, -3, 4, 5}, {}};
    writeFile(directory / "holes", encodeHeightTile(holes));
    writeFile(directory / "empty", encodeHeightTile(tileOf({1, 0, 1}, [](int64_t, int64_t) { return kNoSurface; })));
    writeText(directory / "residuals", std::string("\x00\x01\x80\xff\x02", 5));
    writeText(directory / "residuals_and_holes", std::string("\xff\x0f\x7f\xfe\x01\x33", 6));
}

void writeImageryTiles(const std::filesystem::path& directory) {
    const auto block = std::as_bytes(std::span("\x12\x34\x56\x78\xe4\x1b\x00\xff", kBc1BlockBytes));
    writeFile(directory / "root", encodeImageryTile({.childExists = {true, false, true, true},
                                                     .mips = kImageryMips,
                                                     .blocks = repeated(block, imageryChainBytes())}));
    writeFile(directory / "tile", encodeImageryTile({.id = {2, 1, 3}, .blocks = repeated(block, imageryMipBytes(0))}));
    writeText(directory / "blocks", "three bytes more");
    writeFile(directory / "blocks_of_root", block.subspan(4, 3));
}

}  // namespace
}  // namespace terray::fuzz

int main(int count, char** arguments) {
    if (count != 2) return 2;
    const std::filesystem::path directory = arguments[1];
    terray::fuzz::writeArchives(directory / "archive");
    terray::fuzz::writeMetadata(directory / "metadata");
    terray::fuzz::writeHeightTiles(directory / "height_tile");
    terray::fuzz::writeImageryTiles(directory / "imagery_tile");
    return 0;
}
