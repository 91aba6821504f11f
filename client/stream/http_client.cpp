#include "client/stream/http_client.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "common/check.h"

namespace terray {
namespace {

using std::chrono::milliseconds;

/// wait() returns after so long in any case.
constexpr int64_t kLongestWaitMs = 2000;
/// A longer Retry-After counts as this: the user may stop waiting, a server's clock may be off.
constexpr int64_t kLongestRetryAfterSeconds = 30;

std::optional<uint64_t> takeNumber(std::string_view& text) {
    uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end == text.data()) return {};
    text.remove_prefix(static_cast<size_t>(end - text.data()));
    return number;
}

bool takeText(std::string_view& text, std::string_view expected) {
    if (!text.starts_with(expected)) return false;
    text.remove_prefix(expected.size());
    return true;
}

struct ContentRange {
    uint64_t first = 0, last = 0, total = 0;
};

/// "bytes FIRST-LAST/TOTAL" (RFC 9110, 14.4).
std::optional<ContentRange> parseContentRange(std::string_view text) {
    if (!takeText(text, "bytes ")) return {};
    const auto first = takeNumber(text);
    if (!first || !takeText(text, "-")) return {};
    const auto last = takeNumber(text);
    if (!last || !takeText(text, "/")) return {};
    const auto total = takeNumber(text);
    if (!total || !text.empty() || *last < *first || *last >= *total) return {};
    return ContentRange{*first, *last, *total};
}

/// What an attempt comes to: an answer, or else why not, and whether another attempt may end differently.
struct Verdict {
    std::optional<HttpAnswer> answer;
    std::string trouble;
    bool mayPass = true;
};

std::string named(const ByteRange& range) {
    return "bytes " + std::to_string(range.offset) + "-" + std::to_string(range.offset + range.length - 1);
}

Verdict judgeRange(const HttpRequest& request, HttpAttempt& attempt) {
    const auto found = parseContentRange(attempt.contentRange);
    const ByteRange& asked = request.range;
    const bool fits = found && found->first == asked.offset &&
                      found->last == std::min(asked.offset + asked.length, found->total) - 1 &&
                      attempt.body.size() == found->last - found->first + 1;
    if (!fits)
        return {.trouble = "asked for " + named(asked) + ", found " + std::to_string(attempt.body.size()) +
                           " bytes with Content-Range \"" + attempt.contentRange + "\""};
    return {.answer = HttpAnswer{std::move(attempt.body), found->total, attempt.etag}};
}

Verdict judge(const HttpRequest& request, HttpAttempt& attempt) {
    const int status = attempt.status;
    if (status == 0) return {.trouble = attempt.trouble, .mayPass = !attempt.hopeless};
    if (status == 206) return judgeRange(request, attempt);
    const std::string found = "found status " + std::to_string(status);
    if (status == 200)
        return {.trouble = found + ", expected 206: the server does not answer range requests", .mayPass = false};
    if (status == 404) return {.trouble = found + ": there is no such file", .mayPass = false};
    const bool passing = status == 408 || status == 425 || status == 429 || (status >= 500 && status != 501);
    return {.trouble = found + ", expected 206", .mayPass = passing};
}

/// Seconds of a Retry-After; one that gives a date, or is none, counts as a second.
std::optional<int64_t> retryAfterSeconds(std::string_view text) {
    if (text.empty()) return {};
    const auto number = takeNumber(text);
    if (!number || !text.empty()) return 1;
    return static_cast<int64_t>(std::min<uint64_t>(*number, kLongestRetryAfterSeconds));
}

}  // namespace

HttpClient::HttpClient(const HttpOptions& options)
    : options_(options), transfers_(options.connections), random_(std::random_device()()) {
    TERRAY_CHECK_OP(options.connections, >, 0);
    TERRAY_CHECK_OP(options.attempts, >, 0);
}

void HttpClient::begin(uint64_t ticket, HttpRequest request) {
    TERRAY_CHECK(open_.emplace(ticket, Open{.request = std::move(request)}).second);
    waiting_.push_back(ticket);
    ++count_.requests;
}

bool HttpClient::cancel(uint64_t ticket) {
    const auto found = open_.find(ticket);
    if (found == open_.end()) return false;
    const auto place = std::find(waiting_.begin(), waiting_.end(), ticket);
    if (place != waiting_.end()) {
        waiting_.erase(place);
    } else if (2 * transfers_.outstanding(ticket) < found->second.request.range.length) {
        return false;
    } else {
        transfers_.abort(ticket);
    }
    open_.erase(found);
    ++count_.cancelled;
    return true;
}

