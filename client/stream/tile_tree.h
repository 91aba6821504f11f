#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>

#include "common/edited_ground.h"
#include "common/height_tile.h"
#include "common/imagery_tile.h"
#include "common/tiling.h"

namespace terray {

/// What the client knows of the quadtree so far: it grows from the root tile's own records, as tiles arrive, and needs
/// no index of the dataset (design, section 2: every tile describes its children).
///
/// Knowledge of a tile (its record) is separate from residency (its samples are where the renderer can draw them).
/// Residency is marked from outside. Knowledge of where the camera no longer is can be forgotten, so that a long flight
/// takes bounded memory. One thread.
///
/// Under edits the tree knows the edited ground: records are edited as they come in (EditedGround::record), so that
/// boxes, errors and what is refined follow from it.
class TileTree {
  public:
    struct Heights {
        HeightRecord record;
        double metresPerCode = 0;    ///< of its codes; 0 until the tile has arrived once
        bool childrenKnown = false;  ///< the tile has arrived, so its children's records are in the tree
        bool resident = false;       ///< on the GPU
    };
    struct Imagery {
        bool exists = false;
        bool childrenKnown = false;
        bool resident = false;
    };

    TileTree(const Tiling& tiling, uint32_t finestHeightLevel, std::optional<uint32_t> finestImageryLevel);

    [[nodiscard]] const Tiling& tiling() const { return tiling_; }
    [[nodiscard]] bool hasImagery() const { return finestImageryLevel_.has_value(); }
    [[nodiscard]] uint32_t finestHeightLevel() const { return finestHeightLevel_; }
    [[nodiscard]] std::optional<uint32_t> finestImageryLevel() const { return finestImageryLevel_; }

    /// From now on the ground is edited so, in place of what it was before; null: as it is stored. What is known is
    /// kept. Costs time in proportion to what is known, times the edits.
    void setEdits(std::shared_ptr<const EditedGround> edits);

    /// Takes over what a tile says of itself and its children.
    void learn(const HeightTile& tile);
    void learn(const ImageryTile& tile);
    /// Marks tiles as drawable or not. The tile must have been learnt.
    void setHeightsResident(const TileId& id, bool resident);
    void setImageryResident(const TileId& id, bool resident);

    /// Once more than `most` tiles are known, keeps the resident tiles, those above them, and what all these say of
    /// their children. Selection then draws the same heights, may show a coarser photo in place of known absence, and
    /// asks again for what it would look into. Costs time in proportion to what is known, and is put off until that has
    /// doubled since the last time: where what is kept exceeds half of `most`, up to twice as much may be known.
    void forgetBeyond(size_t most);

    /// What is known of a tile; nullptr when no loaded tile has spoken of it yet.
    [[nodiscard]] const Heights* heights(const TileId& id) const;
    [[nodiscard]] const Imagery* imagery(const TileId& id) const;
    /// Metres per code of the edited tiles that are known, at most; 0 without edits.
    [[nodiscard]] double coarsestEditedStep() const { return coarsestEditedStep_; }
    [[nodiscard]] size_t knownTiles() const { return heights_.size() + imagery_.size(); }

  private:
    /// A tile's own part of what is known, as it is stored.
    struct Stored {
        HeightRecord record;
        double metresPerCode = 0;
    };
    /// Sets a tile's record and step from the stored ones, and keeps these where they are edited.
    void describe(const TileId& id, Heights& tile, const Stored& stored);

    Tiling tiling_;
    uint32_t finestHeightLevel_;
    std::optional<uint32_t> finestImageryLevel_;
    std::unordered_map<TileId, Heights> heights_;
    std::unordered_map<TileId, Imagery> imagery_;
    std::shared_ptr<const EditedGround> edits_;
    std::unordered_map<TileId, Stored> stored_;  ///< of those in heights_ that edits change
    double coarsestEditedStep_ = 0;
    size_t keptLast_ = 0;  ///< known tiles after the last forgetting
};

}  // namespace terray
