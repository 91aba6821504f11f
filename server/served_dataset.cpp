#include "server/served_dataset.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <utility>

#include <sys/stat.h>

#include "common/checksum.h"
#include "common/json.h"

namespace terray::server {
namespace {

constexpr const char* kRebuild = "rebuild the dataset with terray-preprocess build --force, or copy it again";

uint64_t fnv1a(std::string_view text) {
    uint64_t hash = 0xcbf29ce484222325ULL;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    return hash;
}

std::string hexadecimal(uint64_t value) {
    std::array<char, 17> text{};
    std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
    return text.data();
}

/// CRC-32C of a stretch of a file, read in pieces.
Result<uint32_t> checksumOf(const ByteSource& source, ByteRange range) {
    constexpr uint64_t kPiece = 1 << 20;
    uint32_t checksum = 0;
    for (uint64_t done = 0; done < range.length; done += kPiece) {
        const auto bytes = source.read(range.offset + done, std::min(kPiece, range.length - done));
        if (!bytes) return bytes.failure();
        checksum = crc32c(*bytes, checksum);
    }
    return checksum;
}

/// The hash behind ServedArchive::version(). Contents of tiles are not read, an archive may have terabytes: two builds
/// whose tiles differ only in bytes, not in sizes, differ by the time of modification.
Result<uint64_t> versionOf(const PmtilesReader& reader, int descriptor) {
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) return Failure{"cannot ask for the size of " + reader.source().name()};
    std::string text = std::to_string(status.st_size) + " " + std::to_string(status.st_mtim.tv_sec) + " " +
                       std::to_string(status.st_mtim.tv_nsec);
    const PmtilesHeader& header = reader.header();
    for (const ByteRange range : {ByteRange{0, kPmtilesHeaderBytes}, ByteRange{header.rootOffset, header.rootLength},
                                  ByteRange{header.metadataOffset, header.metadataLength},
                                  ByteRange{header.leavesOffset, header.leavesLength}}) {
        const auto checksum = checksumOf(reader.source(), range);
        if (!checksum) return checksum.failure();
        text += " " + std::to_string(*checksum);
    }
    return fnv1a(text);
}

Result<DatasetMetadata> readMetadata(const ServedArchive& archive) {
    const auto text = archive.reader().metadata();
    if (!text) return text.failure();
    const auto json = Json::parse(*text);
    if (!json) return Failure{"its metadata is no JSON (" + json.failure().message + "): not a Terray dataset"};
    return metadataFromJson(*json);
}

/// Whether an archive's header agrees with the dataset's metadata.
Result<void> checkHeader(const ServedArchive& archive, uint32_t finestLevel) {
    if (archive.finestLevel() == finestLevel) return {};
    return Failure{archive.reader().source().name() + " ends at level " + std::to_string(archive.finestLevel()) +
                   ", its metadata says " + std::to_string(finestLevel)};
}

/// One layer in metadata.json: addresses are relative to it, so that they hold behind any proxy.
Json layerJson(const std::string& layer, const ServedArchive& archive, const std::string& version) {
    Json json;
    json.set("minzoom", 0);
    json.set("maxzoom", archive.finestLevel());
    json.set("tiles", Json::Array{layer + "/{z}/{x}/{y}?v=" + version});
    json.set("archive", layer + ".pmtiles?v=" + version);
    json.set("archiveBytes", archive.size());
    return json;
}

Json centreOf(const GroundRect& bounds) {
    const double east = bounds.east < bounds.west ? bounds.east + 360 : bounds.east;  // across the antimeridian
    double longitude = (bounds.west + east) / 2;
    if (longitude > 180) longitude -= 360;
    return Json::Array{longitude, (bounds.south + bounds.north) / 2, 0};
}

/// The dataset's metadata, whose members keep their names, then TileJSON 3.0.0's, then where each layer lies.
std::string metadataText(const ServedDataset& dataset) {
    Json json = toJson(dataset.metadata);
    json.set("tilejson", "3.0.0");
    json.set("name", dataset.name);
    json.set("scheme", "xyz");
    json.set("tiles", Json::Array{"heights/{z}/{x}/{y}?v=" + dataset.version});
    json.set("minzoom", 0);
    json.set("maxzoom", dataset.heights->finestLevel());
    if (const auto& bounds = dataset.metadata.lonLatBounds) {
        json.set("bounds", Json::Array{bounds->west, bounds->south, bounds->east, bounds->north});
        json.set("center", centreOf(*bounds));
    }
    Json layers;
    layers.set("heights", layerJson("heights", *dataset.heights, dataset.version));
    if (dataset.imagery) layers.set("imagery", layerJson("imagery", *dataset.imagery, dataset.version));
    json.set("datasetVersion", dataset.version);
    json.set("layers", std::move(layers));
    return json.dump() + "\n";
}

}  // namespace

std::string contentTag(std::string_view text) {
    return hexadecimal(fnv1a(text));
}

ServedArchive::ServedArchive(PmtilesReader reader, int descriptor, uint64_t version)
    : reader_(std::move(reader)), descriptor_(descriptor), version_(version) {
    static std::atomic<uint64_t> opened = 0;
    serial_ = ++opened;
}

Result<std::shared_ptr<const ServedArchive>> ServedArchive::open(const std::filesystem::path& path) {
    auto file = openFileSource(path);
    return file ? open(*std::move(file)) : file.failure();
}

Result<std::shared_ptr<const ServedArchive>> ServedArchive::open(std::unique_ptr<ByteSource> source) {
    auto reader = PmtilesReader::open(std::move(source));
    if (!reader) return Failure{reader.failure().message + "; " + kRebuild};
    const auto descriptor = reader->source().descriptor();
    TERRAY_CHECK(descriptor.has_value());
    const auto version = versionOf(*reader, *descriptor);
    if (!version) return version.failure();
    return std::shared_ptr<const ServedArchive>(new ServedArchive(*std::move(reader), *descriptor, *version));
}

Result<std::shared_ptr<const ServedDataset>> openServedDataset(const std::string& name,
                                                               const std::filesystem::path& directory) {
    const auto failed = [&](const std::string& found) {
        return Failure{"cannot serve \"" + name + "\" from " + directory.string() + ": " + found};
    };
    auto heights = ServedArchive::open(directory / kHeightsFile);
    if (!heights) return failed(heights.failure().message);
    auto dataset = std::make_shared<ServedDataset>();
    dataset->name = name;
    dataset->heights = *heights;
    auto metadata = readMetadata(*dataset->heights);
    if (!metadata) return failed(metadata.failure().message);
    dataset->metadata = *std::move(metadata);
    const auto check = checkHeader(*dataset->heights, dataset->metadata.tiling.finestLevel);
    if (!check) return failed(check.failure().message + "; " + kRebuild);

    if (const auto& level = dataset->metadata.imageryLevel) {
        auto imagery = ServedArchive::open(directory / kImageryFile);
        if (!imagery) return failed(imagery.failure().message);
        dataset->imagery = *imagery;
        const auto agrees = checkHeader(*dataset->imagery, *level);
        if (!agrees) return failed(agrees.failure().message + "; " + kRebuild);
    }
    dataset->version = hexadecimal(dataset->heights->version() * 0x9e3779b97f4a7c15ULL ^
                                   (dataset->imagery ? dataset->imagery->version() : 0));
    dataset->metadataJson = metadataText(*dataset);
    return std::shared_ptr<const ServedDataset>(std::move(dataset));
}

}  // namespace terray::server
