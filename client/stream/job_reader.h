#pragma once

#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "client/stream/pager_job.h"
#include "client/stream/tile_reads.h"

namespace terray {

using TileKeySet = std::unordered_set<TileKey, TileKeyHash>;

/// The jobs of which something is being read: the IO thread's part of the pager. One thread, but for wake().
class JobReader {
  public:
    using JobPtr = std::unique_ptr<TileJob>;

    explicit JobReader(std::unique_ptr<TileReads> reads) : reads_(std::move(reads)) {}

    [[nodiscard]] bool mayHeal() const { return reads_->mayHeal(); }
    [[nodiscard]] bool hasRoom() const { return jobs_.size() < reads_->atATime(); }
    /// Begins to read all parts that are to be read.
    void begin(JobPtr job);
    /// Takes back reads for jobs whose request is not among `wanted`. @return jobs that nothing is read for any more
    [[nodiscard]] std::vector<JobPtr> cancelUnless(const TileKeySet& wanted);
    /// Drives the reads; a part that could not be read is read once more. @param block  until something happens
    /// @return jobs whose reads have all ended; `unreachable` is set where the source could not answer
    [[nodiscard]] std::vector<JobPtr> wait(bool block);
    void wake() { reads_->wake(); }

    [[nodiscard]] uint64_t payloadBytes() const { return payloadBytes_; }  ///< of tiles read so far
    [[nodiscard]] TileReadStatistics statistics() const { return reads_->statistics(); }

  private:
    struct Reading {
        JobPtr job;
        std::unordered_map<uint64_t, size_t> parts;  ///< being read, by ticket
        bool hopeless = false;                       ///< one is lost, or the source cannot answer: no more is begun
    };
    void beginPart(Reading& reading, size_t part);
    void take(TileRead read);
    void cancelParts(Reading& reading);
    [[nodiscard]] std::vector<JobPtr> takeEnded();

    std::unique_ptr<TileReads> reads_;
    std::unordered_map<TileKey, Reading, TileKeyHash> jobs_;
    std::unordered_map<uint64_t, TileKey> tickets_;  ///< whose job each read is for
    uint64_t lastTicket_ = 0;
    uint64_t payloadBytes_ = 0;
};

}  // namespace terray
