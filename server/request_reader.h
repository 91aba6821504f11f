#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>

#include "server/http_message.h"

namespace terray::server {

/// Bounds on what a client may send before it is answered.
struct HeadLimits {
    size_t lineBytes = 4096;  ///< method, target and version; longer: 414
    size_t headBytes = 8192;  ///< that line and all fields; longer: 431
};

/// The head is not whole yet: append() more.
struct NeedMore {};
/// What came is no request: to be answered with this status, after which the connection ends.
struct Refusal {
    int status = 400;
    std::string message;
};

/// Cuts what arrives on one connection into requests, however it is split into pieces; pipelined requests come out in
/// their order. The only file that knows Boost.Beast's parser. No sockets here.
///
/// Holds at most headBytes and the last piece appended, and nothing between requests.
class RequestReader {
  public:
    explicit RequestReader(HeadLimits limits = {}) : limits_(limits) {}

    void append(std::string_view piece) { pending_.append(piece); }
    /// The next request, if whole. Not to be called again after a Refusal.
    [[nodiscard]] std::variant<NeedMore, Request, Refusal> next();
    /// Whether nothing of a next request has come.
    [[nodiscard]] bool empty() const { return pending_.empty(); }

  private:
    void drop(size_t count);

    HeadLimits limits_;
    std::string pending_;
    size_t scanned_ = 0;  ///< bytes of pending_ known to hold no end of a head
};

}  // namespace terray::server
