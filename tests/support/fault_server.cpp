#include "tests/support/fault_server.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <optional>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/check.h"

namespace terray {
namespace {

/// Closing now sends a reset.
void resetOnClose(int connection) {
    const linger hard{.l_onoff = 1, .l_linger = 0};
    setsockopt(connection, SOL_SOCKET, SO_LINGER, &hard, sizeof(hard));
}

bool sendAll(int connection, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent <= 0) return false;
        bytes.remove_prefix(static_cast<size_t>(sent));
    }
    return true;
}

/// A request up to its empty line; none once the peer has closed.
std::optional<std::string> receiveHead(int connection) {
    std::string head;
    while (!head.ends_with("\r\n\r\n")) {
        char byte = 0;
        if (::recv(connection, &byte, 1, 0) != 1) return {};
        head += byte;
    }
    return head;
}

struct Answer {
    std::string head;
    std::string body;
};

std::string readFile(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

Answer statusOnly(const std::string& status, const std::string& fields = "") {
    const std::string page = "<p>" + status + "</p>";
    return {"HTTP/1.1 " + status + "\r\nContent-Length: " + std::to_string(page.size()) + "\r\n" + fields + "\r\n",
            page};
}

/// The answer to "Range: bytes=FIRST-LAST", with the faults that concern what it says.
Answer rangeAnswer(const std::string& file, const std::string& head, Fault fault) {
    size_t first = 0, last = 0;
    const size_t field = head.find("Range: bytes=");
    const bool isRange =
        field != std::string::npos && std::sscanf(head.c_str() + field, "Range: bytes=%zu-%zu", &first, &last) == 2;
    const std::string tag = "ETag: \"" + std::to_string(std::hash<std::string>()(file)) + "\"\r\n";
    if (!isRange || fault == Fault::noRanges)
        return {"HTTP/1.1 200 OK\r\nContent-Length: " + std::to_string(file.size()) + "\r\n" + tag + "\r\n", file};
    if (first >= file.size()) return statusOnly("416 Range Not Satisfiable");
    last = std::min(last, file.size() - 1);
    if (fault == Fault::wrongRange && last + 1 < file.size()) {
        ++first;
        ++last;
    }
    std::string body = file.substr(first, last - first + 1);
    if (fault == Fault::wrongLength) body.pop_back();
    if (fault == Fault::corrupt) body[body.size() / 2] = static_cast<char>(body[body.size() / 2] ^ 0x10);
    return {"HTTP/1.1 206 Partial Content\r\nContent-Length: " + std::to_string(body.size()) +
                "\r\nContent-Range: bytes " + std::to_string(first) + "-" + std::to_string(last) + "/" +
                std::to_string(file.size()) + "\r\n" + tag + "\r\n",
            body};
}

}  // namespace

FaultServer::FaultServer(std::filesystem::path root) : root_(std::move(root)) {
    listen();
}

FaultServer::~FaultServer() {
    kill();
}

std::string FaultServer::address() const {
    return "http://127.0.0.1:" + std::to_string(port_);
}

void FaultServer::listen() {
    const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    TERRAY_CHECK_OP(listener, >=, 0);
    const int on = 1;
    setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    place.sin_port = htons(port_);
    socklen_t size = sizeof(place);
    TERRAY_CHECK_OP(::bind(listener, reinterpret_cast<sockaddr*>(&place), size), ==, 0);
    TERRAY_CHECK_OP(::listen(listener, 64), ==, 0);
    TERRAY_CHECK_OP(::getsockname(listener, reinterpret_cast<sockaddr*>(&place), &size), ==, 0);
    port_ = ntohs(place.sin_port);
    stopping_ = false;
    listener_ = listener;
    acceptor_ = std::thread([this, listener] { acceptLoop(listener); });
}

