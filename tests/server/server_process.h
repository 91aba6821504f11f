#pragma once
// terray-server as a process of its own, at a free port of 127.0.0.1.

#include <cstdint>
#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/common/temporary_directory.h"

namespace terray::server {

class ServerProcess {
  public:
    /// Starts it and waits until it listens. @param arguments  all but --listen
    explicit ServerProcess(const std::vector<std::string>& arguments);
    /// Kills it if it still runs.
    ~ServerProcess();
    ServerProcess(const ServerProcess&) = delete;
    ServerProcess& operator=(const ServerProcess&) = delete;

    [[nodiscard]] uint16_t port() const { return port_; }
    [[nodiscard]] pid_t id() const { return id_; }
    void signal(int number) const;
    /// Waits until stderr has a text; stops the test program after 20 s.
    void waitForNotice(const std::string& text) const;
    /// Waits for its end. @return its exit code, -1 when a signal ended it
    int wait();
    [[nodiscard]] std::string out() const;
    [[nodiscard]] std::string err() const;

  private:
    test::TemporaryDirectory directory_;
    pid_t id_ = -1;
    uint16_t port_ = 0;
};

}  // namespace terray::server
