#include "client/engine/upload_pace.h"

#include <algorithm>

namespace terray {
namespace {

constexpr uint64_t kFirstBytes = 1 << 20;
/// Frames over which what was learnt fades.
constexpr double kFrames = 8;

}  // namespace

uint64_t UploadPace::bytes() const {
    if (msPerByte_ == 0) return std::min(mostBytes_, kFirstBytes);
    const double affordable = share_ * otherMs_ / msPerByte_;
    return affordable < static_cast<double>(mostBytes_) ? static_cast<uint64_t>(affordable) : mostBytes_;
}

void UploadPace::learn(double uploadMs, uint64_t uploadedBytes, double otherMs) {
    otherMs_ += (otherMs - otherMs_) / (otherMs_ == 0 ? 1 : kFrames);
    if (uploadedBytes == 0) return;
    const double now = uploadMs / static_cast<double>(uploadedBytes);
    msPerByte_ = now > msPerByte_ ? now : msPerByte_ + (now - msPerByte_) / kFrames;
}

}  // namespace terray
