#include "client/stream/http_transfers.h"

#include <algorithm>
#include <csignal>
#include <mutex>
#include <unordered_map>

#include <curl/curl.h>
#include <pthread.h>
#include <signal.h>

#include "common/check.h"

namespace terray {
namespace {

constexpr long kRedirects = 5;
constexpr long kReceiveBufferBytes = 128 << 10;

/// Keeps SIGPIPE from this thread: a TLS library that writes to a closed connection would else end the program.
class WithoutPipeSignal {
  public:
    WithoutPipeSignal() {
        sigemptyset(&pipe_);
        sigaddset(&pipe_, SIGPIPE);
        pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
    }
    ~WithoutPipeSignal() {
        const timespec now{};
        while (sigtimedwait(&pipe_, nullptr, &now) == SIGPIPE) {
        }
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    }
    WithoutPipeSignal(const WithoutPipeSignal&) = delete;
    WithoutPipeSignal& operator=(const WithoutPipeSignal&) = delete;

  private:
    sigset_t pipe_{}, before_{};
};

struct Transfer {
    CURL* handle = nullptr;
    curl_slist* headers = nullptr;
    uint64_t asked = 0;
    uint64_t* received = nullptr;  ///< counts for all transfers
    Bytes body;
    char error[CURL_ERROR_SIZE] = {};

    Transfer() = default;
    ~Transfer() {
        curl_easy_cleanup(handle);
        curl_slist_free_all(headers);
    }
    Transfer(const Transfer&) = delete;
    Transfer& operator=(const Transfer&) = delete;
};

template <class Value>
void set(CURL* handle, CURLoption option, Value value) {
    TERRAY_CHECK_OP(curl_easy_setopt(handle, option, value), ==, CURLE_OK);
}

long statusOf(CURL* handle) {
    long status = 0;
    curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &status);
    return status;
}

/// Takes body bytes. What is no 206, such as the page that explains an error, is read past while it is short, so that
/// the connection can be used again; a server that sends a whole archive in place of a range is cut off.
size_t takeBody(char* data, size_t one, size_t count, void* user) {
    constexpr size_t kLongestPage = 64 << 10;
    auto& transfer = *static_cast<Transfer*>(user);
    const size_t bytes = one * count;
    *transfer.received += bytes;
    const bool wanted = statusOf(transfer.handle) == 206;
    if (transfer.body.size() + bytes > (wanted ? transfer.asked : kLongestPage)) return 0;
    const auto* first = reinterpret_cast<const std::byte*>(data);
    transfer.body.insert(transfer.body.end(), first, first + bytes);
    return bytes;
}

std::string headerOf(CURL* handle, const char* name) {
    curl_header* header = nullptr;
    constexpr int kLastAnswer = -1;
    return curl_easy_header(handle, name, 0, CURLH_HEADER, kLastAnswer, &header) == CURLHE_OK ? header->value : "";
}

bool isHopeless(CURLcode code) {
    constexpr CURLcode kHopeless[] = {CURLE_UNSUPPORTED_PROTOCOL, CURLE_URL_MALFORMAT, CURLE_TOO_MANY_REDIRECTS,
                                      CURLE_PEER_FAILED_VERIFICATION, CURLE_SSL_CACERT_BADFILE};
    return std::find(std::begin(kHopeless), std::end(kHopeless), code) != std::end(kHopeless);
}

HttpAttempt attemptOf(Transfer& transfer, CURLcode code) {
    CURL* handle = transfer.handle;
    HttpAttempt attempt{.contentRange = headerOf(handle, "Content-Range"),
                        .etag = headerOf(handle, "ETag"),
                        .retryAfter = headerOf(handle, "Retry-After")};
    const auto status = static_cast<int>(statusOf(handle));
    // A body that was cut off because it is no range still tells its status.
    if (code == CURLE_OK || (code == CURLE_WRITE_ERROR && status != 206)) {
        attempt.status = status;
        if (status == 206) attempt.body = std::move(transfer.body);
        return attempt;
    }
    attempt.trouble = code == CURLE_WRITE_ERROR ? "more bytes came than were asked for"
                      : transfer.error[0] != 0  ? transfer.error
                                                : curl_easy_strerror(code);
    attempt.hopeless = isHopeless(code);
    return attempt;
}

}  // namespace

struct HttpTransfers::State {
    CURLM* multi = nullptr;
    std::unordered_map<uint64_t, std::unique_ptr<Transfer>> transfers;
    uint64_t received = 0;
    uint64_t connections = 0;

    /// Takes a transfer out, with its connection closed unless it has ended well.
    std::unique_ptr<Transfer> remove(uint64_t ticket) {
        const auto found = transfers.find(ticket);
        TERRAY_CHECK(found != transfers.end());
        std::unique_ptr<Transfer> transfer = std::move(found->second);
        transfers.erase(found);
        long opened = 0;
        curl_easy_getinfo(transfer->handle, CURLINFO_NUM_CONNECTS, &opened);
        connections += static_cast<uint64_t>(opened);
        curl_multi_remove_handle(multi, transfer->handle);
        return transfer;
    }
};

