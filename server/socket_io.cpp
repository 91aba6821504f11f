#include "server/socket_io.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/sendfile.h>
#include <sys/socket.h>
#include <sys/types.h>

namespace terray::server {
namespace {

using Outcome = IoStep::Outcome;

template <class Call>
IoStep step(Call call) {
    for (;;) {
        const ssize_t count = call();
        if (count > 0) return {Outcome::progressed, static_cast<size_t>(count)};
        if (count == 0) return {Outcome::ended};
        if (errno == EAGAIN) return {Outcome::wouldBlock};
        if (errno != EINTR) return {Outcome::ended};
    }
}

}  // namespace

IoStep receiveSome(int socket, std::span<char> buffer) {
    return step([&] { return ::recv(socket, buffer.data(), buffer.size(), MSG_DONTWAIT); });
}

IoStep sendSome(int socket, std::span<const iovec> pieces, bool moreFollows) {
    msghdr message = {};
    message.msg_iov = const_cast<iovec*>(pieces.data());  // the call only reads them
    message.msg_iovlen = pieces.size();
    const int flags = MSG_DONTWAIT | MSG_NOSIGNAL | (moreFollows ? MSG_MORE : 0);
    return step([&] { return ::sendmsg(socket, &message, flags); });
}

IoStep sendFileSome(int socket, int file, uint64_t offset, size_t length) {
    return step([&] {
        off_t position = static_cast<off_t>(offset);
        return ::sendfile(socket, file, &position, length);
    });
}

IoStep spliceSome(int pipe, int target, size_t length, bool moreFollows) {
    const unsigned flags = SPLICE_F_NONBLOCK | (moreFollows ? SPLICE_F_MORE : 0);
    return step([&] { return ::splice(pipe, nullptr, target, nullptr, length, flags); });
}

}  // namespace terray::server
