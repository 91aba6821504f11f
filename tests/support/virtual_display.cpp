#include "tests/support/virtual_display.h"

#include <cstdlib>

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/check.h"

namespace terray {

VirtualDisplay::VirtualDisplay() {
    int ends[2];
    TERRAY_CHECK(pipe(ends) == 0);
    server_ = fork();
    if (server_ == 0) {
        const std::string told = std::to_string(ends[1]);
        const std::string screen = std::to_string(kWidth) + "x" + std::to_string(kHeight) + "x24";
        // A free number of display is chosen, and written to the pipe.
        execlp("Xvfb", "Xvfb", "-displayfd", told.c_str(), "-screen", "0", screen.c_str(), "-nolisten", "tcp",
               "-noreset",  // when the last window closes
               static_cast<char*>(nullptr));
        _exit(127);
    }
    close(ends[1]);
    std::string number;
    for (char digit = 0; read(ends[0], &digit, 1) == 1 && digit != '\n';) number += digit;
    close(ends[0]);
    TERRAY_CHECK(!number.empty());  // no Xvfb: install the package xvfb
    setenv("DISPLAY", (":" + number).c_str(), 1);
    unsetenv("WAYLAND_DISPLAY");
}

VirtualDisplay::~VirtualDisplay() {
    unsetenv("DISPLAY");
    kill(server_, SIGTERM);
    waitpid(server_, nullptr, 0);
}

}  // namespace terray
