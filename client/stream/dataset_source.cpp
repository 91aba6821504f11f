#include "client/stream/dataset_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "common/checksum.h"
#include "common/error.h"

namespace terray {
namespace {

constexpr const char* kRebuild = "rebuild the dataset with terray-preprocess build --force";

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& found) {
    throw Error(ExitCode::dataset, "cannot open dataset " + path.string() + ": " + found);
}

PmtilesReader openArchive(const std::filesystem::path& path) {
    auto file = openFileSource(path);
    if (!file) fail(path, file.failure().message + "; give the directory that terray-preprocess build wrote");
    auto reader = PmtilesReader::open(std::move(*file));
    if (!reader) fail(path, reader.failure().message + "; " + kRebuild + ", or copy it again");
    return std::move(*reader);
}

std::string metadataText(const PmtilesReader& archive, const std::filesystem::path& path) {
    auto text = archive.metadata();
    if (!text) fail(path, text.failure().message + "; " + kRebuild);
    return std::move(*text);
}

DatasetMetadata parseMetadata(const std::string& text, const std::filesystem::path& path) {
    const auto json = Json::parse(text);
    if (!json)
        fail(path, "its metadata is no JSON (" + json.failure().message + "); it is not a Terray dataset or damaged");
    auto metadata = metadataFromJson(*json);
    if (!metadata) fail(path, metadata.failure().message);
    return std::move(*metadata);
}

/// What an archive's header must say, given the metadata.
struct Expected {
    uint32_t finestLevel = 0;
    uint64_t tiles = 0;
};

void checkHeader(const PmtilesHeader& header, const Expected& expected, const DatasetMetadata& metadata,
                 const std::filesystem::path& path) {
    const auto require = [&](const char* what, uint64_t found, uint64_t wanted) {
        if (found != wanted)
            fail(path, std::string("its header has ") + what + " " + std::to_string(found) + ", its metadata " +
                           std::to_string(wanted) + "; " + kRebuild);
    };
    require("tile type", header.tileType, 0);
    require("tile compression", static_cast<uint64_t>(header.tileCompression),
            static_cast<uint64_t>(PmtilesCompression::none));
    require("coarsest level", header.minZoom, 0);
    require("finest level", header.maxZoom, expected.finestLevel);
    require("tile count", header.addressedTiles, expected.tiles);
    if (!metadata.lonLatBounds) return;
    // The header stores steps of 1e-7 degrees.
    const GroundRect& bounds = *metadata.lonLatBounds;
    const double apart = std::max({std::abs(header.minLon - bounds.west), std::abs(header.minLat - bounds.south),
                                   std::abs(header.maxLon - bounds.east), std::abs(header.maxLat - bounds.north)});
    if (apart > 2e-7)
        fail(path, "the bounds in its header and in its metadata are " + std::to_string(apart) + " degrees apart; " +
                       kRebuild);
}

/// CRC-32C of everything in an archive before its tiles: header, root directory, metadata, leaf directories.
uint32_t archiveChecksum(const PmtilesReader& archive) {
    constexpr uint64_t kPiece = 1 << 20;
    const PmtilesHeader& header = archive.header();
    const std::array<std::pair<uint64_t, uint64_t>, 4> sections{{{0, kPmtilesHeaderBytes},
                                                                 {header.rootOffset, header.rootLength},
                                                                 {header.metadataOffset, header.metadataLength},
                                                                 {header.leavesOffset, header.leavesLength}}};
    uint32_t checksum = 0;
    for (const auto& [offset, length] : sections) {
        for (uint64_t done = 0; done < length; done += kPiece) {
            const auto bytes = archive.source().read(offset + done, std::min(kPiece, length - done));
            if (!bytes) fail(archive.source().name(), bytes.failure().message);
            checksum = crc32c(*bytes, checksum);
        }
    }
    return checksum;
}

std::string hexadecimal(uint32_t value) {
    std::array<char, 9> text{};
    std::snprintf(text.data(), text.size(), "%08x", value);
    return text.data();
}

class LocalDataset final : public TileSource {
  public:
    LocalDataset(DatasetMetadata metadata, PmtilesReader heights, std::optional<PmtilesReader> imagery)
        : metadata_(std::move(metadata)), heights_(std::move(heights)), imagery_(std::move(imagery)) {}

    const DatasetMetadata& metadata() const override { return metadata_; }

    Result<Bytes> read(TileLayer layer, const TileId& id) const override {
        if (layer == TileLayer::imagery && !imagery_) return Failure{"the dataset has no imagery"};
        const PmtilesReader& archive = layer == TileLayer::heights ? heights_ : *imagery_;
        auto found = archive.read(id);
        if (!found) return found.failure();
        if (!*found)
            return Failure{archive.source().name() + " has no tile " + toString(id) +
                           ", which its parent says exists; " + kRebuild};
        return std::move(**found);
    }

    std::string contentHash() const override {
        std::string hash = hexadecimal(archiveChecksum(heights_));
        if (imagery_) hash += "-" + hexadecimal(archiveChecksum(*imagery_));
        return hash;
    }

  private:
    DatasetMetadata metadata_;
    PmtilesReader heights_;
    std::optional<PmtilesReader> imagery_;
};

}  // namespace

std::unique_ptr<TileSource> openLocalDataset(const std::filesystem::path& directory) {
    if (!std::filesystem::is_directory(directory))
        fail(directory, "no such directory; give the directory that terray-preprocess build wrote");
    const auto heightsPath = directory / kHeightsFile;
    const auto imageryPath = directory / kImageryFile;
    PmtilesReader heights = openArchive(heightsPath);
    const std::string text = metadataText(heights, heightsPath);
    DatasetMetadata metadata = parseMetadata(text, heightsPath);
    checkHeader(heights.header(), {metadata.tiling.finestLevel, metadata.heightTiles}, metadata, heightsPath);

    std::optional<PmtilesReader> imagery;
    if (metadata.imageryLevel) {
        imagery = openArchive(imageryPath);
        if (metadataText(*imagery, imageryPath) != text)
            fail(imageryPath, std::string("its metadata differs from that of ") + kHeightsFile +
                                  ", so the two were not built together; " + kRebuild);
        checkHeader(imagery->header(), {*metadata.imageryLevel, metadata.imageryTiles}, metadata, imageryPath);
    } else if (std::filesystem::exists(imageryPath)) {
        fail(imageryPath,
             std::string("the metadata of ") + kHeightsFile + " knows no imagery; remove the file, or " + kRebuild);
    }
    return std::make_unique<LocalDataset>(std::move(metadata), std::move(heights), std::move(imagery));
}

}  // namespace terray
