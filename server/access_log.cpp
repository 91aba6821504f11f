#include "server/access_log.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <utility>

#include <unistd.h>

namespace terray::server {
namespace {

constexpr size_t kMostWaiting = size_t{4} << 20;
constexpr std::chrono::milliseconds kGatherTime{100};  // lines of this long are written by one call

std::string escaped(std::string_view text) {
    std::string safe;
    safe.reserve(text.size());
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte > 0x20 && byte < 0x7f && c != '"' && c != '\\') {
            safe += c;
            continue;
        }
        std::array<char, 4> code{};
        std::snprintf(code.data(), code.size(), "%%%02X", byte);
        safe += code.data();
    }
    return safe;
}

/// "2026-11-27T19:07:03.123Z"
std::string isoTime(int64_t unixMilliseconds) {
    const std::time_t seconds = unixMilliseconds / 1000;
    std::tm utc = {};
    ::gmtime_r(&seconds, &utc);
    std::array<char, 40> text{};
    const size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
    std::snprintf(text.data() + length, text.size() - length, ".%03dZ", static_cast<int>(unixMilliseconds % 1000));
    return text.data();
}

void writeAll(int descriptor, std::string_view text) {
    while (!text.empty()) {
        const ssize_t written = ::write(descriptor, text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return;  // nobody reads the log any more: the server serves on
        text.remove_prefix(static_cast<size_t>(written));
    }
}

}  // namespace

std::string logLine(const LogEntry& entry, LogFormat format) {
    const std::string time = isoTime(entry.unixMilliseconds);
    const std::string numbers[] = {std::to_string(entry.status), std::to_string(entry.bytes),
                                   std::to_string(entry.microseconds)};
    if (format == LogFormat::json)
        return "{\"time\":\"" + time + "\",\"client\":\"" + std::string(entry.client) + "\",\"method\":\"" +
               escaped(entry.method) + "\",\"target\":\"" + escaped(entry.target) + "\",\"status\":" + numbers[0] +
               ",\"bytes\":" + numbers[1] + ",\"microseconds\":" + numbers[2] +
               ",\"whole\":" + (entry.whole ? "true" : "false") + "}\n";
    return time + " " + std::string(entry.client) + " \"" + escaped(entry.method) + " " + escaped(entry.target) +
           "\" " + numbers[0] + " " + numbers[1] + " B " + numbers[2] + " us" + (entry.whole ? "" : " cut short") +
           "\n";
}

AccessLog::AccessLog(LogFormat format, int descriptor, std::atomic<uint64_t>& dropped)
    : format_(format), descriptor_(descriptor), dropped_(dropped) {
    if (isOn()) thread_ = std::thread([this] { run(); });
}

AccessLog::~AccessLog() {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        stops_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

void AccessLog::write(const LogEntry& entry) {
    if (!isOn()) return;
    const std::string line = logLine(entry, format_);
    bool wasEmpty = false;
    {
        const std::lock_guard lock(mutex_);
        if (waiting_.size() + line.size() > kMostWaiting) {
            dropped_.fetch_add(1, std::memory_order_relaxed);
            return;
        }
        wasEmpty = waiting_.empty();
        waiting_ += line;
    }
    if (wasEmpty) wake_.notify_one();
}

void AccessLog::run() {
    std::unique_lock lock(mutex_);
    for (;;) {
        wake_.wait(lock, [&] { return stops_ || !waiting_.empty(); });
        if (!stops_) wake_.wait_for(lock, kGatherTime, [&] { return stops_; });
        const std::string lines = std::exchange(waiting_, {});
        const bool isLast = stops_;
        lock.unlock();
        writeAll(descriptor_, lines);
        if (isLast) return;
        lock.lock();
    }
}

}  // namespace terray::server
