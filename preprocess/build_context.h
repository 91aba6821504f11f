#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>

#include "preprocess/block_team.h"
#include "preprocess/build_journal.h"
#include "preprocess/build_observer.h"

namespace terray {

/// What the parts of one build share.
struct BuildContext {
    int jobs = 1;
    std::filesystem::path workDirectory;
    const std::atomic<bool>& stop;  ///< set: end with Error(interrupted) soon
    BuildObserver& observer;
    BuildTimes& times;
    BuildJournal& journal;  ///< the leader's, or one that follows it
    BlockTeam& team;
    std::function<void()> firstTileDone;  ///< called when there is something that is worth keeping
    std::mutex mutex = {};                ///< held while a block's record is taken and the observer told
    uint64_t tiles = 0;                   ///< of the whole build so far, as are bytes; under mutex
    uint64_t bytes = 0;
};

}  // namespace terray
