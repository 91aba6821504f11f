#include "client/render/gpu_timer.h"

namespace terray {

std::string_view name(GpuPass pass) {
    static constexpr std::array<std::string_view, kGpuPasses> kNames = {"upload", "edit",    "id",     "march",
                                                                        "shadow", "resolve", "overlay"};
    return kNames.at(static_cast<size_t>(pass));
}

void GpuTimer::enter(GpuPass pass) {
    marks_.push_back({pass, stamp()});
}

std::array<double, kGpuPasses> GpuTimer::finishFrame() {
    std::array<double, kGpuPasses> milliseconds{};
    if (marks_.empty()) return milliseconds;
    const size_t end = stamp();
    const auto nanoseconds = [&](size_t query) {
        GLuint64 time = 0;
        glGetQueryObjectui64v(pool_[query].name(), GL_QUERY_RESULT, &time);  // waits for the GPU
        return time;
    };
    // A mark's time runs until the next mark's, the last one's until now.
    GLuint64 after = nanoseconds(end);
    for (size_t i = marks_.size(); i-- > 0;) {
        const GLuint64 before = nanoseconds(marks_[i].query);
        milliseconds[static_cast<size_t>(marks_[i].pass)] +=
            static_cast<double>(static_cast<GLint64>(after - before)) * 1e-6;
        after = before;
    }
    marks_.clear();
    used_ = 0;
    return milliseconds;
}

size_t GpuTimer::stamp() {
    if (used_ == pool_.size()) pool_.push_back(makeQuery(GL_TIMESTAMP));
    glQueryCounter(pool_[used_].name(), GL_TIMESTAMP);
    return used_++;
}

}  // namespace terray
