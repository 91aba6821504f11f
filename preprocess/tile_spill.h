#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <vector>

#include "common/pmtiles.h"
#include "common/tile_id.h"
#include "preprocess/work_file.h"

namespace terray {

/// Finished tiles in the order in which threads happen to finish them, until they can be written in Hilbert order.
///
/// So the archive does not depend on the number of threads. Costs 24 bytes of memory for each tile, and its bytes on
/// disk.
class TileSpill {
  public:
    explicit TileSpill(const std::filesystem::path& path) : file_(path) {}

    /// Thread-safe.
    void add(const TileId& id, ByteView payload);
    /// Hands every tile to the writer in its order; call once, when all are in. Throws Error(interrupted) once `stop`
    /// is set.
    void writeTo(PmtilesWriter& writer, const std::atomic<bool>& stop);

    [[nodiscard]] uint64_t tiles() const { return places_.size(); }
    [[nodiscard]] uint64_t bytes() const { return end_; }

  private:
    struct Place {
        uint64_t hilbert;
        uint64_t offset;
        uint64_t length;
    };
    WorkFile file_;
    std::mutex mutex_;
    std::vector<Place> places_;
    uint64_t end_ = 0;
};

}  // namespace terray
