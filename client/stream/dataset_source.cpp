#include "client/stream/dataset_source.h"

#include <string>
#include <utility>

#include "client/stream/archived_dataset.h"
#include "client/stream/tile_reads.h"
#include "common/error.h"

namespace terray {
namespace {

constexpr const char* kRemedy = "give the directory that terray-preprocess build wrote";

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& found) {
    throw Error(ExitCode::dataset, "cannot open dataset " + path.string() + ": " + found);
}

class LocalDataset final : public TileSource {
  public:
    explicit LocalDataset(const std::filesystem::path& directory)
        : archives_({.name = directory.string(),
                     .open = [&](const char* file) { return openFileSource(directory / file); },
                     .remedy = kRemedy}) {}

    const DatasetMetadata& metadata() const override { return archives_.metadata(); }
    Result<Bytes> read(TileLayer layer, const TileId& id) const override { return archives_.read(layer, id); }
    std::string contentHash() const override { return archives_.contentHash(); }

  private:
    ArchivedDataset archives_;
};

}  // namespace

std::unique_ptr<TileReads> TileSource::startReads() const {
    return readOneByOne(*this);
}

std::unique_ptr<TileSource> openLocalDataset(const std::filesystem::path& directory) {
    if (!std::filesystem::is_directory(directory)) fail(directory, std::string("no such directory; ") + kRemedy);
    auto dataset = std::make_unique<LocalDataset>(directory);
    const auto imagery = directory / kImageryFile;
    if (!dataset->metadata().imageryLevel && std::filesystem::exists(imagery))
        fail(imagery, std::string("the metadata of ") + kHeightsFile +
                          " knows no imagery; remove the file, or rebuild the dataset with terray-preprocess build "
                          "--force");
    return dataset;
}

}  // namespace terray
