#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_set>

#include "common/height_tile.h"
#include "common/parallel.h"
#include "preprocess/block_plan.h"
#include "preprocess/height_samples.h"
#include "preprocess/surface_deviation.h"
#include "preprocess/verify_faults.h"

namespace terray {
namespace {

/// Decoded heights, metres, rounded to float; NaN without surface.
Grid<float> decoded(const HeightTile& tile, const GridRect& cells) {
    Grid<float> heights({cells.width, cells.height}, std::numeric_limits<float>::quiet_NaN());
    const GridView<const uint16_t> codes = tile.codes.view().window(cells);
    for (int64_t row = 0; row < cells.height; ++row)
        for (int64_t column = 0; column < cells.width; ++column)
            if (const uint16_t code = codes.at(column, row); code != kNoSurface)
                heights.at(column, row) = static_cast<float>(tile.encoding.height(code));
    return heights;
}

/// A core cell of a tile and the cells beneath it, decoded.
struct CellFamily {
    double height = 0;  ///< metres; NaN without surface
    std::array<double, 4> children{};
};

/// The tiles beneath a tile, decoded; absent ones have no value.
using Children = std::array<std::optional<HeightTile>, 4>;

/// Decoded height of a core cell, metres; NaN without surface.
double coreHeight(const HeightTile& tile, int64_t column, int64_t row) {
    const uint16_t code = tile.codes.at(column + kHeightApron, row + kHeightApron);
    return code == kNoSurface ? std::numeric_limits<double>::quiet_NaN() : tile.encoding.height(code);
}

/// What comparing a tile with its children found.
struct Comparison {
    double provenError = 0;   ///< the children prove at least this error
    double allowedError = 0;  ///< and allow at most this one
    int64_t wrongHoles = 0;   ///< cells that are holes over a surface, or a surface over holes
    int64_t wrongMeans = 0;   ///< cells that are not the mean of those beneath
};

/// Compares the cells over one child.
class ChildComparison {
  public:
    ChildComparison(const HeightTile& tile, const std::optional<HeightTile>& child, double roundingOfMeans)
        : tile_(tile), child_(child), roundingOfMeans_(roundingOfMeans) {}

    void compare(uint32_t quadrant, Comparison& result) const {
        constexpr int64_t kHalf = kTileCore / 2;
        for (int64_t row = 0; row < kHalf; ++row)
            for (int64_t column = 0; column < kHalf; ++column)
                compareCell({coreHeight(tile_, (quadrant & 1) * kHalf + column, (quadrant >> 1) * kHalf + row),
                             cellsBeneath(2 * column, 2 * row)},
                            result);
    }

    /// The same for the bilinear surfaces: both are off by no more than their tiles' errors, so they are apart by no
    /// more than the sum. And a tile's error is made of that distance, the child's and its own rounding, twice.
    void compareSurfaces(uint32_t quadrant, Comparison& result) const {
        if (!child_) return;
        constexpr int64_t kHalf = kTileCore / 2, kRing = 1;
        const Grid<float> fine = decoded(*child_, {0, 0, kHeightTileSide, kHeightTileSide});
        HeightSamples coarse({kHalf + 2 * kRing, kHalf + 2 * kRing});
        halveHeights({fine.view(), fine.view(), fine.view()}, coarse);
        coarse.mean =
            decoded(tile_, {kHeightApron - kRing + (quadrant & 1) * kHalf,
                            kHeightApron - kRing + (quadrant >> 1) * kHalf, kHalf + 2 * kRing, kHalf + 2 * kRing});
        Grid<float> apart({kHalf, kHalf});
        boundDeviations({.coarse = coarse.views(), .fine = fine.view(), .fineDeviation = {}}, apart.view());
        double greatest = 0;
        for (const float distance : apart.cells())
            if (!std::isnan(distance)) greatest = std::max(greatest, static_cast<double>(distance));
        const double rounding = roundingOfSurfaces();
        const auto childError = static_cast<double>(child_->record.error);
        result.provenError = std::max(result.provenError, greatest - childError - rounding);
        result.allowedError =
            std::max(result.allowedError, greatest + childError + tile_.encoding.metresPerCode() + rounding);
    }

