#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <cpl_error.h>
#include <gdal_priv.h>

#include "common/error.h"

// What the sources of GDAL's door share. No other file includes it, since it includes GDAL.

namespace terray::gdal {

/// Collects what GDAL says on this thread while it lives, so that nothing reaches the terminal.
class Messages {
  public:
    Messages() { CPLPushErrorHandlerEx(&Messages::take, this); }
    ~Messages() { CPLPopErrorHandler(); }
    Messages(const Messages&) = delete;
    Messages& operator=(const Messages&) = delete;

    [[nodiscard]] bool failed() const { return !failures_.empty(); }
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
    /// All that it said, failures first, as half a sentence.
    [[nodiscard]] std::string text() const {
        std::string joined;
        for (const auto* list : {&failures_, &warnings_})
            for (const std::string& line : *list) joined += (joined.empty() ? "" : "; ") + line;
        return joined.empty() ? "GDAL gives no reason" : "GDAL says: " + joined;
    }

  private:
    static void CPL_STDCALL take(CPLErr kind, CPLErrorNum, const char* message) {
        auto& self = *static_cast<Messages*>(CPLGetErrorHandlerUserData());
        auto& list = kind == CE_Failure || kind == CE_Fatal ? self.failures_ : self.warnings_;
        constexpr size_t kMaxKept = 8;  // a damaged file may say the same for each of a million blocks
        const bool isNews = std::ranges::find(list, message) == list.end();
        if (kind >= CE_Warning && isNews && list.size() < kMaxKept) list.emplace_back(message);
    }
    std::vector<std::string> failures_;
    std::vector<std::string> warnings_;
};

/// Prepares the library once: drivers, silence, sources of VRTs that threads do not share, vertical systems.
void initialise();

[[noreturn]] inline void refuse(const std::string& message) {
    throw Error(ExitCode::input, message);
}

inline GDALDatasetUniquePtr open(const std::string& name) {
    return GDALDatasetUniquePtr(GDALDataset::Open(name.c_str(), GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR));
}

/// A raster that could be opened before.
inline GDALDatasetUniquePtr openSource(const std::string& name, const Messages& messages) {
    GDALDatasetUniquePtr source = open(name);
    if (!source) refuse("cannot open \"" + name + "\" again: " + messages.text());
    return source;
}

}  // namespace terray::gdal
