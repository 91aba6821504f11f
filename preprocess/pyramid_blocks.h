#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/pmtiles.h"
#include "preprocess/block_plan.h"
#include "preprocess/block_record.h"
#include "preprocess/build_context.h"
#include "preprocess/raster_source.h"
#include "preprocess/work_file.h"

namespace terray {

/// One pyramid of a build in work: its finished tiles, in the order in which threads happen to finish them, and which
/// of its blocks are done.
///
/// What an earlier run did is taken from the journal, the rest is built; either way the rest of the build learns of a
/// block from its BlockRecord alone. Memory: some 30 bytes for each block of the pyramid (a block has up to 85 tiles),
/// nothing for a tile.
class PyramidBlocks {
  public:
    /// @param context  must outlive this
    PyramidBlocks(Pyramid pyramid, const PyramidExtent& extent, BuildContext& context);

    /// What a stage does.
    struct StageWork {
        /// Called once before the first build(), not when all blocks were done by an earlier run. May be empty.
        std::function<void()> begin = {};
        /// Makes a block; the record's tiles are those that it stored. Called on several threads.
        std::function<void(BlockRecord& record, int worker)> build;
        /// Takes the record of a block that is done, also of an earlier run or by another process; one call at a time.
        std::function<void(const BlockRecord& record)> take;
        /// Written by build() beside the tiles; on the disk before a block counts as done. May be nullptr.
        WorkFile* level = nullptr;
    };
    /// Runs every block of a stage that is not done yet, with the others of the team, and returns when all are done.
    /// Throws what build() throws, Error(interrupted), Error(output).
    void runStage(const BlockStage& stage, const StageWork& work);

    /// Makes a source ready for reading (HeightSource::prepare and the photo's), in a directory that release() removes.
    template <class Source>
    void prepare(const Source& source) {
        source.prepare(workspace());
    }
    /// Called when no reader of this process is open any more; waits for all processes of the build.
    void release();
    /// Takes a level between two stages off the disk, once nobody reads it any more.
    void discard(WorkFile& level);

    /// Adds a finished tile to a block in work. Thread-safe for different records.
    void store(BlockRecord& record, const TileId& id, ByteView payload);

    /// All tiles of all stages that ran, by Hilbert id, for writePmtiles(). Payloads end with Error(interrupted) once
    /// the build is to stop.
    [[nodiscard]] PmtilesContents contents();
    [[nodiscard]] uint64_t tiles() const { return tiles_; }
    [[nodiscard]] uint64_t bytes() const { return bytes_; }
    /// Takes the tiles off the disk, once they are elsewhere.
    void discard() { spill_.discard(); }

  private:
    struct Stage {
        BlockStage stage;
        std::vector<uint64_t> places;  ///< in the journal, by block in Hilbert order; 0: not done
    };
    void forEachTile(const std::function<void(const StoredTile&)>& visit) const;
    [[nodiscard]] BlockRecord recordAt(uint64_t place) const;
    void lead(const BlockStage& stage, const StageWork& work, const std::vector<TileId>& blocks,
              std::span<WorkFile* const> data, TeamStage& task);
    void follow(const BlockStage& stage, const StageWork& work, std::span<WorkFile* const> data, TeamStage& task);
    /// Records of this pyramid, in the order in which they came into the journal.
    void forEachRecord(const std::function<void(uint64_t place, const BlockRecord& record)>& visit) const;
    /// Takes what earlier runs did of a stage. @return blocks
    uint64_t takeUp(const std::vector<TileId>& blocks, Stage& stage, const StageWork& work);
    void count(const BlockRecord& record);
    [[nodiscard]] std::filesystem::path workspaceDirectory() const;
    [[nodiscard]] SourceWorkspace workspace() const;

    Pyramid pyramid_;
    PyramidExtent extent_;
    BuildContext& context_;
    WorkFile spill_;
    std::atomic<uint64_t> spillEnd_ = 0;
    std::map<uint32_t, std::vector<uint64_t>> found_;  ///< places of an earlier run's blocks, by the stage's bottom
    std::vector<Stage> stages_;
    uint64_t tiles_ = 0;  ///< under the context's mutex, as are bytes
    uint64_t bytes_ = 0;
};

}  // namespace terray
