#include "server/tile_memory.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "common/error.h"

namespace terray::server {
namespace {

uint64_t pageBytes() {
    static const auto bytes = static_cast<uint64_t>(::sysconf(_SC_PAGESIZE));
    return bytes;
}

bool writeAll(int descriptor, ByteView bytes, uint64_t offset) {
    while (!bytes.empty()) {
        const ssize_t written = ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        bytes = bytes.subspan(static_cast<size_t>(written));
        offset += static_cast<uint64_t>(written);
    }
    return true;
}

}  // namespace

TileMemory::TileMemory() : descriptor_(::memfd_create("terray tiles", MFD_CLOEXEC)) {
    if (descriptor_ < 0)
        throw Error(ExitCode::internal, std::string("cannot make the cache of tiles: memfd_create: ") +
                                            std::strerror(errno) + "; start without it (--cache 0)");
}

TileMemory::~TileMemory() {
    ::close(descriptor_);
}

uint64_t TileMemory::roomFor(uint64_t size) {
    return (size + pageBytes() - 1) / pageBytes() * pageBytes();
}

std::shared_ptr<const KeptTile> TileMemory::keep(const std::shared_ptr<TileMemory>& memory, ByteView tile) {
    const uint64_t offset = memory->end_.fetch_add(roomFor(tile.size()), std::memory_order_relaxed);
    auto kept = std::make_shared<const KeptTile>(memory, offset, tile.size());
    return writeAll(memory->descriptor_, tile, offset) ? kept : nullptr;
}

KeptTile::KeptTile(std::shared_ptr<TileMemory> memory, uint64_t offset, size_t size)
    : memory_(std::move(memory)), offset_(offset), size_(size) {}

KeptTile::~KeptTile() {
    // Pages that are on their way to a client are referred to by its socket, and outlive this.
    ::fallocate(memory_->descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset_),
                static_cast<off_t>(TileMemory::roomFor(size_)));
}

}  // namespace terray::server
