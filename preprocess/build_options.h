#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "common/command_line.h"
#include "preprocess/commands.h"
#include "preprocess/dataset_builder.h"
#include "preprocess/progress.h"

// What the commands that build a dataset have in common: build, synth and extract.

namespace terray {

/// The options that shape a result, as text for the dataset's metadata.
class OptionsText {
  public:
    explicit OptionsText(std::string command) : text_(std::move(command)) {}

    void add(const std::string& name, double value);
    void add(const std::string& name, const std::string& value) { text_ += " " + name + " " + value; }
    void add(const std::string& flag) { text_ += " " + flag; }
    [[nodiscard]] const std::string& text() const { return text_; }

  private:
    std::string text_;
};

/// Options that they share.
struct SharedOptions {
    std::string out;
    Ranks* ranks = nullptr;  ///< BuildRequest::ranks
    int64_t jobs = machineJobs();
    uint64_t memoryBytes = uint64_t{1} << 30;
    std::optional<double> maxHeightError;  ///< metres
    bool force = false;
    bool resume = false;
    bool dryRun = false;
    bool quiet = false;
    bool jsonProgress = false;

    /// @param others  that run the same command; nullptr: there are none
    explicit SharedOptions(Ranks* others = nullptr);
    void declare(CommandLine& line);
    /// Refuses what can be refused before any work.
    void check() const;
    /// Whether this process is the one that makes the output and says what happens.
    [[nodiscard]] bool leads() const { return ranks == nullptr || ranks->rank() == 0; }
    /// Those that show in the dataset, as text for its metadata.
    void describe(OptionsText& text) const;
    [[nodiscard]] ProgressStyle style() const;
    [[nodiscard]] BuildRequest request(const std::string& optionsText, const std::atomic<bool>& stop,
                                       BuildObserver& observer) const;
};

/// "west,south,east,north" in metres, as --bbox gives them. Throws Error(usage).
[[nodiscard]] GroundRect parseBounds(const std::string& text);

/// Builds, or only estimates (--dry-run), and says on stdout what came of it.
void buildOrEstimate(const HeightSource& heights, const OpenPhoto& openPhoto, const BuildRequest& request,
                     const SharedOptions& shared);

}  // namespace terray
