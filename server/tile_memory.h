#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "common/bytes.h"

namespace terray::server {

class KeptTile;

/// Bytes of tiles in memory, as a file that has no name and lies on no disk, so that sendfile can send them without
/// copying. Thread-safe. The system counts it as shared memory.
class TileMemory {
  public:
    /// Throws Error(internal) when the system has no such files.
    TileMemory();
    ~TileMemory();
    TileMemory(const TileMemory&) = delete;
    TileMemory& operator=(const TileMemory&) = delete;

    /// Bytes of memory that so many bytes of a tile take: whole pages.
    [[nodiscard]] static uint64_t roomFor(uint64_t size);
    /// Copies a tile into memory. @return null: there is none left
    [[nodiscard]] static std::shared_ptr<const KeptTile> keep(const std::shared_ptr<TileMemory>& memory, ByteView tile);

  private:
    friend class KeptTile;
    int descriptor_;
    std::atomic<uint64_t> end_ = 0;  ///< only grows: places are never used again, their pages are given back
};

/// A tile in memory, for as long as someone holds it. Bytes that the kernel was given to send stay, too.
class KeptTile {
  public:
    KeptTile(std::shared_ptr<TileMemory> memory, uint64_t offset, size_t size);
    ~KeptTile();
    KeptTile(const KeptTile&) = delete;
    KeptTile& operator=(const KeptTile&) = delete;

    /// For sendfile.
    [[nodiscard]] int descriptor() const { return memory_->descriptor_; }
    [[nodiscard]] uint64_t offset() const { return offset_; }
    [[nodiscard]] size_t size() const { return size_; }

  private:
    std::shared_ptr<TileMemory> memory_;
    uint64_t offset_;
    size_t size_;
};

}  // namespace terray::server
