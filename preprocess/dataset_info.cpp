#include "preprocess/dataset_info.h"

#include <iomanip>
#include <sstream>

#include "common/error.h"
#include "preprocess/progress.h"

namespace terray {
namespace {

ArchiveInfo inspectArchive(const PmtilesReader& archive, uint32_t finestLevel) {
    ArchiveInfo info;
    info.fileBytes = archive.source().size();
    info.levels.resize(finestLevel + 1);
    const auto listed = archive.forEach([&](const TileId& id, uint64_t, uint32_t length) {
        if (id.level > finestLevel) return;  // verify tells of it
        ++info.levels[id.level].tiles;
        info.levels[id.level].bytes += length;
    });
    if (!listed.ok()) throw Error(ExitCode::dataset, listed.failure().message);
    return info;
}

double ratio(uint64_t tiles, uint64_t bytesPerCell, uint64_t stored) {
    if (stored == 0) return 0;
    return static_cast<double>(tiles * kTileCore * kTileCore * bytesPerCell) / static_cast<double>(stored);
}

Json toJson(const ArchiveInfo& archive) {
    Json::Array levels;
    for (const LevelInfo& level : archive.levels)
        levels.emplace_back(Json::Object{{"tiles", level.tiles}, {"bytes", level.bytes}});
    return Json::Object{{"fileBytes", archive.fileBytes}, {"levels", levels}};
}

void printHeights(std::ostream& out, const DatasetInfo& info) {
    const DatasetMetadata& metadata = info.metadata;
    out << "heights    " << metadata.samples.width << " x " << metadata.samples.height << " samples, "
        << readableNumber(metadata.tiling.finestSpacing) << " m apart; " << readableNumber(metadata.minHeight) << " to "
        << readableNumber(metadata.maxHeight) << " m in steps of " << readableNumber(metadata.quantum) << " m; "
        << metadata.holeSamples << " holes (datum " << metadata.verticalDatum << ")\n           off by at most "
        << readableNumber(metadata.levelErrors.back()) << " m, measured; bound " << readableNumber(metadata.errorBound)
        << " m\n";
    if (!metadata.errorsHoldEverywhere)
        out << "           errors below hold at samples, not between them: an older build measured them\n";
    out << "           " << info.heights.tiles() << " tiles, file " << readableBytes(info.heights.fileBytes)
        << ", compressed " << readableNumber(info.heightCompression()) << " times from 16 bits\n";
    for (size_t level = 0; level < info.heights.levels.size(); ++level)
        out << "  level " << std::setw(2) << level << ": " << std::setw(8) << info.heights.levels[level].tiles
            << " tiles, spacing " << readableNumber(metadata.tiling.spacing(static_cast<uint32_t>(level)))
            << " m, error " << readableNumber(metadata.levelErrors[level]) << " m\n";
}

void printImagery(std::ostream& out, const DatasetInfo& info) {
    if (!info.imagery) {
        out << "imagery    none\n";
        return;
    }
    const uint32_t level = *info.metadata.imageryLevel;
    out << "imagery    to level " << level << ", texels of " << readableNumber(info.metadata.tiling.spacing(level))
        << " m\n           " << info.imagery->tiles() << " tiles, file " << readableBytes(info.imagery->fileBytes)
        << ", compressed " << readableNumber(info.imageryCompression()) << " times from 24 bits\n";
}

void printGround(std::ostream& out, const DatasetMetadata& metadata) {
    const GroundRect ground = metadata.groundBounds();
    out << "system     " << (metadata.crsWkt.empty() ? "none (a plain image)" : metadata.crsName) << "\n";
    out << std::fixed << std::setprecision(2) << "extent     west " << ground.west << ", south " << ground.south
        << ", east " << ground.east << ", north " << ground.north << " m\n";
    if (metadata.lonLatBounds) {
        const GroundRect& degrees = *metadata.lonLatBounds;
        out << std::setprecision(6) << "           west " << degrees.west << ", south " << degrees.south << ", east "
            << degrees.east << ", north " << degrees.north << " degrees\n";
    }
    out << std::defaultfloat;
}

}  // namespace

uint64_t ArchiveInfo::tiles() const {
    uint64_t sum = 0;
    for (const LevelInfo& level : levels) sum += level.tiles;
    return sum;
}

uint64_t ArchiveInfo::tileBytes() const {
    uint64_t sum = 0;
    for (const LevelInfo& level : levels) sum += level.bytes;
    return sum;
}

double DatasetInfo::heightCompression() const {
    return ratio(heights.tiles(), 2, heights.tileBytes());
}

double DatasetInfo::imageryCompression() const {
    return imagery ? ratio(imagery->tiles(), 3, imagery->tileBytes()) : 0;
}

DatasetInfo inspectDataset(const DatasetArchives& dataset) {
    DatasetInfo info;
    info.directory = dataset.directory.string();
    info.metadata = dataset.metadata;
    info.heights = inspectArchive(dataset.heights, dataset.metadata.tiling.finestLevel);
    if (dataset.imagery) info.imagery = inspectArchive(*dataset.imagery, *dataset.metadata.imageryLevel);
    return info;
}

Json toJson(const DatasetInfo& info) {
    Json json = Json::Object{{"directory", info.directory}, {"metadata", toJson(info.metadata)}};
    json.set("heights", toJson(info.heights));
    json.set("heightCompression", info.heightCompression());
    if (info.imagery) {
        json.set("imagery", toJson(*info.imagery));
        json.set("imageryCompression", info.imageryCompression());
    }
    return json;
}

std::string toText(const DatasetInfo& info) {
    std::ostringstream out;
    out << "dataset    " << info.directory << " (" << info.metadata.tool << ", " << info.metadata.options << ")\n";
    printGround(out, info.metadata);
    printHeights(out, info);
    printImagery(out, info);
    for (const SourceFile& source : info.metadata.sources)
        out << "source     " << source.path << ", " << readableBytes(source.bytes) << "\n";
    return out.str();
}

}  // namespace terray