void FaultServer::kill() {
    if (listener_ < 0) return;
    stopping_ = true;
    ::shutdown(listener_, SHUT_RDWR);
    acceptor_.join();
    ::close(listener_);
    listener_ = -1;
    std::vector<std::thread> threads;
    {
        const std::lock_guard lock(mutex_);
        for (const int connection : open_) ::shutdown(connection, SHUT_RDWR);
        threads.swap(threads_);
    }
    for (std::thread& thread : threads) thread.join();
}

void FaultServer::restart() {
    kill();
    listen();
}

void FaultServer::setFault(Fault fault, double chance, uint64_t seed) {
    chance_ = chance;
    seed_ = seed;
    fault_ = fault;
}

std::vector<std::string> FaultServer::paths() const {
    const std::lock_guard lock(mutex_);
    return paths_;
}

void FaultServer::acceptLoop(int listener) {
    for (;;) {
        const int connection = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
        if (connection < 0) return;
        const int on = 1;
        setsockopt(connection, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
        ++connections_;
        const std::lock_guard lock(mutex_);
        open_.insert(connection);
        threads_.emplace_back([this, connection] { serve(connection); });
    }
}

void FaultServer::serve(int connection) {
    for (auto head = receiveHead(connection); head && !stopping_; head = receiveHead(connection)) {
        const int now = ++atATime_;
        for (int most = mostAtATime_; most < now && !mostAtATime_.compare_exchange_weak(most, now);) {
        }
        const bool goesOn = answer(connection, *head);
        --atATime_;
        if (!goesOn) break;
    }
    const std::lock_guard lock(mutex_);
    open_.erase(connection);
    ::close(connection);
}

/// The fault of this request, drawn from its number alone.
Fault FaultServer::nextFault() {
    uint64_t z = (++requests_ + seed_ * 1000003) * 0x9e3779b97f4a7c15ULL;  // SplitMix64's mixer
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z ^= z >> 27;
    const bool fails = static_cast<double>(z >> 11) * 0x1p-53 < chance_;
    const Fault fault = fails ? fault_.load() : Fault::none;
    if (fault != Fault::none) ++faults_;
    return fault;
}

/// @return whether the connection can be used again
bool FaultServer::answer(int connection, const std::string& head) {
    const std::string path = head.substr(4, head.find(' ', 4) - 4);
    {
        const std::lock_guard lock(mutex_);
        paths_.push_back(path);
    }
    const Fault fault = nextFault();
    if (delayMs_ > 0) std::this_thread::sleep_for(std::chrono::milliseconds(delayMs_));
    if (fault == Fault::refuse) {
        resetOnClose(connection);
        return false;
    }
    const std::filesystem::path file = root_ / path.substr(1, path.find('?') - 1);
    const Answer answer = fault == Fault::status500   ? statusOnly("500 Internal Server Error")
                          : fault == Fault::status503 ? statusOnly("503 Service Unavailable", "Retry-After: 1\r\n")
                          : !std::filesystem::is_regular_file(file) ? statusOnly("404 Not Found")
                                                                    : rangeAnswer(readFile(file), head, fault);
    if (!sendAll(connection, answer.head)) return false;
    const bool half = fault == Fault::reset || fault == Fault::truncate || fault == Fault::stall;
    const std::string_view body = answer.body;
    if (fault == Fault::trickle) return trickle(connection, body);
    if (!sendAll(connection, half ? body.substr(0, body.size() / 2) : body)) return false;
    if (fault == Fault::stall) stallUntilOver(fault);
    if (fault == Fault::reset || fault == Fault::stall) resetOnClose(connection);
    return !half;
}

void FaultServer::stallUntilOver(Fault fault) const {
    while (!stopping_ && fault_ == fault) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

/// @return whether all of it has gone
bool FaultServer::trickle(int connection, std::string_view body) const {
    while (!body.empty() && !stopping_ && fault_ == Fault::trickle) {
        if (!sendAll(connection, body.substr(0, 1))) return false;
        body.remove_prefix(1);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return sendAll(connection, body);
}

}  // namespace terray
