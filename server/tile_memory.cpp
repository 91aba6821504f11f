#include "server/tile_memory.h"

#include <algorithm>
#include <utility>

#include <sys/mman.h>
#include <unistd.h>

namespace terray::server {
namespace {

/// Small, since a block stays mapped (8 KiB of page tables) for as long as one of its tiles is kept.
constexpr size_t kBlockBytes = size_t{4} << 20;

uint64_t pageBytes() {
    static const auto bytes = static_cast<uint64_t>(::sysconf(_SC_PAGESIZE));
    return bytes;
}

}  // namespace

std::shared_ptr<PageBlock> PageBlock::make(size_t size) {
    void* const start =
        ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (start == MAP_FAILED) return nullptr;
    ::madvise(start, size, MADV_NOHUGEPAGE);
    return std::shared_ptr<PageBlock>(new PageBlock({static_cast<std::byte*>(start), size}));
}

PageBlock::~PageBlock() {
    ::munmap(bytes_.data(), bytes_.size());
}

KeptTile::KeptTile(std::shared_ptr<PageBlock> block, std::span<std::byte> bytes)
    : block_(std::move(block)), bytes_(bytes) {}

KeptTile::~KeptTile() {
    ::madvise(bytes_.data(), TileMemory::roomFor(bytes_.size()), MADV_DONTNEED);
}

uint64_t TileMemory::roomFor(uint64_t size) {
    return (size + pageBytes() - 1) / pageBytes() * pageBytes();
}

std::shared_ptr<const KeptTile> TileMemory::keep(ByteView tile) {
    const size_t room = roomFor(tile.size());
    std::unique_lock lock(mutex_);
    if (block_ == nullptr || room > block_->bytes().size() - used_) {
        block_ = PageBlock::make(std::max(room, kBlockBytes));
        used_ = 0;
    }
    if (block_ == nullptr) return nullptr;
    const auto place = block_->bytes().subspan(std::exchange(used_, used_ + room), tile.size());
    auto kept = std::make_shared<const KeptTile>(block_, place);
    lock.unlock();
    std::ranges::copy(tile, place.begin());
    return kept;
}

}  // namespace terray::server
