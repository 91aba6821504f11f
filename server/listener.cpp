#include "server/listener.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "common/error.h"

namespace terray::server {
namespace {

constexpr int kBacklog = 4096;
constexpr int kAcceptsInTurn = 64;
constexpr std::chrono::milliseconds kPause{100};  // after the system ran out of descriptors or memory
/// Bytes of a connection that the kernel holds before they are sent, beyond those in flight: what a client that takes
/// nothing can tie up. Large enough that a tile goes out in two or three turns.
constexpr int kUnsentBytes = 256 * 1024;

Error cannotListen(const std::string& address, const std::string& why) {
    return {ExitCode::network, "cannot listen at " + address + ": " + why + "; choose another address with --listen"};
}

void setOption(int socket, int option, int value) {
    ::setsockopt(socket, IPPROTO_TCP, option, &value, sizeof value);  // without it all still works, only slower
}

}  // namespace

ListenAddress parseListenAddress(const std::string& text) {
    const size_t colon = text.rfind(':');
    std::string host = text.substr(0, colon == std::string::npos ? 0 : colon);
    const std::string port = colon == std::string::npos ? "" : text.substr(colon + 1);
    const bool isBracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
    if (isBracketed) host = host.substr(1, host.size() - 2);
    const bool isPort = !port.empty() && port.size() <= 5 &&
                        port.find_first_not_of("0123456789") == std::string::npos && std::stoi(port) <= 65535;
    const bool isBareIpv6 = !isBracketed && host.find(':') != std::string::npos;
    if (host.empty() || isBareIpv6 || !isPort)
        throw Error(ExitCode::usage, "--listen: \"" + text +
                                         "\" is no address to listen at; expected HOST:PORT, such as "
                                         "127.0.0.1:8080, [::1]:8080 or 0.0.0.0:80");
    return {host, port};
}

std::string toText(const Endpoint& endpoint) {
    const std::string host = endpoint.address().to_string();
    const std::string port = ":" + std::to_string(endpoint.port());
    return endpoint.address().is_v6() ? "[" + host + "]" + port : host + port;
}

std::vector<Endpoint> resolve(const ListenAddress& address) {
    asio::io_context context;
    asio::ip::tcp::resolver resolver(context);
    boost::system::error_code error;
    const auto results = resolver.resolve(address.host, address.port, asio::ip::resolver_base::passive, error);
    if (error) throw cannotListen(address.host + ":" + address.port, error.message());
    std::vector<Endpoint> endpoints;
    for (const auto& result : results) endpoints.push_back(result.endpoint());
    return endpoints;
}

Listener::Listener(asio::io_context& context, const Endpoint& endpoint)
    : context_(context), acceptor_(context), pause_(context) {
    boost::system::error_code error;
    acceptor_.open(endpoint.protocol(), error);
    // IPv4 at an IPv6 address would be a surprise: 0.0.0.0 and [::] are two addresses, each to be asked for.
    if (!error && endpoint.address().is_v6()) acceptor_.set_option(asio::ip::v6_only(true), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(kBacklog, error);
    if (!error) acceptor_.native_non_blocking(true, error);
    if (error) throw cannotListen(toText(endpoint), error.message());
}

void Listener::start(std::function<void(int socket, std::string peer)> take) {
    asio::co_spawn(context_.get_executor(), accept(std::move(take)), asio::detached);
}

void Listener::close() {
    asio::post(context_, [this] {
        boost::system::error_code ignored;
        acceptor_.close(ignored);
        pause_.cancel();
    });
}

Awaitable<void> Listener::accept(std::function<void(int socket, std::string peer)> take) {
    boost::system::error_code error;
    while (acceptor_.is_open()) {
        co_await acceptor_.async_wait(asio::socket_base::wait_read, asio::redirect_error(kAwait, error));
        for (int turn = 0; turn < kAcceptsInTurn && acceptor_.is_open(); ++turn) {
            Endpoint peer;
            auto size = static_cast<socklen_t>(peer.capacity());
            const int socket = ::accept4(acceptor_.native_handle(), peer.data(), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
            if (socket >= 0) {
                setOption(socket, TCP_NODELAY, 1);
                setOption(socket, TCP_NOTSENT_LOWAT, kUnsentBytes);
                peer.resize(size);
                take(socket, toText(peer));
                continue;
            }
            const bool isScarce = errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM;
            if (!isScarce) break;  // nobody waits, or the one who did has gone
            std::fprintf(stderr, "terray-server: cannot accept a connection: %s\n", std::strerror(errno));
            pause_.expires_after(kPause);
            co_await pause_.async_wait(asio::redirect_error(kAwait, error));
        }
    }
}

}  // namespace terray::server
