#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/bytes.h"
#include "common/pmtiles.h"

namespace terray {

/// A GET of some bytes of a file on a web server.
struct HttpRequest {
    std::string url;
    ByteRange range;     ///< not empty; the file may end within it
    bool fresh = false;  ///< caches on the way shall ask the server, since what they gave before was damaged
};

/// Times that one attempt may take.
struct HttpTimes {
    int64_t connectMs = 5000;
    int64_t stallSeconds = 5;  ///< without a byte
    int64_t wholeMs = 30000;
};

/// How one attempt at a request ended.
struct HttpAttempt {
    int status = 0;         ///< HTTP's, of a whole answer; 0: there was none
    std::string trouble;    ///< if so, why
    bool hopeless = false;  ///< and trying again cannot help: a bad address, an unknown certificate
    Bytes body;             ///< of a 206 only, never longer than was asked for
    std::string contentRange, etag, retryAfter;  ///< header fields, empty where there is none
};

/// Many transfers side by side, one attempt each: the door to libcurl. Connections are kept and used again; redirects
/// are followed, at most five, never from https to http. One thread, but for wake().
class HttpTransfers {
  public:
    /// @param connections  kept open when idle
    explicit HttpTransfers(int connections);
    ~HttpTransfers();  ///< aborts what is under way
    HttpTransfers(const HttpTransfers&) = delete;
    HttpTransfers& operator=(const HttpTransfers&) = delete;

    /// @param ticket  names the transfer; of none that is under way
    void start(uint64_t ticket, const HttpRequest& request, const HttpTimes& times);
    /// Ends a transfer without an answer. Its connection is closed, too, where it does not carry others.
    void abort(uint64_t ticket);
    /// Body bytes of a transfer under way that have not come yet.
    [[nodiscard]] uint64_t outstanding(uint64_t ticket) const;
    /// Drives the transfers until one ends, wake() is called or the time is over. @return those that have ended
    [[nodiscard]] std::vector<std::pair<uint64_t, HttpAttempt>> poll(int64_t timeoutMs);
    /// Ends a poll() that runs, or else the next one. Any thread.
    void wake();

    [[nodiscard]] size_t active() const;
    [[nodiscard]] uint64_t receivedBytes() const;  ///< of bodies, whether they were of use or not
    [[nodiscard]] uint64_t connectionsOpened() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace terray