  private:
    /// What boundDeviations() may add, here and when the tile was built: it works on heights around that lie within the
    /// finest ones; and the rounding of decoded heights to float.
    [[nodiscard]] double roundingOfSurfaces() const {
        const double range = static_cast<double>(tile_.record.maxHeight) - static_cast<double>(tile_.record.minHeight) +
                             2 * static_cast<double>(tile_.record.error);
        return std::ldexp(range, -18) + roundingOfMeans_;
    }

    [[nodiscard]] std::array<double, 4> cellsBeneath(int64_t column, int64_t row) const {
        constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
        if (!child_) return {kNone, kNone, kNone, kNone};
        return {coreHeight(*child_, column, row), coreHeight(*child_, column + 1, row),
                coreHeight(*child_, column, row + 1), coreHeight(*child_, column + 1, row + 1)};
    }

    void compareCell(const CellFamily& cell, Comparison& result) const {
        double sum = 0;
        int count = 0;
        for (const double height : cell.children) {
            if (std::isnan(height)) continue;
            sum += height;
            ++count;
            const double distance = std::abs(cell.height - height);
            const auto childError = static_cast<double>(child_->record.error);
            result.provenError = std::max(result.provenError, distance - childError);
            result.allowedError = std::max(result.allowedError, distance + childError);
        }
        if (std::isnan(cell.height) != (count == 0)) {
            ++result.wrongHoles;
            return;
        }
        if (count == 0) return;
        const double limit = (tile_.encoding.metresPerCode() + child_->encoding.metresPerCode()) / 2 + roundingOfMeans_;
        if (std::abs(cell.height - sum / count) > limit) ++result.wrongMeans;
    }

    const HeightTile& tile_;
    const std::optional<HeightTile>& child_;
    double roundingOfMeans_;
};

class HeightVerifier {
  public:
    HeightVerifier(const DatasetArchives& dataset, FaultList& faults)
        : metadata_(dataset.metadata),
          archive_(dataset.heights),
          extent_{metadata_.tiling.finestLevel, metadata_.samples},
          faults_(faults),
          list_(listTiles(archive_)),
          tiles_(list_.tiles),
          listed_(tiles_.begin(), tiles_.end()),
          levelErrors_(extent_.finestLevel + 1, 0) {}

    uint64_t run(const DatasetArchives& dataset, int jobs, const std::atomic<bool>& stop) {
        forEachParallel(tiles_.size(), jobs, stop, [&](int, size_t item) { verify(tiles_[item]); });
        verifyHeader(dataset, archive_, extent_.finestLevel, list_, faults_);
        verifyTotals();
        return tiles_.size();
    }

  private:
    [[nodiscard]] Result<HeightTile> readTile(const TileId& id) const {
        const auto payload = archive_.read(id);
        if (!payload.ok()) return payload.failure();
        if (!*payload) return Failure{"the archive has no such tile"};
        return decodeHeightTile(**payload, id);
    }

    void fault(const TileId& id, const std::string& what) { faults_.addHeights(id, what); }

    void verify(const TileId& id) {
        if (id.level > extent_.finestLevel) {
            fault(id, "lies deeper than the finest level, " + std::to_string(extent_.finestLevel));
            return;
        }
        if (id.level > 0 && !listed_.contains(id.parent())) fault(id, "its parent is missing");
        const auto tile = readTile(id);
        if (!tile.ok()) {
            fault(id, tile.failure().message);
            return;
        }
        if (!tile->record.exists) fault(id, "has no surface, so it should not be stored");
        if (tile->encoding.quantum != metadata_.quantum) fault(id, "has another height quantum than the metadata");
        verifyPadding(*tile);
        count(*tile);
        if (id.level == extent_.finestLevel)
            verifyFinest(*tile);
        else
            verifyFamily(*tile);
    }

