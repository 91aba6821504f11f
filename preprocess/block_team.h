#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <vector>

#include "preprocess/block_record.h"
#include "preprocess/build_observer.h"
#include "preprocess/ranks.h"

namespace terray {

/// What the leader of a build tells all others before they begin.
struct TeamOrders {
    Bytes heading;                        ///< encodeHeading(): what is being built
    std::filesystem::path workDirectory;  ///< on a file system that all share
    std::filesystem::path journal;
    bool isWhole = false;  ///< there is nothing to do
};

/// The blocks of one stage, as those who build them need to know it.
struct TeamStage {
    int jobs = 1;
    const std::atomic<bool>& stop;
    /// Leader: the blocks that are to be built, by their numbers.
    std::vector<size_t> blocks = {};
    /// Leader: where the next tile may lie in the spill.
    std::atomic<uint64_t>& spillEnd;
    /// Called once before the first build() unless no block is left; the leader's ends before the others' begin.
    std::function<void()> begin = {};
    /// Makes a block, whose bytes go to shared files. Called on several threads.
    std::function<BlockRecord(size_t block, int worker)> build = {};
    /// Others than the leader: forces the bytes of a block to the disk. Called on several threads.
    std::function<void(const BlockRecord& record)> sync = {};
    /// Leader: takes a finished block of its own, or one whose bytes another process has synced. Called on several
    /// threads.
    std::function<void(size_t block, const BlockRecord& record, bool isOwn)> keep = {};
    /// Leader: called once all blocks are kept, before the others go on.
    std::function<void()> end = {};
};

/// Who builds the blocks of a dataset: this process alone, or several that share a file system.
///
/// One process leads: it owns the output and the journal, gives out the blocks of a stage one by one to whoever is
/// free, itself among them, and keeps their records. A record counts once the leader has put it into the journal, so
/// whichever process dies, the journal is that of a build that was killed and can be gone on with. The others write
/// the tiles and samples of their blocks into the same files, at places of their own.
class BlockTeam {
  public:
    virtual ~BlockTeam() = default;
    [[nodiscard]] virtual bool leads() const = 0;
    /// All of the team; 1: there is nobody else.
    [[nodiscard]] virtual int processes() const = 0;
    /// Builds all blocks of a stage, and returns when all are kept. Throws what build() threw, here or elsewhere
    /// (the leader: with the name of the process), and Error(interrupted).
    virtual void runStage(const TeamStage& stage) = 0;
    /// Waits until all have come to this point. Throws as runStage(). The thread of the build alone.
    virtual void meet(const std::atomic<bool>& stop) = 0;
    /// A place in the running stage's spill for `bytes` that nobody else writes to. Any thread.
    [[nodiscard]] virtual uint64_t reserve(uint64_t bytes) = 0;
};

/// The part of a spill that one process writes to when several do: whole units, so that no two machines ever write to
/// one page. A network file system's client reads a page, changes its own part of it and writes all of it back.
class SpillShare {
  public:
    /// Greater than any system's pages and blocks.
    static constexpr uint64_t kUnit = uint64_t{2} << 20;

    /// @param more  takes whole units from what all share; returns where they begin
    /// @return      a place for `bytes`. Not thread-safe
    [[nodiscard]] uint64_t take(uint64_t bytes, const std::function<uint64_t(uint64_t bytes)>& more);
    /// Leaves the rest: another spill begins.
    void forget() { left_ = 0; }

  private:
    uint64_t place_ = 0;
    uint64_t left_ = 0;
};

/// The team as its leader sees it.
class TeamLeader final : public BlockTeam {
  public:
    /// @param ranks  the others, who must outlive this; nullptr: there are none
    explicit TeamLeader(Ranks* ranks) : ranks_(ranks) {}

    /// Tells the others what to do, once all of them are there. Throws what one of them failed of, Error(interrupted).
    void begin(const TeamOrders& orders, const std::atomic<bool>& stop);
    [[nodiscard]] bool leads() const override { return true; }
    [[nodiscard]] int processes() const override { return ranks_ == nullptr ? 1 : ranks_->count(); }
    void runStage(const TeamStage& stage) override;
    void meet(const std::atomic<bool>& stop) override;
    [[nodiscard]] uint64_t reserve(uint64_t bytes) override;
    /// Waits until the others have closed all files, and adds what their work took to `times`.
    void part(BuildTimes& times, const std::atomic<bool>& stop);

  private:
    Ranks* ranks_;
    std::atomic<uint64_t>* spillEnd_ = nullptr;  ///< of the running stage; when there are others, at a unit's end
    std::mutex mutex_;
    SpillShare share_;  ///< when there are others; under mutex_
};

/// The team as all others see it.
class TeamMember final : public BlockTeam {
  public:
    explicit TeamMember(Ranks& ranks) : ranks_(ranks) {}

    /// Waits for the leader's orders. Throws Error(interrupted).
    [[nodiscard]] TeamOrders begin(const std::atomic<bool>& stop);
    [[nodiscard]] bool leads() const override { return false; }
    [[nodiscard]] int processes() const override { return ranks_.count(); }
    void runStage(const TeamStage& stage) override;
    void meet(const std::atomic<bool>& stop) override;
    [[nodiscard]] uint64_t reserve(uint64_t bytes) override;
    /// Tells the leader what the work of this process took; it has no file open any more. Waits for all others.
    void part(const BuildTimes& times, const std::atomic<bool>& stop);
    /// Tells the leader why this process cannot go on, so that the user learns of it once, then waits `patience` for
    /// the leader to end all.
    static void giveUp(Ranks& ranks, const std::exception& reason, std::chrono::seconds patience);

  private:
    /// Sends a request and waits for its answer. mutex_ is held.
    [[nodiscard]] Bytes ask(ByteView request, const std::atomic<bool>& stop);
    [[nodiscard]] Bytes askAlone(ByteView request, const std::atomic<bool>& stop);

    Ranks& ranks_;
    std::mutex mutex_;  ///< one request at a time; guards what follows
    const std::atomic<bool>* stop_ = nullptr;
    SpillShare share_;
};

}  // namespace terray