/// Starts what waits and may start, in order, while connections are free.
void HttpClient::startDue(Clock::time_point now) {
    if (now < quietUntil_) return;
    for (auto place = waiting_.begin();
         place != waiting_.end() && transfers_.active() < static_cast<size_t>(options_.connections);) {
        const uint64_t ticket = *place;
        Open& open = open_.at(ticket);
        if (open.notBefore > now) {
            ++place;
            continue;
        }
        if (open.attempts++ == 0)
            open.deadline = now + milliseconds(options_.deadlineMs);
        else
            ++count_.retries;
        const auto left = std::chrono::duration_cast<milliseconds>(open.deadline - now).count();
        transfers_.start(ticket, open.request,
                         {.connectMs = options_.connectMs, .stallSeconds = options_.stallSeconds, .wholeMs = left});
        place = waiting_.erase(place);
    }
}

int64_t HttpClient::msUntilNextStart(Clock::time_point now) const {
    int64_t least = kLongestWaitMs;
    if (transfers_.active() >= static_cast<size_t>(options_.connections)) return least;
    for (const uint64_t ticket : waiting_) {
        const auto start = std::max(open_.at(ticket).notBefore, quietUntil_);
        least = std::min(least, std::chrono::duration_cast<milliseconds>(start - now).count() + 1);
    }
    return std::max<int64_t>(least, 0);
}

/// A pause that doubles with each attempt, less a random half.
milliseconds HttpClient::backOff(int attempts) {
    const int doublings = std::min(attempts - 1, 20);
    const int64_t whole = std::min(options_.longestBackOffMs, options_.firstBackOffMs << doublings);
    return milliseconds(std::uniform_int_distribution<int64_t>(whole / 2, whole)(random_));
}

/// Lets a request wait for its next attempt. @return false when there is none: attempts or time are used up
bool HttpClient::putOff(uint64_t ticket, Open& open, const HttpAttempt& attempt) {
    if (open.attempts >= options_.attempts) return false;
    const auto now = Clock::now();
    open.notBefore = now + backOff(open.attempts);
    if (const auto seconds = retryAfterSeconds(attempt.retryAfter)) {
        quietUntil_ = std::max(quietUntil_, now + std::chrono::seconds(*seconds));
        open.notBefore = std::max(open.notBefore, quietUntil_);
    }
    if (open.notBefore >= open.deadline) return false;
    waiting_.push_front(ticket);
    return true;
}

std::vector<HttpEnd> HttpClient::wait(bool block) {
    startDue(Clock::now());
    std::vector<HttpEnd> ends;
    for (auto& [ticket, attempt] : transfers_.poll(block ? msUntilNextStart(Clock::now()) : 0)) {
        const auto found = open_.find(ticket);
        TERRAY_CHECK(found != open_.end());
        Open& open = found->second;
        Verdict verdict = judge(open.request, attempt);
        if (!verdict.answer && verdict.mayPass && putOff(ticket, open, attempt)) continue;
        if (verdict.answer) {
            ends.push_back({ticket, std::move(*verdict.answer)});
        } else {
            const std::string times =
                open.attempts > 1 ? " (tried " + std::to_string(open.attempts) + " times)" : std::string();
            // Where no answer came at all it is the network's fault, however hopeless.
            ends.push_back({ticket, Failure{"cannot fetch " + open.request.url + ": " + verdict.trouble + times},
                            !verdict.mayPass && attempt.status != 0});
        }
        open_.erase(found);
    }
    startDue(Clock::now());  // connections that have become free do not idle until the next call
    return ends;
}

HttpEnd HttpClient::fetch(HttpRequest request) {
    TERRAY_CHECK(open_.empty());
    begin(0, std::move(request));
    for (;;) {
        std::vector<HttpEnd> ends = wait(true);
        if (!ends.empty()) return std::move(ends.front());
    }
}

HttpStatistics HttpClient::statistics() const {
    HttpStatistics now = count_;
    now.receivedBytes = transfers_.receivedBytes();
    now.connections = transfers_.connectionsOpened();
    return now;
}

}  // namespace terray
