#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "common/bytes.h"

namespace terray {

/// A file that several threads write and read at chosen places while a build goes on, and that a later run can take up.
///
/// Throws Error(output) naming the file, what was tried, and the system's reason (no space left, file too large, ...).
class WorkFile {
  public:
    /// Opens the file as it is, or creates it empty.
    explicit WorkFile(std::filesystem::path path);
    /// Closes it; it stays on the disk.
    ~WorkFile();
    WorkFile(const WorkFile&) = delete;
    WorkFile& operator=(const WorkFile&) = delete;

    void write(uint64_t offset, ByteView bytes);
    /// All of `bytes` is filled; reading what was never written is an error, save in gaps (zeros).
    void read(uint64_t offset, std::span<std::byte> bytes) const;
    /// Returns once all that was written so far survives a power cut.
    void sync();
    /// Sees what other machines have synced: a network file system may keep an open file as it was when it was opened.
    void reopen();
    [[nodiscard]] uint64_t size() const;
    /// Cuts the file off after `bytes`.
    void truncate(uint64_t bytes);
    /// Takes the file off the disk; nothing may be written or read after it.
    void discard();

  private:
    std::filesystem::path path_;
    int descriptor_;
};

}  // namespace terray
