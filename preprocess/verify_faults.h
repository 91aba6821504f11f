#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/pmtiles.h"
#include "preprocess/verify_dataset.h"

namespace terray {

/// Collects faults from several threads and returns them in an order that does not depend on these.
class FaultList {
  public:
    /// A fault of the dataset as a whole.
    void add(const std::string& what) { insert({0, 0}, {"metadata", what}); }
    void addHeights(const TileId& id, const std::string& what) {
        insert({1, hilbertId(id)}, {"heights " + toString(id), what});
    }
    void addImagery(const TileId& id, const std::string& what) {
        insert({2, hilbertId(id)}, {"imagery " + toString(id), what});
    }

    [[nodiscard]] std::vector<Fault> sorted() {
        std::ranges::stable_sort(faults_, [](const auto& a, const auto& b) {
            return std::pair(a.first, a.second.what) < std::pair(b.first, b.second.what);
        });
        std::vector<Fault> faults;
        for (auto& [place, fault] : faults_) faults.push_back(std::move(fault));
        return faults;
    }

  private:
    using Place = std::pair<int, uint64_t>;  ///< archive, Hilbert id

    void insert(Place place, Fault fault) {
        const std::scoped_lock lock(mutex_);
        faults_.emplace_back(place, std::move(fault));
    }

    std::mutex mutex_;
    std::vector<std::pair<Place, Fault>> faults_;
};

/// Checks all height tiles, and what the metadata says of them. @return tiles looked at
uint64_t verifyHeights(const DatasetArchives& dataset, int jobs, const std::atomic<bool>& stop, FaultList& faults);
/// Likewise for imagery; the dataset must have some.
uint64_t verifyImagery(const DatasetArchives& dataset, int jobs, const std::atomic<bool>& stop, FaultList& faults);

/// The tiles that an archive lists, in Hilbert order, and how its directories list them.
struct TileList {
    std::vector<TileId> tiles;
    uint64_t entries = 0;   ///< runs of tiles that share their bytes
    uint64_t contents = 0;  ///< different tile contents
};
/// Throws Error(dataset) when a directory is damaged.
[[nodiscard]] TileList listTiles(const PmtilesReader& archive);
/// Compares what the header of an archive says with the metadata and with the tiles found.
void verifyHeader(const DatasetArchives& dataset, const PmtilesReader& archive, uint32_t finestLevel,
                  const TileList& found, FaultList& faults);

}  // namespace terray
