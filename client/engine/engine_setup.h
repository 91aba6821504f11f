#pragma once
// What an engine is made of, decided from its options, the dataset and the budgets. Pure functions.

#include <cstddef>
#include <cstdint>
#include <optional>

#include "client/engine/engine.h"
#include "client/engine/sun_clock.h"

namespace terray {

/// The options as this dataset and this shading let them be: imagery is on only when there is some, and what the
/// picture does not show is off.
EngineOptions settled(EngineOptions options, const TileSource& source);

/// For pictures of this size.
EarthModel earthOf(const DatasetMetadata& metadata, const EngineOptions& options, int width, int height);

/// None without a time of day. Throws as SunClock does.
std::optional<SunClock> clockOf(const DatasetMetadata& metadata, const EngineOptions& options);

/// Slots on the GPU for the tiles of this dataset.
GpuTilesOptions slotOptions(const TileSource& source, const EngineOptions& options, const EarthModel& earth);

/// Of one tile that waits for upload; photos with their chains take less.
uint64_t pendingTileBytes();

/// Tiles that may wait for upload: what a quarter of main memory's budget holds.
size_t mostPendingTiles(uint64_t hostBudgetBytes);

/// The pager's part of the budget: without those that wait.
PagerOptions withoutPending(PagerOptions options);

/// How many tiles a view may need beside the root, for all of them to come whatever is drawn meanwhile. One slot is the
/// root's. With m of n needed tiles lacking, n - m slots hold the others and at most m what stands in for them (each
/// has one stand-in), so of n + 2 slots one is always free for the next, and nothing that is drawn must go.
size_t tilesBesideRoot(uint32_t slots, uint64_t tiles);

}  // namespace terray
