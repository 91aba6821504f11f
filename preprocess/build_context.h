#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>

#include "preprocess/block_plan.h"
#include "preprocess/build_observer.h"
#include "preprocess/tile_spill.h"

namespace terray {

/// What the parts of one build share.
struct BuildContext {
    int jobs = 1;
    std::filesystem::path workDirectory;
    const std::atomic<bool>& stop;  ///< set: end with Error(interrupted) soon
    BuildObserver& observer;
    BuildTimes& times;
    std::mutex observerMutex = {};
    uint64_t tiles = 0;  ///< of the whole build so far, as are bytes; under observerMutex
    uint64_t bytes = 0;
};

/// Runs build(top, worker) for every block of a stage, on context.jobs threads, and tells the observer.
void runStage(BuildContext& context, const std::string& what, const PyramidExtent& extent, const BlockStage& stage,
              const std::function<void(const TileId& top, int worker)>& build);

/// Adds a finished tile to the spill and counts it.
void storeTile(BuildContext& context, TileSpill& spill, const TileId& id, ByteView payload);

}  // namespace terray
