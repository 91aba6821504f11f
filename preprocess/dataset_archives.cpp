#include "preprocess/dataset_archives.h"

#include <string>

#include "common/error.h"
#include "common/tile_payload.h"

namespace terray {
namespace {

[[noreturn]] void fail(const std::filesystem::path& directory, const std::string& reason) {
    throw Error(ExitCode::dataset, "cannot open dataset " + directory.string() + ": " + reason);
}

PmtilesReader openArchive(const std::filesystem::path& directory, const char* name) {
    auto source = openFileSource(directory / name);
    if (!source.ok()) fail(directory, source.failure().message);
    auto reader = PmtilesReader::open(std::move(source).value());
    if (!reader.ok()) fail(directory, reader.failure().message);
    // A payload carries its own id, so tiles share no bytes; a run of 2^32 tiles over one payload would fill any
    // memory.
    const PmtilesHeader& header = reader->header();
    constexpr uint64_t kLeastPayloadBytes = kPayloadPrefixBytes + kPayloadSealBytes;
    if (header.addressedTiles == 0 || header.addressedTiles > header.tilesLength / kLeastPayloadBytes)
        fail(directory, std::string(name) + " counts " + std::to_string(header.addressedTiles) + " tiles in " +
                            std::to_string(header.tilesLength) + " bytes, which cannot be");
    return std::move(reader).value();
}

DatasetMetadata readMetadata(const std::filesystem::path& directory, const PmtilesReader& archive) {
    const auto text = archive.metadata();
    if (!text.ok()) fail(directory, text.failure().message);
    const auto json = Json::parse(*text);
    if (!json.ok()) fail(directory, "the metadata is damaged: " + json.failure().message);
    auto metadata = metadataFromJson(*json);
    if (!metadata.ok()) fail(directory, metadata.failure().message);
    return std::move(metadata).value();
}

}  // namespace

DatasetArchives openDataset(const std::filesystem::path& directory) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(directory, ignored)) fail(directory, "there is no such directory");
    if (!std::filesystem::exists(directory / kHeightsFile, ignored))
        fail(directory, "it holds no " + std::string(kHeightsFile) + ", so it is not a Terray dataset");

    PmtilesReader heights = openArchive(directory, kHeightsFile);
    DatasetArchives dataset{directory, readMetadata(directory, heights), std::move(heights), {}};
    const bool hasImagery = std::filesystem::exists(directory / kImageryFile, ignored);
    if (hasImagery != dataset.metadata.imageryLevel.has_value())
        fail(directory, hasImagery ? "it holds an imagery.pmtiles that its heights know nothing of"
                                   : "its imagery.pmtiles is missing");
    if (hasImagery) {
        dataset.imagery = openArchive(directory, kImageryFile);
        if (readMetadata(directory, *dataset.imagery) != dataset.metadata)
            fail(directory, "its heights and its imagery come from different builds: their metadata differ");
    }
    return dataset;
}

}  // namespace terray
