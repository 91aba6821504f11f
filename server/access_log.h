#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

namespace terray::server {

enum class LogFormat { off, text, json };

/// One answered request.
struct LogEntry {
    int64_t unixMilliseconds = 0;  ///< when the answer was done
    std::string_view client;       ///< address and port
    std::string_view method;       ///< as the client sent them: escaped when written
    std::string_view target;
    int status = 0;
    uint64_t bytes = 0;        ///< sent, head and body
    int64_t microseconds = 0;  ///< from the end of the request to the last byte of the answer
    bool whole = true;         ///< whether the answer was sent to its end
};

/// One line for an entry, with its line end. What a client sent can neither end the line nor the field: bytes that are
/// not printable ASCII, quotes and backslashes are percent-escaped.
[[nodiscard]] std::string logLine(const LogEntry& entry, LogFormat format);

/// Writes lines to a descriptor on a thread of its own, so that a slow reader of the log never delays an answer: when
/// 4 MiB wait to be written, further lines are dropped and counted. Thread-safe.
class AccessLog {
  public:
    /// @param dropped  counts lines that were dropped; must live longer
    AccessLog(LogFormat format, int descriptor, std::atomic<uint64_t>& dropped);
    /// Writes what waits, then returns.
    ~AccessLog();
    AccessLog(const AccessLog&) = delete;
    AccessLog& operator=(const AccessLog&) = delete;

    [[nodiscard]] bool isOn() const { return format_ != LogFormat::off; }
    void write(const LogEntry& entry);

  private:
    void run();

    LogFormat format_;
    int descriptor_;
    std::atomic<uint64_t>& dropped_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::string waiting_;
    bool stops_ = false;
    std::thread thread_;  ///< last: begins when all else is there
};

}  // namespace terray::server
