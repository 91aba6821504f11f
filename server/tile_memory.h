#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>

#include "common/bytes.h"

namespace terray::server {

/// Pages of the process's own, of the small size: where large ones are sent, both ends of a connection fight over the
/// one counter of their users.
class PageBlock {
  public:
    /// Takes no memory until pages are written. @return null: the system gives no more
    [[nodiscard]] static std::shared_ptr<PageBlock> make(size_t size);
    ~PageBlock();
    PageBlock(const PageBlock&) = delete;
    PageBlock& operator=(const PageBlock&) = delete;

    [[nodiscard]] std::span<std::byte> bytes() const { return bytes_; }

  private:
    explicit PageBlock(std::span<std::byte> bytes) : bytes_(bytes) {}
    std::span<std::byte> bytes_;
};

/// A tile in memory, for as long as someone holds it. Its pages can be sent without copying (PageSender): those that
/// are on their way when it goes belong to the socket then, and nobody writes to them.
class KeptTile {
  public:
    /// @param bytes  begin with a page of the block, and have their last page for themselves
    KeptTile(std::shared_ptr<PageBlock> block, std::span<std::byte> bytes);
    /// Gives the memory back.
    ~KeptTile();
    KeptTile(const KeptTile&) = delete;
    KeptTile& operator=(const KeptTile&) = delete;

    [[nodiscard]] ByteView bytes() const { return bytes_; }
    [[nodiscard]] size_t size() const { return bytes_.size(); }

  private:
    std::shared_ptr<PageBlock> block_;
    std::span<std::byte> bytes_;
};

/// Where tiles are kept: one after the other in blocks of pages, a place never being used twice. Thread-safe.
class TileMemory {
  public:
    /// Bytes of memory that so many bytes of a tile take: whole pages.
    [[nodiscard]] static uint64_t roomFor(uint64_t size);
    /// Copies a tile into memory. @return null: there is none left
    [[nodiscard]] std::shared_ptr<const KeptTile> keep(ByteView tile);

  private:
    std::mutex mutex_;
    std::shared_ptr<PageBlock> block_;  ///< that is being filled
    size_t used_ = 0;                   ///< of it
};

}  // namespace terray::server
