#include "server/connection.h"

#include <algorithm>
#include <utility>

#include <boost/asio/async_result.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <sys/socket.h>

#include "server/responder.h"

namespace terray::server {
namespace {

using Outcome = IoStep::Outcome;

/// An answer must move by this much within the idle time-out: with 60 s at least 1.1 kB/s. A client that takes a byte a
/// second would otherwise hold its connection for ever.
constexpr uint64_t kPaceBytes = 64 * 1024;
constexpr size_t kFileChunk = size_t{1} << 20;  // sent at most before other connections have their turn
constexpr std::chrono::milliseconds kLingerTime{2000};

std::chrono::microseconds since(Clock::time_point begin) {
    return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin);
}

int64_t unixMilliseconds() {
    return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

iovec pieceOf(std::string_view text) {
    return {const_cast<char*>(text.data()), text.size()};  // sendmsg only reads it
}

}  // namespace

Connection::Connection(Worker& worker, Socket socket, std::string peer)
    : worker_(worker), socket_(std::move(socket)), peer_(std::move(peer)), reader_(worker.limits().head) {
    extendDeadline(worker.limits().idleTimeout);
}

Connection::~Connection() {
    worker_.forget(*this);
}

void Connection::checkDeadline(Clock::time_point now) {
    if (ends_ || now < deadline_) return;
    worker_.shared().metrics.connectionsExpired.fetch_add(1, std::memory_order_relaxed);
    end();
}

void Connection::end() {
    ends_ = true;
    boost::system::error_code ignored;
    socket_.cancel(ignored);
}

Awaitable<void> Connection::serve(std::shared_ptr<Connection> self) {
    for (;;) {
        const Head head = co_await self->receiveHead();
        if (std::holds_alternative<Ended>(head)) co_return;
        const bool goesOn = co_await self->answer(head);
        if (!goesOn) break;
        // Requests that wait in the buffer do not go before those of other connections.
        if (!self->reader_.empty()) co_await asio::post(self->socket_.get_executor(), kAwait);
    }
    if (!self->failed_) co_await self->linger();
}

Awaitable<bool> Connection::wait(Socket::wait_type type) {
    boost::system::error_code error;
    if (!ends_) co_await socket_.async_wait(type, asio::redirect_error(kAwait, error));
    co_return !ends_ && !error;
}

Awaitable<bool> Connection::waitForRequest() {
    if (!reader_.empty()) {
        co_return co_await wait(Socket::wait_read);
    }
    if (worker_.isStopping()) co_return false;
    extendDeadline(worker_.limits().idleTimeout);
    const auto place = worker_.idle().insert(worker_.idle().end(), this);
    const bool ready = co_await wait(Socket::wait_read);
    worker_.idle().erase(place);
    co_return ready;
}

Awaitable<Connection::Head> Connection::receiveHead() {
    for (;;) {
        auto next = reader_.next();
        if (auto* request = std::get_if<Request>(&next)) co_return std::move(*request);
        if (auto* reason = std::get_if<Refusal>(&next)) co_return std::move(*reason);
        const bool ready = co_await waitForRequest();
        const bool isLate = !ready && !reader_.empty() && Clock::now() >= deadline_;
        if (isLate) co_return Refusal{408, "the head of the request took too long"};
        if (!ready) co_return Ended{};
        const std::span<char> buffer = worker_.scratch();
        const IoStep step = receiveSome(socket_.native_handle(), buffer);
        if (step.outcome == Outcome::ended) co_return Ended{};
        if (step.outcome == Outcome::wouldBlock) continue;
        if (reader_.empty()) extendDeadline(worker_.limits().headTimeout);
        reader_.append({buffer.data(), step.bytes});
    }
}

Awaitable<bool> Connection::answer(const Head& head) {
    const auto begin = Clock::now();
    const auto* request = std::get_if<Request>(&head);
    Response response;
    if (request != nullptr) {
        response = respond(*request, *worker_.catalogue(), worker_.shared().metrics);
    } else {
        const auto& reason = std::get<Refusal>(head);
        response = refusal(reason.status, reason.message);
        response.closes = true;
        ends_ = false;  // a head that came too late is still answered
    }
    TileBytes tile;
    const auto* slice = std::get_if<ArchiveSlice>(&response.body);
    if (worker_.shared().tiles != nullptr && slice != nullptr && slice->tile && response.bytesToSend() > 0) {
        // A name for it: GCC 12 destroys a temporary argument of an awaited call twice.
        const StoredTile stored{slice->archive, *slice->tile, slice->range};
        tile = worker_.shared().tiles->find(stored);
        if (!tile) tile = co_await fetch(stored);
        if (!tile)
            response = refusal(
                500, "the tile cannot be read, or memory is short; the server's operator should verify the dataset");
    }
    const bool keepAlive = !response.closes && !worker_.isStopping();
    const HeadContext context = {
        .version = request != nullptr ? request->version : 11, .keepAlive = keepAlive, .date = worker_.date()};
    std::string text = writeHead(response, context);
    co_await send(response, std::move(text), std::move(tile));
    account(request, response.status, since(begin));
    co_return keepAlive && !failed_;
}

void Connection::account(const Request* request, int status, std::chrono::microseconds time) {
    worker_.shared().metrics.count(status, sent_, time, !failed_);
    if (!worker_.shared().log->isOn()) return;
    worker_.shared().log->write({.unixMilliseconds = unixMilliseconds(),
                                 .client = peer_,
                                 .method = request != nullptr ? request->method : "-",
                                 .target = request != nullptr ? request->target : "-",
                                 .status = status,
                                 .bytes = sent_,
                                 .microseconds = time.count(),
                                 .whole = !failed_});
}

Awaitable<TileBytes> Connection::fetch(const StoredTile& tile) {
    TileStore& tiles = *worker_.shared().tiles;
    // A reader's thread brings the bytes; the coroutine goes on with them on its own.
    const auto begin = [&](auto handler) {
        const auto resume = std::make_shared<decltype(handler)>(std::move(handler));
        tiles.read(tile, [resume, executor = socket_.get_executor()](TileBytes bytes) {
            asio::post(executor, [resume, bytes = std::move(bytes)]() mutable { (*resume)(std::move(bytes)); });
        });
    };
    co_return co_await asio::async_initiate<decltype(kAwait), void(TileBytes)>(begin, kAwait);
}

Awaitable<void> Connection::send(const Response& response, std::string head, TileBytes tile) {
    sent_ = paced_ = 0;
    extendDeadline(worker_.limits().idleTimeout);
    const bool hasBody = response.bytesToSend() > 0;
    const auto* slice = hasBody ? std::get_if<ArchiveSlice>(&response.body) : nullptr;
    const auto* text = hasBody ? std::get_if<std::string>(&response.body) : nullptr;
    // A client that has to be waited for gets the rest from the file: only clients that keep up hold tiles in memory.
    const size_t atOnce = tile ? sendAtOnce(head, *tile) : 0;
    const bool isDone = tile && atOnce == head.size() + tile->size();
    tile.reset();
    if (isDone) co_return;
    std::array<iovec, 2> pieces = {pieceOf(std::string_view(head).substr(std::min(atOnce, head.size()))),
                                   text != nullptr ? pieceOf(*text) : iovec{}};
    co_await sendPieces(pieces, slice != nullptr);
    if (slice != nullptr && !failed_) {
        const size_t done = atOnce - std::min(atOnce, head.size());
        co_await sendSlice(*slice, done);
    }
}

size_t Connection::sendAtOnce(std::string_view head, const KeptTile& tile) {
    const IoStep step = worker_.pageSender().send(socket_.native_handle(), head, tile.bytes());
    if (step.outcome == Outcome::ended) failed_ = true;
    sent_ = paced_ = step.bytes;
    return step.bytes;
}

Awaitable<void> Connection::sendPieces(std::span<iovec> pieces, bool moreFollows) {
    while (!failed_) {
        while (!pieces.empty() && pieces.front().iov_len == 0) pieces = pieces.subspan(1);
        if (pieces.empty()) co_return;
        const IoStep step = sendSome(socket_.native_handle(), pieces, moreFollows);
        size_t left = step.bytes;
        for (iovec& piece : pieces) {
            const size_t taken = std::min(left, piece.iov_len);
            piece.iov_base = static_cast<char*>(piece.iov_base) + taken;
            piece.iov_len -= taken;
            left -= taken;
        }
        co_await proceed(step);
    }
}

Awaitable<void> Connection::sendSlice(const ArchiveSlice& slice, uint64_t done) {
    const int file = slice.archive->descriptor();
    while (!failed_ && done < slice.range.length) {
        const size_t chunk = std::min<uint64_t>(slice.range.length - done, kFileChunk);
        const IoStep step = sendFileSome(socket_.native_handle(), file, slice.range.offset + done, chunk);
        done += step.bytes;
        co_await proceed(step);
        if (step.bytes == kFileChunk) co_await asio::post(socket_.get_executor(), kAwait);
    }
}

Awaitable<void> Connection::proceed(IoStep step) {
    sent_ += step.bytes;
    if (sent_ - paced_ >= kPaceBytes) {
        paced_ = sent_;
        extendDeadline(worker_.limits().idleTimeout);
    }
    if (step.outcome == Outcome::wouldBlock) {
        const bool ready = co_await wait(Socket::wait_write);
        if (!ready) failed_ = true;
    }
    if (step.outcome == Outcome::ended || ends_) failed_ = true;
}

Awaitable<void> Connection::linger() {
    ::shutdown(socket_.native_handle(), SHUT_WR);
    extendDeadline(kLingerTime);
    constexpr size_t kMostBytes = size_t{1} << 20;
    for (size_t read = 0; read < kMostBytes;) {
        const bool ready = co_await wait(Socket::wait_read);
        if (!ready) co_return;
        const IoStep step = receiveSome(socket_.native_handle(), worker_.scratch());
        if (step.outcome == Outcome::ended) co_return;
        read += step.bytes;
    }
}

}  // namespace terray::server
