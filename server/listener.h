#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "server/worker.h"

namespace terray::server {

/// HOST:PORT taken apart; the host of "[::1]:8080" is "::1".
struct ListenAddress {
    std::string host;
    std::string port;
};
/// Throws Error(usage).
[[nodiscard]] ListenAddress parseListenAddress(const std::string& text);

using Endpoint = asio::ip::tcp::endpoint;
/// "127.0.0.1:8080", "[::1]:8080".
[[nodiscard]] std::string toText(const Endpoint& endpoint);

/// One address that is listened at. Runs on the context that it is given.
class Listener {
  public:
    /// Throws Error(network) when it cannot be listened at.
    Listener(asio::io_context& context, const Endpoint& endpoint);

    [[nodiscard]] Endpoint endpoint() const { return acceptor_.local_endpoint(); }
    /// Accepts until close(). @param take  gets each socket, which never blocks, with its client's address
    void start(std::function<void(int socket, std::string peer)> take);
    /// Any thread.
    void close();

  private:
    Awaitable<void> accept(std::function<void(int socket, std::string peer)> take);

    asio::io_context& context_;
    asio::basic_socket_acceptor<asio::ip::tcp, Executor> acceptor_;
    asio::basic_waitable_timer<Clock, asio::wait_traits<Clock>, Executor> pause_;
};

/// All endpoints that an address stands for. Throws Error(network) when its host is unknown.
[[nodiscard]] std::vector<Endpoint> resolve(const ListenAddress& address);

}  // namespace terray::server