    /// Nothing may lie beyond the sources' edge.
    void verifyPadding(const HeightTile& tile) {
        const GridSize samples = extent_.samplesAt(tile.id.level);
        const GridRect covered = grown(Tiling::coreSamples(tile.id), kHeightApron);
        int64_t outside = 0;
        for (int64_t row = 0; row < kHeightTileSide; ++row) {
            const std::span<const uint16_t> codes = tile.codes.view().row(row);
            const int64_t y = covered.y + row;
            for (int64_t column = 0; column < kHeightTileSide; ++column) {
                const int64_t x = covered.x + column;
                const bool inside = x >= 0 && y >= 0 && x < samples.width && y < samples.height;
                if (!inside && codes[static_cast<size_t>(column)] != kNoSurface) ++outside;
            }
        }
        if (outside > 0) fault(tile.id, std::to_string(outside) + " cells beyond the sources' edge have a surface");
    }

    void verifyFinest(const HeightTile& tile) {
        for (const HeightRecord& child : tile.children)
            if (child.exists) fault(tile.id, "claims a child below the finest level");
        // A finest sample lies within half a code step of its code; the slack covers rounding to float and double.
        const double half = tile.encoding.metresPerCode() * 0.5;
        if (half > metadata_.errorBound * (1 + 1e-6))
            fault(tile.id, "has codes " + std::to_string(2 * half) +
                               " m apart, too far for the metadata's errorBound of " +
                               std::to_string(metadata_.errorBound) + " m");
        const double limit = half * (1 + 1e-6) + 1e-9;
        if (static_cast<double>(tile.record.error) > limit)
            fault(tile.id, "claims an error of " + std::to_string(tile.record.error) +
                               " m, more than the rounding of its codes");
    }

    void verifyFamily(const HeightTile& tile) {
        Children children;
        bool complete = true;
        for (uint32_t quadrant = 0; quadrant < 4; ++quadrant)
            complete = readChild(tile, quadrant, children[quadrant]) && complete;
        if (!complete) return;  // reported already; without all children the tile itself cannot be judged

        Comparison result;
        for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
            const ChildComparison comparison(tile, children[quadrant], roundingOfMeans(tile));
            comparison.compare(quadrant, result);
            if (metadata_.errorsHoldEverywhere) comparison.compareSurfaces(quadrant, result);
        }
        report(tile, result);
    }

    /// @return whether the child is what the tile says it is
    bool readChild(const HeightTile& tile, uint32_t quadrant, std::optional<HeightTile>& child) {
        const TileId id = tile.id.child(quadrant);
        const HeightRecord& claim = tile.children[quadrant];
        const bool exists = listed_.contains(id);
        if (claim.exists != exists) {
            fault(tile.id, claim.exists ? "its child " + toString(id) + " is missing"
                                        : "says that its child " + toString(id) + " does not exist");
            return false;
        }
        if (!exists) return true;
        auto read = readTile(id);
        if (!read.ok()) return false;  // reported when that tile is looked at itself
        if (read->record != claim) {
            fault(tile.id, "what it says of its child " + toString(id) + " is not what that tile says");
            return false;
        }
        child = std::move(read).value();
        return true;
    }

    /// Bound of the float rounding in a mean: means of each level are rounded to float (2^-24 of the height), and the
    /// codes on both sides come from such means, each with the error of all levels below it.
    [[nodiscard]] double roundingOfMeans(const HeightTile& tile) const {
        const double greatest = std::max(std::abs(static_cast<double>(tile.record.minHeight)),
                                         std::abs(static_cast<double>(tile.record.maxHeight)));
        return greatest * std::ldexp(2.0 * (extent_.finestLevel + 1), -24) + 1e-9;
    }

