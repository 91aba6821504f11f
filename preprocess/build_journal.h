#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

#include "common/bytes.h"
#include "preprocess/work_file.h"

namespace terray {

/// What a build has done, so that a killed one can be gone on with: an append-only file of entries.
///
/// The first entry, the heading, says what is being built; each other one tells of a whole block. An entry is there
/// only when the data that it tells of is: commit() forces the data to the disk first, then the entry. What a kill or a
/// power cut leaves half-written at the end fails its checksum and is cut off by the next run.
///
/// Entry: uint32 size, uint32 CRC-32C of the content, content (never empty). Throws Error(output) as WorkFile does.
class BuildJournal {
  public:
    enum class Access {
        write,  ///< creates it empty where it is not there; cuts off a last entry that is not whole
        follow  ///< reads what another process, perhaps on another machine, writes
    };
    explicit BuildJournal(const std::filesystem::path& path, Access access = Access::write);

    [[nodiscard]] bool empty() const { return end_ == 0; }
    /// Calls visit(place, content) for every entry in order, the heading (place 0) first.
    void forEach(const std::function<void(uint64_t place, ByteView content)>& visit) const;
    /// The content of the entry at a place that commit() or forEach() told. Thread-safe.
    [[nodiscard]] Bytes read(uint64_t place) const;

    /// Forces `data` to the disk, then appends an entry. Thread-safe; entries of several threads that come while the
    /// disk is busy go there together. After a failure every further call fails likewise.
    ///
    /// With no `data` the entry is appended only, safe from a kill at once and from a power cut with the next sync().
    /// @param data  the same files in all calls that may run at once
    /// @return      its place, above 0 except for the heading
    uint64_t commit(ByteView content, std::span<WorkFile* const> data);
    /// Forces all entries so far to the disk.
    void sync() { file_.sync(); }
    /// Access::follow: sees the entries that the other process has synced by now.
    void refresh();

  private:
    void findEnd();
    void writeBatch(std::unique_lock<std::mutex>& lock);

    WorkFile file_;
    uint64_t end_ = 0;  ///< of the last whole entry
    std::mutex mutex_;  ///< guards what follows
    std::condition_variable batchDone_;
    Bytes pending_;                       ///< framed entries that wait for the disk
    std::vector<WorkFile*> pendingData_;  ///< what has to be there before them
    uint64_t reserved_ = 0;               ///< end of the last pending entry
    bool writing_ = false;
    std::exception_ptr failure_;
};

}  // namespace terray
