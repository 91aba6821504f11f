#include "server/page_sender.h"

#include <array>
#include <csignal>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/tile_memory.h"

namespace terray::server {
namespace {

using Outcome = IoStep::Outcome;

/// Two sockets that are connected and never block.
struct Connected {
    Connected() { EXPECT_EQ(0, ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends)); }
    ~Connected() {
        for (const int end : ends) ::close(end);
    }
    /// What has come so far.
    [[nodiscard]] std::string read() const {
        std::string text;
        std::array<char, 65536> piece{};
        for (IoStep step = receiveSome(ends[1], piece); step.outcome == Outcome::progressed;
             step = receiveSome(ends[1], piece))
            text.append(piece.data(), step.bytes);
        return text;
    }
    int ends[2] = {-1, -1};
};

std::string textOf(size_t size, char first) {
    std::string text(size, first);
    for (size_t i = 0; i < size; ++i) text[i] = static_cast<char>(first + i % 61);
    return text;
}

struct Sending : testing::Test {
    std::shared_ptr<const KeptTile> keep(const std::string& text) {
        return memory.keep(std::as_bytes(std::span(text)));
    }

    TileMemory memory;
    PageSender sender;
    Connected connected;
};

TEST_F(Sending, GivesHeadAndTileInTheirOrder) {
    const std::string tile = textOf(50000, 'A');
    const IoStep step = sender.send(connected.ends[0], "head ", keep(tile)->bytes());
    EXPECT_EQ(Outcome::progressed, step.outcome);
    EXPECT_EQ(5 + tile.size(), step.bytes);
    EXPECT_EQ("head " + tile, connected.read());
}

TEST_F(Sending, StopsWhereTheSocketIsFullAndKeepsNothingForTheNext) {
    const std::string tile = textOf(size_t{3} << 20, 'B');
    const auto kept = keep(tile);
    const IoStep step = sender.send(connected.ends[0], "head ", kept->bytes());
    EXPECT_EQ(Outcome::wouldBlock, step.outcome);
    EXPECT_LT(step.bytes, tile.size());
    const Connected other;
    EXPECT_EQ(4, sender.send(other.ends[0], "", kept->bytes().first(4)).bytes);
    EXPECT_EQ(tile.substr(0, 4), other.read());
    EXPECT_EQ(("head " + tile).substr(0, step.bytes), connected.read());
}

TEST_F(Sending, LeavesWhatIsOnItsWayAsItWasWhenTheTileIsDropped) {
    const std::string tile = textOf(30000, 'C');
    ASSERT_EQ(tile.size(), sender.send(connected.ends[0], "", keep(tile)->bytes()).bytes);
    for (int i = 0; i < 200; ++i) ASSERT_NE(nullptr, keep(textOf(30000, 'D')));
    EXPECT_EQ(tile, connected.read());
}

TEST_F(Sending, EndsWithThePeer) {
    std::signal(SIGPIPE, SIG_IGN);  // as the program does
    ::close(std::exchange(connected.ends[1], -1));
    EXPECT_EQ(Outcome::ended, sender.send(connected.ends[0], "head ", keep("tile")->bytes()).outcome);
}

TEST_F(Sending, CopiesWhereThereIsNoPipe) {
    rlimit limit = {};
    ASSERT_EQ(0, ::getrlimit(RLIMIT_NOFILE, &limit));
    rlimit none = limit;
    none.rlim_cur = 3;
    ASSERT_EQ(0, ::setrlimit(RLIMIT_NOFILE, &none));
    PageSender without;
    ASSERT_EQ(0, ::setrlimit(RLIMIT_NOFILE, &limit));
    const std::string tile = textOf(50000, 'E');
    EXPECT_EQ(5 + tile.size(), without.send(connected.ends[0], "head ", keep(tile)->bytes()).bytes);
    EXPECT_EQ("head " + tile, connected.read());
}

}  // namespace
}  // namespace terray::server
