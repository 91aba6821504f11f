#pragma once
// What this program is and from which sources it was built, for --version, dataset metadata and benchmark manifests.

#include <string_view>

namespace terray {

struct BuildInfo {
    std::string_view version;   ///< of the project, "major.minor.patch"
    std::string_view commit;    ///< 40 hex digits, or "unknown" when built outside a git checkout
    bool dirty;                 ///< tracked files differed from the commit when this was built
    std::string_view compiler;  ///< name and version, such as "GNU 12.2.0"
    std::string_view build;     ///< CMake's build type, then the sanitizers if any, such as "Release"
};

/// The one description of this build; its source is written by the build itself (scripts/write_version.cmake).
[[nodiscard]] const BuildInfo& buildInfo();

}  // namespace terray
