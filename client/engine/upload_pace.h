#pragma once

#include <cstdint>

namespace terray {

/// How much a frame may upload, by what uploads have cost so far: frames that take in tiles then take little longer
/// than others. What costs more is believed at once, what costs less by and by. One thread.
class UploadPace {
  public:
    /// @param mostBytes  of a frame in any case
    /// @param share      of the time that the rest of a frame takes, for uploads
    UploadPace(uint64_t mostBytes, double share) : mostBytes_(mostBytes), share_(share) {}

    /// For the next frame; before anything is known of uploads, a mebibyte at most.
    [[nodiscard]] uint64_t bytes() const;
    /// What a frame came to. @param uploadMs  for its uploads  @param otherMs  for all the rest
    void learn(double uploadMs, uint64_t uploadedBytes, double otherMs);

  private:
    uint64_t mostBytes_;
    double share_;
    double msPerByte_ = 0;  ///< 0: not known yet
    double otherMs_ = 0;
};

}  // namespace terray
