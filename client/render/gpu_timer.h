#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "client/render/gl_objects.h"

namespace terray {

/// The passes whose GPU time is reported apart. edit: uploads of tiles that edits change, from codes to pyramid.
enum class GpuPass : uint8_t { upload, edit, id, march, shadow, resolve, overlay };
inline constexpr size_t kGpuPasses = 7;
[[nodiscard]] std::string_view name(GpuPass pass);

/// GPU time of each pass of a frame, by GL timestamp queries. A pass may be entered many times in a frame; its times
/// add up.
///
/// Results are read when the caller asks for them: finishFrame() waits for the GPU. GL thread only.
class GpuTimer {
  public:
    /// From now on time belongs to `pass`, until the next call or finishFrame().
    void enter(GpuPass pass);
    /// Milliseconds of each pass since the last finishFrame().
    [[nodiscard]] std::array<double, kGpuPasses> finishFrame();

  private:
    struct Mark {
        GpuPass pass;
        size_t query;
    };
    size_t stamp();
    std::vector<GlQuery> pool_;
    size_t used_ = 0;
    std::vector<Mark> marks_;
};

}  // namespace terray
