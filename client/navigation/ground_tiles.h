#pragma once

#include <condition_variable>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <thread>
#include <unordered_map>

#include "client/navigation/ground.h"
#include "client/stream/dataset_source.h"
#include "common/terrain_edit.h"

namespace terray {

/// Heights of a dataset's ground for the camera's own use, whatever the picture shows: under() never waits, it answers
/// from the finest tile that has come and has finer ones read by a thread of this object. A coarse tile's error bounds
/// how much higher the finest ground may be.
///
/// Holds a bounded number of decoded tiles, the least recently asked first out. All functions are for one thread.
class GroundTiles final : public Ground {
  public:
    struct Options {
        EditList edits;                       ///< of the ground
        size_t mostTiles = 64;                ///< more than there are levels; 34 MB
        std::optional<uint32_t> finestLevel;  ///< finer tiles are not read; none: the dataset's
    };

    /// Reads the root tile. Throws Error(dataset) when it cannot be had.
    /// @param source  outlives this object
    GroundTiles(const TileSource& source, Options options);
    ~GroundTiles() override;
    GroundTiles(const GroundTiles&) = delete;
    GroundTiles& operator=(const GroundTiles&) = delete;

    /// Between the centres of four samples the ground is bilinear; with holes among them, the highest of the others.
    [[nodiscard]] std::optional<GroundHeight> under(glm::dvec2 place) override;
    [[nodiscard]] bool learning() override;
    /// From now on the ground is level over each sample's cell, as Surface::columns draws it, or bilinear again.
    void setColumns(bool columns) { columns_ = columns; }
    /// From now on the ground is edited so.
    void setEdits(EditList edits) { edits_ = std::move(edits); }

    /// Waits until everything that was asked for has come or failed.
    void waitUntilSettled();

  private:
    using Tile = std::shared_ptr<const HeightTile>;  ///< null: it cannot be had
    struct Entry {
        TileId id;
        Tile tile;
    };
    using Recent = std::list<Entry>;
    static constexpr size_t kMostWanted = 16;

    /// What is known on the way from the root to a finest tile.
    struct Way {
        Tile deepest;                   ///< that has come; null: there is no surface
        std::optional<TileId> missing;  ///< the next one below it, to be read
    };

    void work();
    [[nodiscard]] Tile read(const TileId& id) const;
    void keep(const TileId& id, Tile tile);
    [[nodiscard]] Way wayTo(const TileId& finest);
    [[nodiscard]] TileId finestOver(glm::dvec2 place) const;
    [[nodiscard]] std::optional<double> heightIn(const HeightTile& tile, glm::dvec2 place) const;

    const TileSource& source_;
    EditList edits_;
    const size_t mostTiles_;
    const uint32_t finestLevel_;
    bool columns_ = false;
    std::mutex mutex_;
    std::condition_variable changed_;
    Recent recent_;  ///< most recently asked first
    std::unordered_map<TileId, Recent::iterator> known_;
    std::deque<TileId> wanted_;  ///< finest tiles, asked for last first; beyond kMostWanted the oldest are dropped
    bool ending_ = false;
    std::thread thread_;  // last: it uses the rest
};

}  // namespace terray
