#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "common/bytes.h"

namespace terray {

/// A temporary file that several threads write and read at chosen places; removed with this object.
///
/// Throws Error(output) naming the file, what was tried, and the system's reason (no space left, file too large, ...).
class WorkFile {
  public:
    /// Creates the file, empty.
    explicit WorkFile(std::filesystem::path path);
    ~WorkFile();
    WorkFile(const WorkFile&) = delete;
    WorkFile& operator=(const WorkFile&) = delete;

    void write(uint64_t offset, ByteView bytes);
    /// All of `bytes` is filled; reading what was never written is an error, save in gaps (zeros).
    void read(uint64_t offset, std::span<std::byte> bytes) const;

  private:
    std::filesystem::path path_;
    int descriptor_;
};

}  // namespace terray
