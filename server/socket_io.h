#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <sys/uio.h>

namespace terray::server {

/// What one call on a socket that never blocks came to.
struct IoStep {
    enum class Outcome { progressed, wouldBlock, ended };  ///< ended: the peer is gone, or an error
    Outcome outcome = Outcome::ended;
    size_t bytes = 0;  ///< when progressed; calls that take several steps say how far they came
};

/// Reads what is there, up to the buffer's size.
[[nodiscard]] IoStep receiveSome(int socket, std::span<char> buffer);
/// Sends from several pieces as far as the socket takes them.
/// @param moreFollows  the kernel may wait for what follows to fill a packet
[[nodiscard]] IoStep sendSome(int socket, std::span<const iovec> pieces, bool moreFollows);
/// Sends bytes of a file without copying them into the program. A file that became shorter counts as ended.
[[nodiscard]] IoStep sendFileSome(int socket, int file, uint64_t offset, size_t length);
/// Moves what a pipe holds to a socket or file. A pipe that is empty counts as wouldBlock.
[[nodiscard]] IoStep spliceSome(int pipe, int target, size_t length, bool moreFollows);

}  // namespace terray::server