HttpTransfers::HttpTransfers(int connections) : state_(std::make_unique<State>()) {
    static std::once_flag once;
    std::call_once(once, [] { TERRAY_CHECK_OP(curl_global_init(CURL_GLOBAL_DEFAULT), ==, CURLE_OK); });
    state_->multi = curl_multi_init();
    TERRAY_CHECK(state_->multi != nullptr);
    curl_multi_setopt(state_->multi, CURLMOPT_MAXCONNECTS, static_cast<long>(connections));
}

HttpTransfers::~HttpTransfers() {
    const WithoutPipeSignal guard;
    while (!state_->transfers.empty()) (void)state_->remove(state_->transfers.begin()->first);
    curl_multi_cleanup(state_->multi);
}

void HttpTransfers::start(uint64_t ticket, const HttpRequest& request, const HttpTimes& times) {
    TERRAY_CHECK_OP(request.range.length, >, uint64_t{0});
    auto transfer = std::make_unique<Transfer>();
    CURL* handle = transfer->handle = curl_easy_init();
    TERRAY_CHECK(handle != nullptr);
    transfer->asked = request.range.length;
    transfer->received = &state_->received;
    transfer->body.reserve(std::min<uint64_t>(request.range.length, 1 << 20));
    const std::string range =
        std::to_string(request.range.offset) + "-" + std::to_string(request.range.offset + request.range.length - 1);
    set(handle, CURLOPT_URL, request.url.c_str());
    set(handle, CURLOPT_RANGE, range.c_str());
    set(handle, CURLOPT_USERAGENT, "terray");
    if (request.fresh) {
        transfer->headers = curl_slist_append(nullptr, "Cache-Control: no-cache");
        set(handle, CURLOPT_HTTPHEADER, transfer->headers);
    }
    set(handle, CURLOPT_PROTOCOLS_STR, "http,https");
    set(handle, CURLOPT_REDIR_PROTOCOLS_STR, request.url.starts_with("https:") ? "https" : "http,https");
    set(handle, CURLOPT_FOLLOWLOCATION, 1L);
    set(handle, CURLOPT_MAXREDIRS, kRedirects);
    set(handle, CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(times.connectMs));
    set(handle, CURLOPT_LOW_SPEED_LIMIT, 1L);
    set(handle, CURLOPT_LOW_SPEED_TIME, static_cast<long>(times.stallSeconds));
    set(handle, CURLOPT_TIMEOUT_MS, static_cast<long>(std::max<int64_t>(1, times.wholeMs)));
    set(handle, CURLOPT_BUFFERSIZE, kReceiveBufferBytes);
    set(handle, CURLOPT_NOSIGNAL, 1L);
    set(handle, CURLOPT_ERRORBUFFER, &transfer->error[0]);
    set(handle, CURLOPT_WRITEFUNCTION, &takeBody);
    set(handle, CURLOPT_WRITEDATA, static_cast<void*>(transfer.get()));
    set(handle, CURLOPT_PRIVATE, reinterpret_cast<char*>(ticket));
    TERRAY_CHECK_OP(curl_multi_add_handle(state_->multi, handle), ==, CURLM_OK);
    TERRAY_CHECK(state_->transfers.emplace(ticket, std::move(transfer)).second);
}

void HttpTransfers::abort(uint64_t ticket) {
    const WithoutPipeSignal guard;
    (void)state_->remove(ticket);
}

uint64_t HttpTransfers::outstanding(uint64_t ticket) const {
    const Transfer& transfer = *state_->transfers.at(ticket);
    return transfer.asked - std::min<uint64_t>(transfer.asked, transfer.body.size());
}

std::vector<std::pair<uint64_t, HttpAttempt>> HttpTransfers::poll(int64_t timeoutMs) {
    const WithoutPipeSignal guard;
    std::vector<std::pair<uint64_t, HttpAttempt>> ended;
    const auto perform = [&] {
        int running = 0;
        TERRAY_CHECK_OP(curl_multi_perform(state_->multi, &running), ==, CURLM_OK);
        int left = 0;
        while (const CURLMsg* message = curl_multi_info_read(state_->multi, &left)) {
            if (message->msg != CURLMSG_DONE) continue;
            const CURLcode code = message->data.result;  // the message does not outlive the handle
            char* number = nullptr;
            curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &number);
            const auto ticket = reinterpret_cast<uint64_t>(number);
            const auto transfer = state_->remove(ticket);
            ended.emplace_back(ticket, attemptOf(*transfer, code));
        }
    };
    perform();
    if (!ended.empty()) return ended;
    TERRAY_CHECK_OP(curl_multi_poll(state_->multi, nullptr, 0, static_cast<int>(timeoutMs), nullptr), ==, CURLM_OK);
    perform();
    return ended;
}

void HttpTransfers::wake() {
    curl_multi_wakeup(state_->multi);
}

size_t HttpTransfers::active() const {
    return state_->transfers.size();
}

uint64_t HttpTransfers::receivedBytes() const {
    return state_->received;
}

uint64_t HttpTransfers::connectionsOpened() const {
    return state_->connections;
}

}  // namespace terray
