#pragma once

#include <chrono>
#include <cstdint>
#include <list>
#include <random>
#include <string>
#include <unordered_map>
#include <vector>

#include "client/stream/http_transfers.h"
#include "common/result.h"

namespace terray {

struct HttpOptions {
    int connections = 8;  ///< transfers at a time
    int attempts = 6;     ///< at one request
    int64_t connectMs = 5000;
    int64_t stallSeconds = 5;      ///< without a byte, then the attempt is given up
    int64_t deadlineMs = 30000;    ///< of a request with all its attempts, from the start of its first
    int64_t firstBackOffMs = 100;  ///< doubled from attempt to attempt; a random half of it is left out
    int64_t longestBackOffMs = 5000;
};

/// The bytes that were asked for.
struct HttpAnswer {
    Bytes body;
    uint64_t totalBytes = 0;  ///< of the whole file
    std::string etag;         ///< empty: the server names none
};

/// How a request ended.
struct HttpEnd {
    uint64_t ticket = 0;
    Result<HttpAnswer> answer;
    bool reachable = true;  ///< false: the failure is the network's or the server's of the moment, later it may be had
};

struct HttpStatistics {
    uint64_t requests = 0;  ///< begun
    uint64_t retries = 0;   ///< further attempts
    uint64_t cancelled = 0;
    uint64_t receivedBytes = 0;  ///< of bodies, whether they were of use or not
    uint64_t connections = 0;    ///< opened
};

/// Requests for bytes of files on web servers, settled exactly once each: answered, failed, or cancelled.
///
/// At most options.connections transfers run at a time, in the order of begin(). What fails for the moment (no
/// connection, a body cut short, a stall, status 408, 425, 429 or 5xx, a wrong Content-Range) is tried again after a
/// pause that doubles from attempt to attempt, of which a random half is left out so that clients of a restarted server
/// do not come back at once; a Retry-After makes all requests pause at least so long. Other answers, such as 404, or
/// 200 from a server that knows no ranges, fail at once. One thread, but for wake().
class HttpClient {
  public:
    explicit HttpClient(const HttpOptions& options);

    /// @param ticket  names the request; of none that is open
    void begin(uint64_t ticket, HttpRequest request);
    /// @return true: it will not end any more. False: less than half of its bytes are to come, so it goes on.
    [[nodiscard]] bool cancel(uint64_t ticket);
    /// Drives the requests. @param block  until one ends, wake() is called, or some seconds are over
    [[nodiscard]] std::vector<HttpEnd> wait(bool block);
    /// Ends a wait() that runs, or else the next one. Any thread.
    void wake() { transfers_.wake(); }

    /// One request, for a thread that has nothing else to do; none may be open.
    [[nodiscard]] HttpEnd fetch(HttpRequest request);
    [[nodiscard]] HttpStatistics statistics() const;

  private:
    using Clock = std::chrono::steady_clock;
    struct Open {
        HttpRequest request;
        int attempts = 0;            ///< begun
        Clock::time_point deadline;  ///< known from the first attempt on
        Clock::time_point notBefore;
    };
    void startDue(Clock::time_point now);
    [[nodiscard]] int64_t msUntilNextStart(Clock::time_point now) const;
    [[nodiscard]] bool putOff(uint64_t ticket, Open& open, const HttpAttempt& attempt);
    [[nodiscard]] std::chrono::milliseconds backOff(int attempts);

    HttpOptions options_;
    HttpTransfers transfers_;
    std::unordered_map<uint64_t, Open> open_;
    std::list<uint64_t> waiting_;   ///< open and not under way, in the order in which they may start
    Clock::time_point quietUntil_;  ///< by a server's Retry-After
    std::mt19937 random_;
    HttpStatistics count_;
};

}  // namespace terray
