#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "client/bench/ray_statistics.h"
#include "client/engine/engine.h"
#include "common/json.h"
#include "common/output_file.h"

namespace terray {

/// Everything that is recorded of one frame of a replay.
struct FrameMeasurement {
    size_t index = 0;
    double seconds = 0;  ///< on the flight's clock
    Camera camera;
    FrameReport report;
    PagerStatistics pagerBefore;        ///< at the end of the frame before
    std::optional<RayStatistics> rays;  ///< none with --no-statistics
};

/// The table frames.csv: one line a frame, written as the flight goes on under a temporary name. Columns are
/// documented in client/README.md, "Replay output"; a value that does not exist is an empty field.
/// All functions throw Error(output) when the file cannot be written.
class FrameTable {
  public:
    explicit FrameTable(const std::filesystem::path& path);

    void add(const FrameMeasurement& frame);
    /// Gives the file its name.
    void finish();

    /// Count, median, p95, p99 (nearest rank), mean, min, max and sum of each measured column, by name. Columns without
    /// any value are left out.
    [[nodiscard]] Json summary() const;
    /// The median of a column, 0 when it has no values.
    [[nodiscard]] double median(const std::string& column) const;
    [[nodiscard]] double sum(const std::string& column) const;
    [[nodiscard]] double max(const std::string& column) const;

    /// The first line of the file without its end.
    [[nodiscard]] static std::string header();

  private:
    [[nodiscard]] const std::vector<double>& values(const std::string& column) const;
    void write(const std::string& line);

    std::filesystem::path path_;
    OutputFile file_;
    std::vector<std::vector<double>> values_;  ///< by column, those that exist
};

}  // namespace terray
