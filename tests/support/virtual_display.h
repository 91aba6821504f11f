#pragma once

#include <string>

#include <sys/types.h>

namespace terray {

/// An X server without a screen (Xvfb) that this process's windows open on, 1600 x 1000, for as long as the object
/// lives. Stops the test program when there is none to be had: Debian's package is xvfb.
class VirtualDisplay {
  public:
    VirtualDisplay();
    ~VirtualDisplay();
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;

    static constexpr int kWidth = 1600;
    static constexpr int kHeight = 1000;

  private:
    pid_t server_ = -1;
};

}  // namespace terray
