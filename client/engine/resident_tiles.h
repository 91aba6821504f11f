#pragma once

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
    uint64_t bytes = 0;
};

/// Keeps the GPU's slots and the tile tree's residency in step, and holds tiles that have arrived until their turn to
/// be uploaded comes. Root tiles are uploaded first and never evicted. GL thread only.
class ResidentTiles {
  public:
    /// Reads and uploads the root tiles. Throws Error(dataset) when one cannot be had.
    ResidentTiles(const TileSource& source, const ShaderLibrary& shaders, const GpuTilesOptions& options,
                  bool useImagery);

    [[nodiscard]] const TileTree& tree() const { return tree_; }
    [[nodiscard]] const GpuTiles& gpu() const { return gpu_; }

    /// Learns what an arrived tile says of its children, and keeps it for upload unless the GPU has it already.
    void accept(LoadedTile tile);
    [[nodiscard]] bool isPending(const TileKey& key) const { return pending_.contains(key); }
    [[nodiscard]] size_t pendingTiles() const { return pending_.size(); }
    /// Drops what waits for upload and is not among `wanted` any more; the pager still has it while its budget allows.
    void keepOnly(const std::vector<TileRequest>& wanted);

    /// Lets the tree forget what is far from resident tiles, as TileTree::forgetBeyond.
    void forgetBeyond(size_t most) { tree_.forgetBeyond(most); }
    /// From now on nothing is pinned but the roots.
    void beginFrame();
    /// What a selection draws is not evicted until the next beginFrame(); the ancestors of it go last after that, since
    /// they are the next to stand in.
    void pin(const Selection& selection);
    /// Whether every slot of a layer holds the root or a tile pinned by pin(): refinement of that layer ends here.
    [[nodiscard]] bool full(TileLayer layer) const;

    /// Uploads what is pending in the order of `wanted`, until the next tile would exceed the budget (the first one
    /// never does) or no slot can be had. Uploaded tiles are pinned, and appended to `uploaded` when given.
    Uploads upload(const std::vector<TileRequest>& wanted, uint64_t budgetBytes, std::vector<TileKey>* uploaded);

  private:
    void pin(const std::vector<DrawNode>& nodes);
    void loadRoots(const TileSource& source);
    void uploadRoot(const LoadedTile& root);
    void learn(const LoadedTile& tile);
    /// @return whether a slot could be had
    bool uploadOne(const LoadedTile& tile);
    void setResident(const TileKey& key, bool resident);
    [[nodiscard]] bool isResident(const TileKey& key) const;

    TileTree tree_;
    GpuTiles gpu_;
    std::unordered_map<TileKey, LoadedTile, TileKeyHash> pending_;
    std::unordered_set<TileId> pinnedHeights_;
    std::unordered_set<TileId> pinnedImagery_;
};

}  // namespace terray
