#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace terray {

/// What the last frames cost, for a graph and its percentiles.
class FrameHistory {
  public:
    static constexpr size_t kFrames = 240;
    static constexpr double kRateSeconds = 2;

    /// @param seconds  when, on a clock that does not go back  @param bytesRead  in all, so far
    void add(double milliseconds, double seconds, uint64_t bytesRead);

    /// Oldest first, at most kFrames.
    [[nodiscard]] std::vector<float> milliseconds() const;
    /// Nearest rank over the same; 0 without frames. @param percent  0 .. 100
    [[nodiscard]] double percentileMs(double percent) const;
    /// Bytes a second over the last kRateSeconds before `seconds`.
    [[nodiscard]] double bytesPerSecond(double seconds) const;

  private:
    struct Frame {
        double ms = 0;
        double seconds = 0;
        uint64_t bytesRead = 0;
    };
    std::vector<Frame> frames_;  ///< oldest first
};

}  // namespace terray
