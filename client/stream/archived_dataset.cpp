#include "client/stream/archived_dataset.h"

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

[[noreturn]] void fail(const std::string& name, const std::string& found) {
    throw Error(ExitCode::dataset, "cannot open dataset " + name + ": " + found);
}

PmtilesReader openArchive(const ArchivedDataset::Place& place, const char* file) {
    auto source = place.open(file);
    if (!source) fail(place.name, source.failure().message + "; " + place.remedy);
    auto reader = PmtilesReader::open(std::move(*source));
    if (!reader) fail(place.name, reader.failure().message + "; " + kRebuild + ", or copy it again");
    return std::move(*reader);
}

std::string metadataText(const PmtilesReader& archive) {
    auto text = archive.metadata();
    if (!text) fail(archive.source().name(), text.failure().message + "; " + kRebuild);
    return std::move(*text);
}

DatasetMetadata parseMetadata(const std::string& text, const std::string& name) {
    const auto json = Json::parse(text);
    if (!json)
        fail(name, "its metadata is no JSON (" + json.failure().message + "); it is not a Terray dataset or damaged");
    auto metadata = metadataFromJson(*json);
    if (!metadata) fail(name, metadata.failure().message);
    return std::move(*metadata);
}

/// What an archive's header must say, given the metadata.
struct Expected {
    uint32_t finestLevel = 0;
    uint64_t tiles = 0;
};

void checkHeader(const PmtilesReader& archive, const Expected& expected, const DatasetMetadata& metadata) {
    const PmtilesHeader& header = archive.header();
    const std::string path = archive.source().name();
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

}  // namespace

ArchivedDataset::ArchivedDataset(const Place& place) : ArchivedDataset(place, openArchive(place, kHeightsFile)) {}

ArchivedDataset::ArchivedDataset(const Place& place, PmtilesReader heights) : heights_(std::move(heights)) {
    const std::string text = metadataText(heights_);
    metadata_ = parseMetadata(text, heights_.source().name());
    checkHeader(heights_, {metadata_.tiling.finestLevel, metadata_.heightTiles}, metadata_);
    if (!metadata_.imageryLevel) return;
    imagery_ = openArchive(place, kImageryFile);
    if (metadataText(*imagery_) != text)
        fail(imagery_->source().name(), std::string("its metadata differs from that of ") + kHeightsFile +
                                            ", so the two were not built together; " + kRebuild);
    checkHeader(*imagery_, {*metadata_.imageryLevel, metadata_.imageryTiles}, metadata_);
}

const PmtilesReader* ArchivedDataset::archive(TileLayer layer) const {
    if (layer == TileLayer::heights) return &heights_;
    return imagery_ ? &*imagery_ : nullptr;
}

Result<Bytes> ArchivedDataset::read(TileLayer layer, const TileId& id) const {
    const PmtilesReader* archived = archive(layer);
    if (archived == nullptr) return Failure{"the dataset has no imagery"};
    auto found = archived->read(id);
    if (!found) return found.failure();
    if (!*found) return missing(*archived, id);
    return std::move(**found);
}

Failure ArchivedDataset::missing(const PmtilesReader& archive, const TileId& id) {
    return {archive.source().name() + " has no tile " + toString(id) + ", which its parent says exists; " + kRebuild};
}

std::string ArchivedDataset::contentHash() const {
    std::string hash = hexadecimal(archiveChecksum(heights_));
    if (imagery_) hash += "-" + hexadecimal(archiveChecksum(*imagery_));
    return hash;
}

}  // namespace terray
