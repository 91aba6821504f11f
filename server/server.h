#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/access_log.h"
#include "server/catalogue.h"
#include "server/request_reader.h"

namespace terray::server {

struct ServerOptions {
    std::string listen = "127.0.0.1:8080";  ///< HOST:PORT, "[::1]:8080" for IPv6; port 0: one that is free
    int threads = 1;                        ///< that serve; connections are spread evenly over them
    size_t maxConnections = 8192;
    std::chrono::milliseconds idleTimeout{60000};  ///< without a request, or with an answer that does not move
    std::chrono::milliseconds headTimeout{10000};  ///< for a request to come in
    HeadLimits head;
    uint64_t cacheBytes = uint64_t{256} << 20;  ///< of tiles kept in memory; 0: none, they go straight from the file
    LogFormat log = LogFormat::off;
    int logDescriptor = 1;
};

/// Serves datasets over HTTP/1.1 on threads of its own. The program has to ignore SIGPIPE: sendfile and splice raise it
/// when a client has gone.
///
/// With all connections taken, a new one takes the place of the one that has been idle longest; only if none is idle is
/// it answered 503. See README.md in this folder for what memory that takes.
class Server {
  public:
    /// Binds its addresses. Throws Error(usage) for an address that is none, Error(network) when it cannot be listened
    /// at.
    Server(ServerOptions options, std::shared_ptr<const Catalogue> catalogue);
    /// Ends at once.
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// Addresses it listens at, "127.0.0.1:8080", with the ports that they have.
    [[nodiscard]] std::vector<std::string> addresses() const;
    void start();
    /// Requests that begin from now on see these datasets; those under way end with theirs. Any thread.
    void reload(std::shared_ptr<const Catalogue> catalogue);
    /// Stops listening and ends idle connections; answers under way are sent to their end, for at most `grace`. Any
    /// thread; once more with a shorter grace hurries it.
    void stop(std::chrono::milliseconds grace);
    /// Whether a stop() has come to its end.
    [[nodiscard]] bool hasEnded() const;
    /// Waits for that.
    void join();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace terray::server
