#pragma once
// One thread of the server with the connections that it serves, on Boost.Asio.

#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <unordered_set>
#include <utility>  // before Asio: Boost 1.74 misses it in C++20

#include <boost/asio/awaitable.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "server/access_log.h"
#include "server/catalogue.h"
#include "server/metrics.h"
#include "server/page_sender.h"
#include "server/request_reader.h"
#include "server/tile_store.h"

namespace terray::server {

namespace asio = boost::asio;
using Executor = asio::io_context::executor_type;
template <class T>
using Awaitable = asio::awaitable<T, Executor>;
inline constexpr asio::use_awaitable_t<Executor> kAwait;
using Socket = asio::basic_stream_socket<asio::ip::tcp, Executor>;
using Clock = std::chrono::steady_clock;

/// Bounds that every worker keeps.
struct WorkerLimits {
    size_t connections = 8192;  ///< of this worker
    std::chrono::milliseconds idleTimeout{60000};
    std::chrono::milliseconds headTimeout{10000};  ///< from the first byte of a request's head to its last
    HeadLimits head;
};

/// What all workers share.
struct Shared {
    Metrics metrics;
    AccessLog* log = nullptr;
    TileStore* tiles = nullptr;  ///< null: tiles go straight from the file
};

class Connection;

/// Runs one thread. Connections never leave the worker that they were given to, so what they share needs no locks; the
/// functions marked "any thread" post to it.
class Worker {
  public:
    Worker(WorkerLimits limits, Shared& shared, std::shared_ptr<const Catalogue> catalogue);
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    void start();
    /// Any thread: takes over an accepted socket, which never blocks. @param peer  for the log
    void adopt(int socket, std::string peer);
    /// Any thread: requests that begin from now on see these datasets.
    void replaceCatalogue(std::shared_ptr<const Catalogue> catalogue);
    /// Any thread: idle connections end at once, others after their answer, and when `grace` is over all of them.
    void stop(std::chrono::milliseconds grace);
    /// Waits until the thread has ended.
    void join();
    /// Any thread: whether a stop() has come to its end.
    [[nodiscard]] bool hasEnded() const { return hasEnded_; }
    /// Any thread.
    [[nodiscard]] size_t connections() const { return open_.load(std::memory_order_relaxed); }
    [[nodiscard]] asio::io_context& context() { return context_; }

    // For its connections, on its thread.
    [[nodiscard]] const WorkerLimits& limits() const { return limits_; }
    [[nodiscard]] Shared& shared() { return shared_; }
    [[nodiscard]] const std::shared_ptr<const Catalogue>& catalogue() const { return catalogue_; }
    [[nodiscard]] bool isStopping() const { return stopBy_.has_value(); }
    /// Now, as HTTP writes it; made once a second.
    [[nodiscard]] std::string_view date();
    /// Room for one read; what is in it lasts until the connection waits.
    [[nodiscard]] std::span<char> scratch() { return scratch_; }
    [[nodiscard]] PageSender& pageSender() { return pageSender_; }
    using IdleList = std::list<Connection*>;
    [[nodiscard]] IdleList& idle() { return idle_; }  ///< longest idle first
    void forget(Connection& connection);

  private:
    void take(int socket, std::string peer);
    /// Makes room for one more connection if need be. @return whether there is
    bool makeRoom();
    Awaitable<void> watchDeadlines();
    void endWhenEmpty();

    WorkerLimits limits_;
    Shared& shared_;
    std::shared_ptr<const Catalogue> catalogue_;
    asio::io_context context_{1};
    asio::executor_work_guard<Executor> guard_;
    asio::basic_waitable_timer<Clock, asio::wait_traits<Clock>, Executor> timer_;
    std::unordered_set<Connection*> connections_;
    std::atomic<size_t> open_ = 0;
    std::atomic<bool> hasEnded_ = false;
    IdleList idle_;
    std::optional<Clock::time_point> stopBy_;
    int64_t dateSecond_ = -1;
    std::string date_;
    std::array<char, 16384> scratch_{};
    PageSender pageSender_;
    std::thread thread_;
};

}  // namespace terray::server