    void report(const HeightTile& tile, const Comparison& result) {
        if (result.wrongHoles > 0)
            fault(tile.id, std::to_string(result.wrongHoles) +
                               " cells are holes where the tiles beneath are not, or not where "
                               "they are");
        if (result.wrongMeans > 0)
            fault(tile.id, std::to_string(result.wrongMeans) + " cells are not the mean of the cells beneath");
        const auto claimed = static_cast<double>(tile.record.error);
        const double slack = 1e-9 + 1e-6 * claimed;  // both sides are rounded to float
        if (claimed + slack < result.provenError)
            fault(tile.id, "claims an error of " + std::to_string(claimed) + " m, but its children prove " +
                               std::to_string(result.provenError) + " m");
        if (claimed - slack > result.allowedError)
            fault(tile.id, "claims an error of " + std::to_string(claimed) + " m, but its children allow at most " +
                               std::to_string(result.allowedError) + " m");
    }

    void count(const HeightTile& tile) {
        uint64_t surfaces = 0;
        if (tile.id.level == extent_.finestLevel) {
            const GridView<const uint16_t> core =
                tile.codes.view().window({kHeightApron, kHeightApron, kTileCore, kTileCore});
            for (int64_t row = 0; row < kTileCore; ++row)
                surfaces += static_cast<uint64_t>(kTileCore - std::ranges::count(core.row(row), kNoSurface));
        }
        const std::scoped_lock lock(mutex_);
        ++tilesRead_;
        surfaceSamples_ += surfaces;
        minHeight_ = std::min(minHeight_, static_cast<double>(tile.record.minHeight));
        maxHeight_ = std::max(maxHeight_, static_cast<double>(tile.record.maxHeight));
        double& error = levelErrors_[tile.id.level];
        error = std::max(error, static_cast<double>(tile.record.error));
    }

    void verifyTotals() {
        if (!listed_.contains(TileId{})) faults_.add("heights have no root tile");
        if (metadata_.heightTiles != tiles_.size())
            faults_.add("counts " + std::to_string(metadata_.heightTiles) + " height tiles, the archive has " +
                        std::to_string(tiles_.size()));
        if (tilesRead_ != tiles_.size()) return;  // with unreadable tiles the sums below are not those of the dataset
        if (metadata_.minHeight != minHeight_ || metadata_.maxHeight != maxHeight_)
            faults_.add("heights range from " + std::to_string(metadata_.minHeight) + " to " +
                        std::to_string(metadata_.maxHeight) + " m, those of the tiles from " +
                        std::to_string(minHeight_) + " to " + std::to_string(maxHeight_));
        const auto holes = static_cast<uint64_t>(metadata_.samples.count()) - surfaceSamples_;
        if (metadata_.holeSamples != holes)
            faults_.add("counts " + std::to_string(metadata_.holeSamples) + " hole samples, the tiles have " +
                        std::to_string(holes));
        if (metadata_.levelErrors != levelErrors_) faults_.add("levelErrors are not the greatest errors of the tiles");
    }

    const DatasetMetadata& metadata_;
    const PmtilesReader& archive_;
    PyramidExtent extent_;
    FaultList& faults_;
    TileList list_;
    const std::vector<TileId>& tiles_;
    std::unordered_set<TileId> listed_;

    std::mutex mutex_;  ///< of all below
    uint64_t tilesRead_ = 0;
    uint64_t surfaceSamples_ = 0;
    double minHeight_ = std::numeric_limits<double>::infinity();
    double maxHeight_ = -std::numeric_limits<double>::infinity();
    std::vector<double> levelErrors_;
};

}  // namespace

uint64_t verifyHeights(const DatasetArchives& dataset, int jobs, const std::atomic<bool>& stop, FaultList& faults) {
    return HeightVerifier(dataset, faults).run(dataset, jobs, stop);
}

}  // namespace terray
