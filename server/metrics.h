#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

namespace terray::server {

/// What the server has done since it began. Counted by all its threads at once.
struct Metrics {
    /// Upper bounds of the histogram of answering times, seconds; one more bucket beyond them.
    static constexpr std::array<double, 7> kSecondBounds = {0.0001, 0.0005, 0.001, 0.01, 0.1, 1, 10};

    std::array<std::atomic<uint64_t>, 6> answers{};  ///< by status / 100
    std::atomic<uint64_t> bytesSent = 0;             ///< heads and bodies
    std::atomic<uint64_t> cutShort = 0;              ///< answers whose client left, or took too long, before the end
    std::array<std::atomic<uint64_t>, kSecondBounds.size() + 1> seconds{};  ///< answers by time, not cumulated
    std::atomic<uint64_t> microseconds = 0;                                 ///< of all answers together

    std::atomic<int64_t> connectionsOpen = 0;
    std::atomic<uint64_t> connectionsAccepted = 0;
    std::atomic<uint64_t> connectionsRefused = 0;  ///< with 503, because there were too many
    std::atomic<uint64_t> connectionsEvicted = 0;  ///< idle ones closed to make room for new ones
    std::atomic<uint64_t> connectionsExpired = 0;  ///< idle, or too slow, for too long
    std::atomic<uint64_t> tileHits = 0;            ///< tiles that were kept
    std::atomic<uint64_t> tileReads = 0;           ///< tiles read because a client asked
    std::atomic<uint64_t> tileJoins = 0;           ///< requests that joined a read under way
    std::atomic<uint64_t> tileEvictions = 0;       ///< tiles dropped to stay within the budget
    std::atomic<uint64_t> aheadReads = 0;          ///< tiles read before anyone asked
    std::atomic<uint64_t> aheadUsed = 0;           ///< of them, those asked for while kept
    std::atomic<uint64_t> cacheBytes = 0;          ///< kept now

    std::atomic<uint64_t> reloads = 0;
    std::atomic<uint64_t> logLinesDropped = 0;

    /// Counts one answer, however far it was sent.
    void count(int status, uint64_t bytes, std::chrono::microseconds time, bool whole);
};

/// The counters in Prometheus' text format, version 0.0.4.
[[nodiscard]] std::string prometheusText(const Metrics& metrics, size_t datasets);

}  // namespace terray::server
