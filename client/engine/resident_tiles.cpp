#include "client/engine/resident_tiles.h"

#include <set>
#include <string>

#include "common/error.h"

namespace terray {
namespace {

constexpr TileId kRoot{};

/// The value, or Error(dataset) saying which root tile could not be had.
template <class T>
T required(Result<T> result, const char* what) {
    if (!result)
        throw Error(ExitCode::dataset, std::string("cannot use the dataset's coarsest ") + what + " tile: " +
                                           result.failure().message + " (terray-preprocess verify tells more)");
    return std::move(result).value();
}

template <class Tile>
Tile readRoot(const TileSource& source, TileLayer layer, Result<Tile> (*decode)(ByteView, std::optional<TileId>),
              const char* what) {
    const Bytes payload = required(source.read(layer, kRoot), what);
    return required(decode(payload, kRoot), what);
}

uint64_t uploadBytes(TileLayer layer) {
    return layer == TileLayer::heights ? GpuTiles::heightUploadBytes() : GpuTiles::imageryUploadBytes();
}

}  // namespace

ResidentTiles::ResidentTiles(const TileSource& source, const ShaderLibrary& shaders, const GpuTilesOptions& options,
                             bool useImagery)
    : source_(source),
      tree_(source.metadata().tiling, source.metadata().tiling.finestLevel,
            useImagery ? source.metadata().imageryLevel : std::nullopt),
      gpu_(shaders, options) {
    loadRoots();
}

LoadedTile ResidentTiles::readHeightRoot() const {
    HeightTile heights = readRoot(source_, TileLayer::heights, decodeHeightTile, "height");
    return {.layer = TileLayer::heights, .heights = std::make_shared<HeightTile>(std::move(heights))};
}

void ResidentTiles::loadRoots() {
    uploadRoot(readHeightRoot());
    if (!tree_.hasImagery()) return;
    ImageryTile imagery = readRoot(source_, TileLayer::imagery, decodeImageryTile, "imagery");
    Bytes chain = gatherMipChain(imagery, {});
    uploadRoot({.layer = TileLayer::imagery,
                .imageryChain = std::make_shared<Bytes>(std::move(chain)),
                .imagery = std::make_shared<ImageryTile>(std::move(imagery))});
}

void ResidentTiles::uploadRoot(const LoadedTile& root) {
    accept(root);
    TERRAY_CHECK_OP(uploadOne(root, nullptr).tiles, ==, 1u);  // the first upload of its layer: every slot is free
    pending_.clear();
}

const EditList& ResidentTiles::edits() const {
    static const EditList kNone;
    return edits_ ? edits_->edits() : kNone;
}

Uploads ResidentTiles::setEdits(EditList edits, GpuTimer* timer) {
    const DatasetMetadata& metadata = source_.metadata();
    const auto before = edits_;
    edits_.reset();
    if (!edits.empty())
        edits_ = std::make_shared<const EditedGround>(metadata.tiling, metadata.quantum, std::move(edits));
    tree_.setEdits(edits_);
    const auto near = [](const auto& ground, const TileId& id) { return ground ? ground->near(id) : EditList(); };
    Uploads done;
    for (const TileId& id : gpu_.heightTiles()) {
        if (near(before, id) == near(edits_, id)) continue;
        if (id == kRoot) {
            done = uploadOne(readHeightRoot(), timer);
            continue;
        }
        gpu_.evictHeights(id);
        setResident({TileLayer::heights, id}, false);
    }
    return done;
}

void ResidentTiles::learn(const LoadedTile& tile) {
    if (tile.layer == TileLayer::heights) {
        tree_.learn(*tile.heights);
    } else {
        tree_.learn(*tile.imagery);
    }
}

void ResidentTiles::accept(LoadedTile tile) {
    learn(tile);
    const TileKey key{tile.layer, tile.id};
    if (!isResident(key)) pending_.insert_or_assign(key, std::move(tile));
}

void ResidentTiles::keepOnly(const std::vector<TileRequest>& wanted) {
    std::unordered_set<TileKey, TileKeyHash> keep;
    for (const TileRequest& request : wanted) keep.insert(keyOf(request));
    std::erase_if(pending_, [&](const auto& entry) { return !keep.contains(entry.first); });
}

void ResidentTiles::beginFrame() {
    gpu_.beginFrame();
    pinnedHeights_ = {kRoot};
    gpu_.pinHeights(kRoot);
    if (!tree_.hasImagery()) return;
    pinnedImagery_ = {kRoot};
    gpu_.pinImagery(kRoot);
}

void ResidentTiles::pin(const Selection& selection) {
    pin(selection.nodes, selection);
    pin(selection.casters, selection);
    pinNeeded(selection);
}

/// Not all that a view needs is drawn: a box may turn out to be outside the picture once its tile is there. If such
/// tiles could go they would be wanted again.
void ResidentTiles::pinNeeded(const Selection& selection) {
    for (const TileId& id : selection.heightTiles) {
        if (!isResident({TileLayer::heights, id})) continue;
        pinnedHeights_.insert(id);
        gpu_.pinHeights(id);
    }
    for (const TileId& id : selection.imageryTiles) {
        if (!isResident({TileLayer::imagery, id})) continue;
        pinnedImagery_.insert(id);
        gpu_.pinImagery(id);
    }
}

void ResidentTiles::pin(const std::vector<DrawNode>& nodes, const Selection& selection) {
    // Up to four stand in for one coarser tile. Pinned, they could keep it out for ever.
    const std::unordered_set<TileId> needed[] = {{selection.heightTiles.begin(), selection.heightTiles.end()},
                                                 {selection.imageryTiles.begin(), selection.imageryTiles.end()}};
    const auto mayGo = [&needed](TileLayer layer, const TileId& id, bool exact) {
        return !exact && id.level > 0 && needed[static_cast<size_t>(layer)].contains(id.parent());
    };
    const auto heightsMayGo = [&](const DrawNode& node) {
        return mayGo(TileLayer::heights, node.heightTile, node.heightsExact);
    };
    const auto imageryMayGo = [&](const DrawNode& node) {
        return !node.imageryTile || mayGo(TileLayer::imagery, *node.imageryTile, node.imageryExact);
    };
    const auto touchAncestors = [](TileId id, const auto& resident, const auto& touch) {
        while (id.level > 0) {
            id = id.parent();
            if (resident(id)) touch(id);
        }
    };
    // In the order of the nodes, so that the least recently used tile is the same one in every run.
    for (const DrawNode& node : nodes) {
        touchAncestors(
            node.heightTile,
            [&](const TileId& id) {
                return isResident({TileLayer::heights, id});
            },
            [&](const TileId& id) { gpu_.touchHeights(id); });
        if (node.imageryTile)
            touchAncestors(
                *node.imageryTile,
                [&](const TileId& id) {
                    return isResident({TileLayer::imagery, id});
                },
                [&](const TileId& id) { gpu_.touchImagery(id); });
    }
    for (const DrawNode& node : nodes) {
        if (!heightsMayGo(node)) {
            pinnedHeights_.insert(node.heightTile);
            gpu_.pinHeights(node.heightTile);
        }
        if (!imageryMayGo(node)) {
            pinnedImagery_.insert(*node.imageryTile);
            gpu_.pinImagery(*node.imageryTile);
        }
    }
}

bool ResidentTiles::full(TileLayer layer) const {
    return layer == TileLayer::heights ? pinnedHeights_.size() >= gpu_.heightSlots()
                                       : pinnedImagery_.size() >= gpu_.imagerySlots();
}

Uploads ResidentTiles::upload(const std::vector<TileRequest>& wanted, uint64_t budgetBytes,
                              std::vector<TileKey>* uploaded, GpuTimer* timer) {
    Uploads done;
    std::set<TileLayer> withoutSlot;
    for (const TileRequest& request : wanted) {
        const auto found = pending_.find(keyOf(request));
        if (found == pending_.end() || withoutSlot.contains(request.layer)) continue;
        if (done.tiles > 0 && done.bytes + uploadBytes(request.layer) > budgetBytes) break;
        const Uploads one = uploadOne(found->second, timer);
        if (one.tiles == 0) {
            withoutSlot.insert(request.layer);
            continue;
        }
        if (uploaded != nullptr) uploaded->push_back(found->first);
        pending_.erase(found);
        done += one;
    }
    return done;
}

GpuTiles::Upload ResidentTiles::uploadHeights(const HeightTile& tile, GpuTimer* timer, Uploads& done) {
    const std::optional<EditedTile> edited = edits_ ? edits_->describe(tile) : std::nullopt;
    done.editedTiles = edited ? 1 : 0;
    return gpu_.uploadHeights(tile, edited ? &*edited : nullptr, timer);
}

Uploads ResidentTiles::uploadOne(const LoadedTile& tile, GpuTimer* timer) {
    const bool isHeights = tile.layer == TileLayer::heights;
    Uploads done{.tiles = 1, .bytes = uploadBytes(tile.layer)};
    const GpuTiles::Upload upload =
        isHeights ? uploadHeights(*tile.heights, timer, done) : gpu_.uploadImagery(tile.id, *tile.imageryChain);
    if (!upload.done) return {};
    if (upload.evicted) setResident({tile.layer, *upload.evicted}, false);
    learn(tile);  // the tree may have forgotten it while it waited
    setResident({tile.layer, tile.id}, true);
    if (isHeights) {
        gpu_.pinHeights(tile.id);
    } else {
        gpu_.pinImagery(tile.id);
    }
    return done;
}

void ResidentTiles::setResident(const TileKey& key, bool resident) {
    if (key.layer == TileLayer::heights) {
        tree_.setHeightsResident(key.id, resident);
    } else {
        tree_.setImageryResident(key.id, resident);
    }
}

bool ResidentTiles::isResident(const TileKey& key) const {
    if (key.layer == TileLayer::heights) return gpu_.heights(key.id) != nullptr;
    return gpu_.imagerySlot(key.id).has_value();
}

}  // namespace terray
