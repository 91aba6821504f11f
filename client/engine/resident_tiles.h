#pragma once

#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "client/render/gpu_tiles.h"
#include "client/stream/host_cache.h"
#include "client/stream/pager.h"
#include "client/stream/selection.h"
#include "client/stream/tile_tree.h"

namespace terray {

/// The tile that a request is for.
[[nodiscard]] inline TileKey keyOf(const TileRequest& request) {
    return {request.layer, request.id};
}

/// What moved to the GPU.
struct Uploads {
    size_t tiles = 0;
    size_t editedTiles = 0;  ///< of these
    uint64_t bytes = 0;

    Uploads& operator+=(const Uploads& other) {
        tiles += other.tiles;
        editedTiles += other.editedTiles;
        bytes += other.bytes;
        return *this;
    }
};

/// Keeps the GPU's slots and the tile tree's residency in step, and holds tiles that have arrived until their turn to
/// be uploaded comes. Root tiles are uploaded first and never evicted. GL thread only.
class ResidentTiles {
  public:
    /// Reads and uploads the root tiles. Throws Error(dataset) when one cannot be had. `source` and `shaders` outlive
    /// this object.
    ResidentTiles(const TileSource& source, const ShaderLibrary& shaders, const GpuTilesOptions& options,
                  bool useImagery);

    [[nodiscard]] const TileTree& tree() const { return tree_; }
    [[nodiscard]] const GpuTiles& gpu() const { return gpu_; }

    /// From now on the ground is edited so, in place of the edits before. Resident tiles for which that changes
    /// anything leave the GPU, and are edited from their stored codes when they come again; the root is made anew at
    /// once. Tiles that the change does not touch stay as they are. Throws Error(dataset) when the root cannot be read
    /// again.
    Uploads setEdits(EditList edits, GpuTimer* timer);
    [[nodiscard]] const EditList& edits() const;

    /// Learns what a tile says of its children.
    void learn(const LoadedTile& tile);
    /// The same of an arrived tile, and keeps it for upload unless the GPU has it already.
    void accept(LoadedTile tile);
    [[nodiscard]] bool isPending(const TileKey& key) const { return pending_.contains(key); }
    [[nodiscard]] size_t pendingTiles() const { return pending_.size(); }
    /// Drops what waits for upload and is not among `wanted` any more; the pager still has it while its budget allows.
    void keepOnly(const std::vector<TileRequest>& wanted);

    /// Lets the tree forget what is far from resident tiles, as TileTree::forgetBeyond.
    void forgetBeyond(size_t most) { tree_.forgetBeyond(most); }
    /// From now on nothing is pinned but the roots.
    void beginFrame();
    /// What a selection draws, and what it needs and has, is not evicted until the next beginFrame(); the ancestors of
    /// it go last after that, since they are the next to stand in. Not so what stands in for a coarser tile: select
    /// again once something was uploaded.
    void pin(const Selection& selection);
    /// Whether every slot of a layer holds the root or a tile pinned by pin(): refinement of that layer ends here.
    [[nodiscard]] bool full(TileLayer layer) const;

    /// Uploads what is pending in the order of `wanted`, until the next tile would exceed the budget (the first one
    /// never does) or no slot can be had. Uploaded tiles are pinned, and appended to `uploaded` when given.
    /// @param timer  told of edited tiles, may be null
    Uploads upload(const std::vector<TileRequest>& wanted, uint64_t budgetBytes, std::vector<TileKey>* uploaded,
                   GpuTimer* timer);

  private:
    void pin(const std::vector<DrawNode>& nodes, const Selection& selection);
    void pinNeeded(const Selection& selection);
    void loadRoots();
    [[nodiscard]] LoadedTile readHeightRoot() const;
    void uploadRoot(const LoadedTile& root);
    /// What one tile's upload came to; no tiles when there was no slot for it.
    Uploads uploadOne(const LoadedTile& tile, GpuTimer* timer);
    GpuTiles::Upload uploadHeights(const HeightTile& tile, GpuTimer* timer, Uploads& done);
    void setResident(const TileKey& key, bool resident);
    [[nodiscard]] bool isResident(const TileKey& key) const;

    const TileSource& source_;
    TileTree tree_;
    GpuTiles gpu_;
    std::shared_ptr<const EditedGround> edits_;  ///< null without edits
    std::unordered_map<TileKey, LoadedTile, TileKeyHash> pending_;
    std::unordered_set<TileId> pinnedHeights_;
    std::unordered_set<TileId> pinnedImagery_;
};

}  // namespace terray
