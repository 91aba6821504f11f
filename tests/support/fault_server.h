#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace terray {

/// What goes wrong with an answer.
enum class Fault {
    none,
    refuse,    ///< the connection is reset instead of an answer
    reset,     ///< and reset in the middle of the body
    truncate,  ///< the connection ends in order in the middle of the body
    corrupt,   ///< one byte of the body is another
    stall,     ///< nothing comes after half of the body, until the fault is over
    trickle,   ///< the body comes byte by byte, 50 a second, until the fault is over
    status500,
    status503,    ///< with Retry-After: 1
    wrongLength,  ///< Content-Length and body are one byte shorter than Content-Range says
    wrongRange,   ///< the bytes after those that were asked for, and Content-Range says so
    noRanges,     ///< 200 with the whole file
};

/// A web server on the loopback that offers a directory's files by range requests, and fails on order. Its own code on
/// plain sockets, so that it shares no mistakes with what it tests; one thread a connection.
class FaultServer {
  public:
    /// Starts to serve on a free port.
    explicit FaultServer(std::filesystem::path root);
    ~FaultServer();
    FaultServer(const FaultServer&) = delete;
    FaultServer& operator=(const FaultServer&) = delete;

    /// "http://127.0.0.1:PORT", the same after a restart.
    [[nodiscard]] std::string address() const;
    /// From now on answers fail so, each with a chance that is drawn from the number of the request and this seed.
    void setFault(Fault fault, double chance = 1, uint64_t seed = 1);
    /// As a killed server: connections are reset, new ones refused.
    void kill();
    void restart();

    [[nodiscard]] uint64_t requests() const { return requests_; }
    [[nodiscard]] uint64_t connections() const { return connections_; }
    [[nodiscard]] uint64_t faults() const { return faults_; }  ///< answers that failed
    [[nodiscard]] int mostAtATime() const { return mostAtATime_; }
    /// Each answer takes so long to begin.
    void setDelayMs(int milliseconds) { delayMs_ = milliseconds; }
    /// The paths asked for so far, in order.
    [[nodiscard]] std::vector<std::string> paths() const;

  private:
    void listen();
    void acceptLoop(int listener);
    void serve(int connection);
    [[nodiscard]] bool answer(int connection, const std::string& head);
    [[nodiscard]] Fault nextFault();
    void stallUntilOver(Fault fault) const;
    [[nodiscard]] bool trickle(int connection, std::string_view body) const;

    const std::filesystem::path root_;
    uint16_t port_ = 0;
    std::atomic<int> listener_ = -1;
    std::thread acceptor_;
    mutable std::mutex mutex_;
    std::vector<std::thread> threads_;
    std::set<int> open_;
    std::vector<std::string> paths_;
    std::atomic<bool> stopping_ = false;
    std::atomic<Fault> fault_ = Fault::none;
    std::atomic<double> chance_ = 0;
    std::atomic<uint64_t> seed_ = 1;
    std::atomic<uint64_t> requests_ = 0, connections_ = 0, faults_ = 0;
    std::atomic<int> atATime_ = 0, mostAtATime_ = 0, delayMs_ = 0;
};

}  // namespace terray
