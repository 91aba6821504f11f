#include "server/worker.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "server/connection.h"
#include "server/http_message.h"
#include "server/socket_io.h"

namespace terray::server {
namespace {

constexpr std::chrono::milliseconds kWatchInterval{250};  // deadlines are kept to within this
constexpr auto kRelaxed = std::memory_order_relaxed;

/// Tells a client that there is no room, as far as that goes without waiting, and closes.
void refuse(int socket) {
    Response response = refusal(503, "too many connections; try again in a moment");
    response.addField("Retry-After", "1");
    const std::string text = writeHead(response, {.keepAlive = false, .date = imfDate(std::time(nullptr))}) +
                             std::get<std::string>(response.body);
    // What the client has sent already is read first: closing with bytes unread would throw the answer away.
    std::array<char, 4096> request;
    (void)receiveSome(socket, request);
    const iovec piece = {const_cast<char*>(text.data()), text.size()};
    (void)sendSome(socket, {&piece, 1}, false);
    ::shutdown(socket, SHUT_WR);
    ::close(socket);
}

}  // namespace

Worker::Worker(WorkerLimits limits, Shared& shared, std::shared_ptr<const Catalogue> catalogue)
    : limits_(limits),
      shared_(shared),
      catalogue_(std::move(catalogue)),
      guard_(context_.get_executor()),
      timer_(context_) {}

Worker::~Worker() {
    stop(std::chrono::milliseconds(0));
    join();
}

void Worker::start() {
    asio::co_spawn(context_.get_executor(), watchDeadlines(), asio::detached);
    thread_ = std::thread([this] {
        context_.run();
        hasEnded_ = true;
    });
}

void Worker::adopt(int socket, std::string peer) {
    open_.fetch_add(1, kRelaxed);
    asio::post(context_, [this, socket, peer = std::move(peer)]() mutable { take(socket, std::move(peer)); });
}

void Worker::take(int socket, std::string peer) {
    if (isStopping() || !makeRoom()) {
        shared_.metrics.connectionsRefused.fetch_add(1, kRelaxed);
        open_.fetch_sub(1, kRelaxed);
        refuse(socket);
        return;
    }
    Socket owned(context_);
    boost::system::error_code error;
    owned.assign(asio::ip::tcp::v6(), socket, error);  // which protocol matters only to open()
    if (error) {
        open_.fetch_sub(1, kRelaxed);
        ::close(socket);
        return;
    }
    shared_.metrics.connectionsAccepted.fetch_add(1, kRelaxed);
    shared_.metrics.connectionsOpen.fetch_add(1, kRelaxed);
    auto connection = std::make_shared<Connection>(*this, std::move(owned), std::move(peer));
    connections_.insert(connection.get());
    asio::co_spawn(context_.get_executor(), Connection::serve(std::move(connection)), asio::detached);
}

bool Worker::makeRoom() {
    if (connections_.size() < limits_.connections) return true;
    if (idle_.empty()) return false;
    shared_.metrics.connectionsEvicted.fetch_add(1, kRelaxed);
    Connection* const oldest = idle_.front();
    idle_.splice(idle_.end(), idle_, idle_.begin());  // the next to be evicted is another
    oldest->end();
    return true;
}

void Worker::forget(Connection& connection) {
    connections_.erase(&connection);
    open_.fetch_sub(1, kRelaxed);
    shared_.metrics.connectionsOpen.fetch_sub(1, kRelaxed);
    endWhenEmpty();
}

void Worker::replaceCatalogue(std::shared_ptr<const Catalogue> catalogue) {
    asio::post(context_, [this, next = std::move(catalogue)]() mutable { catalogue_ = std::move(next); });
}

void Worker::stop(std::chrono::milliseconds grace) {
    asio::post(context_, [this, grace] {
        stopBy_ = Clock::now() + grace;
        for (Connection* connection : idle_) connection->end();
        endWhenEmpty();
    });
}

void Worker::endWhenEmpty() {
    if (!isStopping() || !connections_.empty()) return;
    guard_.reset();
    timer_.cancel();
}

void Worker::join() {
    if (thread_.joinable()) thread_.join();
}

std::string_view Worker::date() {
    const int64_t second = std::time(nullptr);
    if (second != dateSecond_) date_ = imfDate(second);
    dateSecond_ = second;
    return date_;
}

Awaitable<void> Worker::watchDeadlines() {
    while (!isStopping() || !connections_.empty()) {
        boost::system::error_code ignored;
        timer_.expires_after(kWatchInterval);
        co_await timer_.async_wait(asio::redirect_error(kAwait, ignored));
        const auto now = Clock::now();
        const bool isOver = isStopping() && now >= *stopBy_;
        for (Connection* connection : connections_) {
            if (isOver)
                connection->end();
            else
                connection->checkDeadline(now);
        }
    }
}

}  // namespace terray::server
