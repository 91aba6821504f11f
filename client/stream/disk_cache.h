#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

#include "common/pmtiles.h"

namespace terray {

struct DiskCacheOptions {
    std::filesystem::path directory;  ///< made when it is not there; empty: no cache
    uint64_t maxBytes = 4ull << 30;   ///< of the files in it
};

struct DiskCacheStatistics {
    uint64_t hits = 0;
    uint64_t hitBytes = 0;
    uint64_t written = 0;
    uint64_t failures = 0;  ///< ranges that could not be written, as on a full disk; they are fetched again when wanted
};

/// Ranges of remote archives, kept in files from one run to the next.
///
/// Any number of processes may use a directory at once, and any may be killed at any moment: a range is written under a
/// temporary name and renamed, and its checksum is looked at when it is read, so that what is damaged or half written
/// counts as not held. Once the files take more than maxBytes, those that were used longest ago go (by their time of
/// change, which a hit sets anew at most once a minute) until a tenth is free. A process looks at what others have
/// written after each sixteenth of maxBytes that it writes: by so much for each further process may the files exceed
/// maxBytes. All threads.
class DiskCache {
  public:
    /// Throws Error(output) when the directory cannot be made or written into.
    explicit DiskCache(DiskCacheOptions options);

    /// @param archive  names the archive and its version: another version's ranges are not found
    [[nodiscard]] std::optional<Bytes> read(const std::string& archive, const ByteRange& range);
    /// Keeps a range, replacing what is there. Ranges of more than a quarter of maxBytes are not kept.
    void write(const std::string& archive, const ByteRange& range, ByteView bytes);

    [[nodiscard]] DiskCacheStatistics statistics() const;

  private:
    void makeRoomFor(uint64_t bytes);
    void evict(uint64_t mostBytes);

    const DiskCacheOptions options_;
    mutable std::mutex mutex_;
    uint64_t heldBytes_ = 0;     ///< as of the last look at the directory, and what was written since
    uint64_t writtenBytes_ = 0;  ///< since that look
    uint64_t temporaryNames_ = 0;
    DiskCacheStatistics count_;
};

}  // namespace terray
