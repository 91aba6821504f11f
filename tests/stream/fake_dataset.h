#pragma once

#include <functional>
#include <map>

#include "client/stream/dataset_source.h"
#include "client/stream/tile_tree.h"

namespace terray::test {

/// A small dataset in memory, made from formulas: heights with known answers, no files.
struct FakeDataset {
    DatasetMetadata metadata;
    std::map<TileId, HeightTile> heights;
    std::map<TileId, ImageryTile> imagery;
};

/// Height in metres of the finest sample (column, row); NaN: no surface.
using HeightFormula = std::function<double(int64_t column, int64_t row)>;

struct FakeOptions {
    GridSize samples{2048, 2048};
    double spacing = 1;
    double west = 1000, north = 5000;
    double quantum = 0.01;
    std::optional<uint32_t> imageryLevel;
    /// Which imagery tiles exist (an ancestor of one that exists must exist, too).
    std::function<bool(const TileId&)> hasPhoto = [](const TileId&) { return true; };
};

/// Builds the pyramid as FORMAT.md says: means of valid samples, records with measured bounds and errors.
[[nodiscard]] FakeDataset buildDataset(const HeightFormula& height, const FakeOptions& options);

/// Rolling hills of about `relief` metres with a smooth eastern half. In the west a few single-sample pits and spikes,
/// and a row of pits along the border between the halves: what the apron of a coarse tile in the east averages away.
[[nodiscard]] HeightFormula hills(double relief);

/// Serves a fake dataset without faults.
class FakeSource : public TileSource {
  public:
    explicit FakeSource(const FakeDataset& dataset) : dataset_(dataset) {}
    const DatasetMetadata& metadata() const override { return dataset_.metadata; }
    Result<Bytes> read(TileLayer layer, const TileId& id) const override;
    std::string contentHash() const override { return "fake"; }

  private:
    const FakeDataset& dataset_;
};

/// A tree that knows nothing but the roots, which are resident.
[[nodiscard]] TileTree rootsOnly(const FakeDataset& dataset);
/// Learns a tile and marks it resident.
void load(TileTree& tree, const FakeDataset& dataset, TileLayer layer, const TileId& id);
/// A tree with all tiles resident.
[[nodiscard]] TileTree everything(const FakeDataset& dataset);

/// Numbers from a fixed seed, the same on every machine (the standard's distributions are not).
class Random {
  public:
    explicit Random(uint64_t seed) : state_(seed) {}
    uint64_t next() {  // SplitMix64 (Steele, Lea, Flood 2014)
        uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return z ^ (z >> 31);
    }
    double uniform(double from, double to) { return from + (to - from) * static_cast<double>(next() >> 11) * 0x1p-53; }
    bool chance(double probability) { return uniform(0, 1) < probability; }

  private:
    uint64_t state_;
};

}  // namespace terray::test
