#pragma once

#include <memory>

#include "common/json.h"
#include "preprocess/build_observer.h"
#include "preprocess/dataset_builder.h"

namespace terray {

/// How a program tells of a build.
enum class ProgressStyle {
    automatic,  ///< to stderr: a bar when it is a terminal, else one line for each stage
    json,       ///< to stdout: one JSON object for each line, with the member "event"
    silent
};

[[nodiscard]] std::unique_ptr<BuildObserver> makeObserver(ProgressStyle style);

/// Says on stdout what was built: tiles, bytes, time by step, errors by level. Nothing when silent.
void printSummary(const BuildSummary& summary, ProgressStyle style);

/// "1.4 MB": bytes with a decimal unit, for people.
[[nodiscard]] std::string readableBytes(uint64_t bytes);
/// "0.012": a number with a few significant digits, for people.
[[nodiscard]] std::string readableNumber(double number);

}  // namespace terray
