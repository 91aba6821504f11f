#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "common/dataset_metadata.h"
#include "common/pmtiles.h"
#include "common/result.h"

namespace terray::server {

/// An archive that stays open while it is served: replaced on disk by another, it goes on giving its own bytes.
class ServedArchive {
  public:
    [[nodiscard]] static Result<std::shared_ptr<const ServedArchive>> open(const std::filesystem::path& path);
    /// The same from a source that has a descriptor().
    [[nodiscard]] static Result<std::shared_ptr<const ServedArchive>> open(std::unique_ptr<ByteSource> source);

    [[nodiscard]] const PmtilesReader& reader() const { return reader_; }
    [[nodiscard]] uint64_t size() const { return reader_.source().size(); }
    /// For sendfile.
    [[nodiscard]] int descriptor() const { return descriptor_; }
    /// Differs between archives that differ: hash of size, time of modification, header, directories and metadata.
    [[nodiscard]] uint64_t version() const { return version_; }
    /// Differs between any two that this process ever opened.
    [[nodiscard]] uint64_t serial() const { return serial_; }
    [[nodiscard]] uint32_t finestLevel() const { return reader_.header().maxZoom; }

  private:
    ServedArchive(PmtilesReader reader, int descriptor, uint64_t version);

    PmtilesReader reader_;
    int descriptor_;
    uint64_t version_;
    uint64_t serial_;
};

/// A dataset as it was when it was opened. Never changes: a reload makes another.
struct ServedDataset {
    std::string name;     ///< in URLs
    std::string version;  ///< 16 hexadecimal digits, of both archives; the value of ?v=
    DatasetMetadata metadata;
    std::shared_ptr<const ServedArchive> heights;
    std::shared_ptr<const ServedArchive> imagery;  ///< none: the dataset has no photos
    std::string metadataJson;                      ///< body of metadata.json
};

/// Opens a dataset directory. A failure says which dataset cannot be served, why, and what to do.
[[nodiscard]] Result<std::shared_ptr<const ServedDataset>> openServedDataset(const std::string& name,
                                                                             const std::filesystem::path& directory);

/// FNV-1a over some text, as 16 hexadecimal digits: tells versions apart, keeps nobody from forging one.
[[nodiscard]] std::string contentTag(std::string_view text);

}  // namespace terray::server
