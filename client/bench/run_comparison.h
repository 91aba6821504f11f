#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/json.h"

namespace terray {

// Two runs of `terray-bench replay` or of `terray-bench error`, one held against the other.

/// What a run left in its directory.
struct RecordedRun {
    std::filesystem::path directory;
    Json manifest;
    Json summary;
};
/// Throws Error(input) when manifest or summary is missing or is no JSON object.
[[nodiscard]] RecordedRun readRun(const std::filesystem::path& directory);

/// Why the figures of two runs do not compare, as "what: found in A, found in B" each; empty: they do. Alike must be
/// program, dataset's content, flight, protocol, and the sweep with its settings.
[[nodiscard]] std::vector<std::string> unlikenesses(const RecordedRun& a, const RecordedRun& b);
/// What else differs, likewise: build, machine, graphics, options. It is what the figures then tell about.
[[nodiscard]] std::vector<std::string> differences(const RecordedRun& a, const RecordedRun& b);

/// A number that both runs may have.
struct Figure {
    std::string setting;  ///< of a run with several settings, else empty
    std::string name;     ///< "column.statistic"
    std::optional<double> a;
    std::optional<double> b;

    /// b over a; equal numbers have 1, else a number over 0 has an infinity. None where a number is missing.
    [[nodiscard]] std::optional<double> ratio() const;
    /// For people: the name with its setting.
    [[nodiscard]] std::string title() const;
};
/// All figures of two runs that are alike, in A's order.
[[nodiscard]] std::vector<Figure> figuresOf(const RecordedRun& a, const RecordedRun& b);

/// A limit that B shall keep.
struct Threshold {
    std::string figure;  ///< "column.statistic"; holds for each setting
    bool above = true;   ///< crossed by what is greater; else by what is less
    double limit = 0;
    bool ratio = false;  ///< of b over a, else of b alone
};
/// Reads "frame_ms.median>1.1x,see_through.sum>0": figure, > or <, a number; with an x a ratio. Throws Error(usage)
/// saying which part is wrong.
[[nodiscard]] std::vector<Threshold> thresholdsFrom(const std::string& text);

/// The figures that cross a threshold, as sentences. Throws Error(usage) when no figure has a threshold's name or when
/// it has no value to judge by: what cannot be judged has not passed.
[[nodiscard]] std::vector<std::string> crossings(const std::vector<Threshold>& thresholds,
                                                 const std::vector<Figure>& figures);

}  // namespace terray
