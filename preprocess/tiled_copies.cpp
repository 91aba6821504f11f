#include "preprocess/tiled_copies.h"

#include "common/error.h"
#include "common/parallel.h"
#include "preprocess/raster_files.h"
#include "preprocess/work_file.h"

namespace terray {

namespace {

constexpr uint64_t kCopiedPixelBytes = 4;  // a float, or red, green, blue and alpha
/// Blocks of a build are 1024 to 4096 cells wide, so narrower rows are not read much oftener than tiles would be.
constexpr int64_t kNarrow = 2048;

bool isStoredInWideRows(const gdal::RasterFacts& facts, uint64_t cacheBytes) {
    const auto unpacked = static_cast<uint64_t>(facts.size.count()) * facts.pixelBytes;
    return facts.block.width >= kNarrow && facts.block.width > facts.block.height && unpacked > cacheBytes / 2;
}

}  // namespace

bool isStoredInWideRows(const std::string& file, uint64_t cacheBytes) {
    try {
        return isStoredInWideRows(gdal::inspect(file), cacheBytes);
    } catch (const Error&) {
        return false;  // another library may read it
    }
}

std::string TiledCopies::nameOf(const gdal::VirtualRaster& derived, const gdal::RasterFacts& facts) {
    if (!isStoredInWideRows(facts, cacheBytes_)) return derived.name();
    copies_.push_back({derived, gdal::translate(derived.name(), {}), facts.name, facts.size});
    return copies_.back().alias.name();
}

uint64_t TiledCopies::bytes() const {
    uint64_t bytes = 0;
    for (const Copy& copy : copies_) bytes += static_cast<uint64_t>(copy.size.count()) * kCopiedPixelBytes;
    return bytes;
}

void TiledCopies::prepare(const SourceWorkspace& workspace) const {
    for (size_t i = 0; i < copies_.size(); ++i) {
        const std::filesystem::path file = workspace.directory / ("copy-" + std::to_string(i) + ".tif");
        // What has its final name is whole: an earlier run of this build made it.
        if (!std::filesystem::exists(file)) make(copies_[i], file, workspace);
        gdal::describeAnew(copies_[i].alias, file.string(), {});
    }
}

void TiledCopies::make(const Copy& copy, const std::filesystem::path& file, const SourceWorkspace& workspace) const {
    const auto step = gdal::rowsOfCopy(copy.size);
    workspace.partBegins("cutting " + std::filesystem::path(copy.label).filename().string() + " into tiles",
                         static_cast<uint64_t>((copy.size.height + step - 1) / step));
    std::filesystem::path unfinished = file;
    unfinished += ".unfinished";
    gdal::copyInTiles(copy.original.name(), copy.label, unfinished.string(), [&] {
        throwIfStopped(workspace.stop);
        workspace.stepDone();
    });
    WorkFile(unfinished).sync();
    std::filesystem::rename(unfinished, file);
}

}  // namespace terray
