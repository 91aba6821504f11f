#include "tests/server/raw_client.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/check.h"

namespace terray::server {
namespace {

constexpr int kTimeoutSeconds = 10;

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

int connectTo(const sockaddr* address, socklen_t size) {
    const int socket = ::socket(address->sa_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const timeval timeout = {.tv_sec = kTimeoutSeconds, .tv_usec = 0};
    ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    TERRAY_CHECK_OP(::connect(socket, address, size), ==, 0);
    return socket;
}

/// Status line and fields; none when it breaks the grammar.
std::optional<RawAnswer> parseHead(std::string_view head) {
    RawAnswer answer;
    const size_t lineEnd = head.find("\r\n");
    const std::string line(head.substr(0, lineEnd));
    if (!line.starts_with("HTTP/1.1 ") || line.size() < 13 || line[12] != ' ') return {};
    answer.status = std::stoi(line.substr(9, 3));
    head.remove_prefix(lineEnd + 2);
    while (!head.empty()) {
        const size_t end = head.find("\r\n");
        const std::string_view field = head.substr(0, end);
        const size_t colon = field.find(": ");
        if (end == std::string_view::npos || colon == std::string_view::npos) return {};
        const bool isNew =
            answer.fields.emplace(lower(std::string(field.substr(0, colon))), std::string(field.substr(colon + 2)))
                .second;
        if (!isNew) return {};
        head.remove_prefix(end + 2);
    }
    return answer;
}

}  // namespace

RawClient::RawClient(uint16_t port, const std::string& host) {
    sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons(port), .sin_addr = {}, .sin_zero = {}};
    sockaddr_in6 address6 = {};
    address6.sin6_family = AF_INET6;
    address6.sin6_port = htons(port);
    if (::inet_pton(AF_INET, host.c_str(), &address.sin_addr) == 1) {
        socket_ = connectTo(reinterpret_cast<const sockaddr*>(&address), sizeof address);
    } else {
        TERRAY_CHECK_OP(::inet_pton(AF_INET6, host.c_str(), &address6.sin6_addr), ==, 1);
        socket_ = connectTo(reinterpret_cast<const sockaddr*>(&address6), sizeof address6);
    }
}

RawClient::RawClient(RawClient&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), received_(std::move(other.received_)) {}

RawClient::~RawClient() {
    if (socket_ >= 0) ::close(socket_);
}

void RawClient::send(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent <= 0) return;  // the server has ended the connection; what follows will show it
        bytes.remove_prefix(static_cast<size_t>(sent));
    }
}

void RawClient::request(const std::string& method, const std::string& target, const std::string& fields) {
    send(method + " " + target + " HTTP/1.1\r\nHost: test\r\n" + fields + "\r\n");
}

bool RawClient::receive() {
    std::array<char, 65536> buffer;
    const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), 0);
    if (count > 0) received_.append(buffer.data(), static_cast<size_t>(count));
    return count > 0;
}

std::optional<RawAnswer> RawClient::answer(const std::string& method) {
    size_t end = 0;
    while ((end = received_.find("\r\n\r\n")) == std::string::npos)
        if (!receive()) return {};
    auto answer = parseHead(std::string_view(received_).substr(0, end + 2));
    received_.erase(0, end + 4);
    if (!answer || method == "HEAD" || answer->status == 204 || answer->status == 304) return answer;
    const size_t length = std::stoull(answer->field("content-length"));
    while (received_.size() < length)
        if (!receive()) return {};
    answer->body = received_.substr(0, length);
    received_.erase(0, length);
    return answer;
}

RawAnswer RawClient::ask(const std::string& method, const std::string& target, const std::string& fields) {
    request(method, target, fields);
    auto found = answer(method);
    TERRAY_CHECK(found.has_value());
    return *std::move(found);
}

bool RawClient::isEnded() {
    std::array<char, 65536> buffer;
    ssize_t count = 0;
    while ((count = ::recv(socket_, buffer.data(), buffer.size(), 0)) > 0) {
    }
    return count == 0 || errno == ECONNRESET;
}

size_t RawClient::drop(size_t most) {
    std::string buffer(most, '\0');
    const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), 0);
    return count > 0 ? static_cast<size_t>(count) : 0;
}

void RawClient::abort() {
    const linger hard = {.l_onoff = 1, .l_linger = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &hard, sizeof hard);
    ::close(std::exchange(socket_, -1));
}

}  // namespace terray::server
