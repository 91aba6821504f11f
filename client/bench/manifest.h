#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "client/render/gl_context.h"
#include "client/stream/dataset_source.h"
#include "client/stream/flight.h"
#include "common/json.h"

namespace terray {

/// Version, commit, whether tracked files differed from it, compiler and kind of build.
[[nodiscard]] Json describeBuild();
/// Processor, cores, main memory and kernel, as Linux tells them; null where it does not.
[[nodiscard]] Json describeMachine();
[[nodiscard]] Json describeGraphics(const GlStrings& strings);
/// A file's path and CRC-32C. Throws Error(input) when it cannot be read.
[[nodiscard]] Json describeFile(const std::filesystem::path& path);
/// What a run was made of: enough to repeat it, and to say whether another is like it.
struct RunDescription {
    std::string program;
    std::filesystem::path dataset;
    const TileSource& source;
    std::filesystem::path flightFile;
    const Flight& flight;
    Json protocol;  ///< how it was measured: runs compare only when theirs is the same
    Json options;   ///< what was measured
};
[[nodiscard]] Json describeRun(const RunDescription& run, const GlStrings& graphics, const std::string& started);
/// Now, "2026-01-31T12:00:00Z".
[[nodiscard]] std::string utcNow();
/// The most main memory that this process has held so far, bytes.
[[nodiscard]] uint64_t peakResidentBytes();

/// Writes a JSON file whole or not at all. Throws Error(output) when it cannot be written.
void writeJson(const std::filesystem::path& path, const Json& json);

}  // namespace terray
