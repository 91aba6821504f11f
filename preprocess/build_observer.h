#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

namespace terray {

/// What a build tells while it runs. Called from several threads, one call at a time.
class BuildObserver {
  public:
    virtual ~BuildObserver() = default;
    /// A decision that the user should know of.
    virtual void note(const std::string& text) = 0;
    /// A stage of `blocks` blocks begins, such as "heights 7 to 4"; an earlier run did `done` of them.
    virtual void stageBegins(const std::string& name, uint64_t blocks, uint64_t done) = 0;
    /// One more block of the current stage is done; tiles and payload bytes so far, of the whole build.
    virtual void blockDone(uint64_t tiles, uint64_t bytes) = 0;
    /// All stages are done, or the build has failed.
    virtual void end() {}
};

/// Says nothing.
class SilentObserver final : public BuildObserver {
  public:
    void note(const std::string&) override {}
    void stageBegins(const std::string&, uint64_t, uint64_t) override {}
    void blockDone(uint64_t, uint64_t) override {}
};

/// Where the time of a build goes, summed over all threads. `warp` is reading through a resampling, which draws its
/// samples from the files as it needs them, so that their reading is part of it.
enum class BuildStep { read, warp, reduce, encode, write };
inline constexpr std::array<const char*, 5> kBuildStepNames = {"read", "warp", "reduce", "encode", "write"};

class BuildTimes {
  public:
    void add(BuildStep step, std::chrono::nanoseconds time) { nanoseconds_[static_cast<size_t>(step)] += time.count(); }
    [[nodiscard]] double seconds(BuildStep step) const {
        return static_cast<double>(nanoseconds_[static_cast<size_t>(step)]) * 1e-9;
    }

  private:
    std::array<std::atomic<int64_t>, kBuildStepNames.size()> nanoseconds_{};
};

/// Adds its own lifetime to a step.
class StepTimer {
  public:
    StepTimer(BuildTimes& times, BuildStep step) : times_(times), step_(step) {}
    ~StepTimer() { times_.add(step_, std::chrono::steady_clock::now() - start_); }
    StepTimer(const StepTimer&) = delete;
    StepTimer& operator=(const StepTimer&) = delete;

  private:
    BuildTimes& times_;
    BuildStep step_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace terray
