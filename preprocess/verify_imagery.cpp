#include <atomic>
#include <string>
#include <unordered_set>

#include "common/imagery_tile.h"
#include "common/parallel.h"
#include "preprocess/verify_faults.h"

namespace terray {
namespace {

class ImageryVerifier {
  public:
    ImageryVerifier(const DatasetArchives& dataset, FaultList& faults)
        : finestLevel_(*dataset.metadata.imageryLevel),
          archive_(*dataset.imagery),
          faults_(faults),
          list_(listTiles(archive_)),
          tiles_(list_.tiles),
          listed_(tiles_.begin(), tiles_.end()) {}

    uint64_t run(const DatasetArchives& dataset, int jobs, const std::atomic<bool>& stop) {
        forEachParallel(tiles_.size(), jobs, stop, [&](int, size_t item) { verify(tiles_[item]); });
        verifyHeader(dataset, archive_, finestLevel_, list_, faults_);
        if (!listed_.contains(TileId{})) faults_.add("imagery has no root tile");
        if (dataset.metadata.imageryTiles != tiles_.size())
            faults_.add("counts " + std::to_string(dataset.metadata.imageryTiles) + " imagery tiles, the archive has " +
                        std::to_string(tiles_.size()));
        return tiles_.size();
    }

  private:
    void verify(const TileId& id) {
        if (id.level > finestLevel_) {
            faults_.addImagery(id, "lies deeper than the finest level, " + std::to_string(finestLevel_));
            return;
        }
        if (id.level > 0 && !listed_.contains(id.parent())) faults_.addImagery(id, "its parent is missing");
        const auto tile = readTile(id);
        if (!tile.ok()) {
            faults_.addImagery(id, tile.failure().message);
            return;
        }
        const int mips = id.level == 0 ? kImageryMips : 1;
        if (tile->mips != mips)
            faults_.addImagery(id, "stores " + std::to_string(tile->mips) + " mips, not " + std::to_string(mips));
        verifyChildren(*tile);
    }

    [[nodiscard]] Result<ImageryTile> readTile(const TileId& id) const {
        const auto payload = archive_.read(id);
        if (!payload.ok()) return payload.failure();
        if (!*payload) return Failure{"the archive has no such tile"};
        return decodeImageryTile(**payload, id);
    }

    void verifyChildren(const ImageryTile& tile) {
        for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
            // Ids stop at kMaxTileLevel, so the deepest tiles can have no children to look for.
            const TileId child = tile.id.child(quadrant);
            const bool exists = child.valid() && listed_.contains(child);
            if (tile.childExists[quadrant] == exists) continue;
            faults_.addImagery(tile.id, exists ? "says that its child " + toString(child) + " does not exist"
                                               : "its child " + toString(child) + " is missing");
        }
    }

    uint32_t finestLevel_;
    const PmtilesReader& archive_;
    FaultList& faults_;
    TileList list_;
    const std::vector<TileId>& tiles_;
    std::unordered_set<TileId> listed_;
};

}  // namespace

uint64_t verifyImagery(const DatasetArchives& dataset, int jobs, const std::atomic<bool>& stop, FaultList& faults) {
    return ImageryVerifier(dataset, faults).run(dataset, jobs, stop);
}

}  // namespace terray
