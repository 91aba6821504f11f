#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "client/bench/error_measurement.h"
#include "client/bench/error_split.h"
#include "common/json.h"

namespace terray {

// What is written of a measurement of errors; columns are documented in client/README.md, "Error against run time".

/// The text of errors.csv: a line of column names, then one for each setting, of which there is at least one.
[[nodiscard]] std::string errorTable(const std::vector<ErrorResult>& results);
/// One setting of summary.json.
[[nodiscard]] Json toJson(const ErrorResult& result);
/// For people, one line.
[[nodiscard]] std::string lineOf(const ErrorResult& result);

/// The text of split.csv, likewise, a line for each cause; a number that does not exist is an empty field.
[[nodiscard]] std::string splitTable(const std::vector<CauseResult>& results);
/// As a setting of summary.json: its name is the cause's.
[[nodiscard]] Json toJson(const CauseResult& result);
[[nodiscard]] std::string lineOf(const CauseResult& result);

/// Writes the errors of a frame as map_SETTING_FRAME.png (black 0 to white 1 pixel; magenta: see-through, blue: covers
/// sky) and .exr (error.pixels, depth.metres; NaN where there is no ground). Throws Error(output); not to be called in
/// a build without pictures. @param errors  of all pixels, row by row
void writeErrorMaps(const std::filesystem::path& folder, const std::string& setting, int frame, GridSize size,
                    const std::vector<PixelError>& errors);

}  // namespace terray
