#pragma once

#include <memory>
#include <string>
#include <variant>

#include "server/http_message.h"
#include "server/socket_io.h"
#include "server/worker.h"

namespace terray::server {

/// One client's connection: reads requests, answers them in their order, keeps its deadlines. Lives on its worker's
/// thread and as long as its coroutine runs.
class Connection : public std::enable_shared_from_this<Connection> {
  public:
    Connection(Worker& worker, Socket socket, std::string peer);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    /// Serves until the connection ends.
    [[nodiscard]] static Awaitable<void> serve(std::shared_ptr<Connection> self);
    /// Ends the connection when its deadline has passed.
    void checkDeadline(Clock::time_point now);
    /// Ends the connection at the next chance, whatever it is at.
    void end();

  private:
    struct Ended {};
    using Head = std::variant<Ended, Request, Refusal>;

    Awaitable<Head> receiveHead();
    /// Waits until more may be read. @return false when the connection is to end
    Awaitable<bool> waitForRequest();
    Awaitable<bool> wait(Socket::wait_type type);
    /// Answers one head. @return whether another may follow
    Awaitable<bool> answer(const Head& head);
    /// A tile's bytes through the store, which has to read them. Null: it cannot.
    Awaitable<TileBytes> fetch(const StoredTile& tile);
    /// Sends an answer, to its end unless `failed_`. @param tile  bytes of the body if they are in memory
    Awaitable<void> send(const Response& response, std::string head, TileBytes tile);
    /// Sends head and tile as far as the client takes them without waiting. @return bytes of both sent
    [[nodiscard]] size_t sendAtOnce(std::string_view head, const KeptTile& tile);
    Awaitable<void> sendPieces(std::span<iovec> pieces, bool moreFollows);
    /// @param done  bytes of it that were sent before
    Awaitable<void> sendSlice(const ArchiveSlice& slice, uint64_t done);
    /// Counts and logs an answer. @param request  null when there was none
    void account(const Request* request, int status, std::chrono::microseconds time);
    /// Notes what a call on the socket came to, and waits if it must.
    Awaitable<void> proceed(IoStep step);
    /// Tells the client that nothing follows, and reads on for a moment: closing at once with bytes unread would make
    /// the kernel throw away an answer that is still on its way.
    Awaitable<void> linger();
    void extendDeadline(std::chrono::milliseconds time) { deadline_ = Clock::now() + time; }

    Worker& worker_;
    Socket socket_;
    std::string peer_;
    RequestReader reader_;
    Clock::time_point deadline_;
    bool ends_ = false;    ///< told to end, or its deadline has passed
    bool failed_ = false;  ///< the client is gone
    uint64_t sent_ = 0;    ///< bytes of the present answer
    uint64_t paced_ = 0;   ///< of them, those before the deadline was last extended
};

}  // namespace terray::server
