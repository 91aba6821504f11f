#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "client/stream/dataset_source.h"

namespace terray {

/// A dataset in main memory whose heights are a smooth closed formula and whose photo is a chessboard: every tile is
/// known without a builder. Tiles are made when they are first read.
class AnalyticDataset final : public TileSource {
  public:
    struct Options {
        uint32_t finestLevel = 2;              ///< of the heights; 512 * 2^finestLevel samples a side, all with surface
        std::optional<uint32_t> imageryLevel;  ///< finest level of the photo; none: no photo
        double spacing = 4;                    ///< metres between the finest samples
    };
    explicit AnalyticDataset(const Options& options);

    /// Hills of some 300 m over 2 to 5 km with waves of 20 m on them.
    [[nodiscard]] static double heightAt(double x, double y);
    /// No metre of ground rises by more than this.
    static constexpr double kSteepest = 1.2;

    [[nodiscard]] const DatasetMetadata& metadata() const override { return metadata_; }
    [[nodiscard]] Result<Bytes> read(TileLayer layer, const TileId& id) const override;
    [[nodiscard]] std::string contentHash() const override { return "analytic"; }

    /// From now on reading this tile fails.
    void lose(TileLayer layer, const TileId& id) { lost_.insert({layer, id}); }
    [[nodiscard]] uint64_t reads() const { return reads_; }

    /// Writes the dataset as archives into an existing directory, for programs.
    void write(const std::filesystem::path& directory) const;

  private:
    [[nodiscard]] HeightTile heightTile(const TileId& id) const;
    [[nodiscard]] ImageryTile imageryTile(const TileId& id) const;
    [[nodiscard]] HeightRecord recordOf(const TileId& id) const;
    [[nodiscard]] Grid<uint16_t> codesOf(const TileId& id) const;
    void writeArchive(const std::filesystem::path& path, TileLayer layer, uint32_t finestLevel) const;

    DatasetMetadata metadata_;
    HeightEncoding encoding_;
    std::set<std::pair<TileLayer, TileId>> lost_;
    mutable std::mutex mutex_;
    mutable std::map<std::pair<TileLayer, TileId>, Bytes> payloads_;
    mutable std::map<TileId, HeightRecord> records_;
    mutable std::atomic<uint64_t> reads_ = 0;
};

}  // namespace terray
