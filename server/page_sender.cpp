#include "server/page_sender.h"

#include <algorithm>

#include <fcntl.h>
#include <sys/uio.h>
#include <unistd.h>

namespace terray::server {
namespace {

using Outcome = IoStep::Outcome;

constexpr int kPipeBytes = 1 << 20;  // the most that a pipe holds for users without privileges

template <class Range>
iovec pieceOf(const Range& bytes) {
    return {const_cast<void*>(static_cast<const void*>(bytes.data())), bytes.size()};  // the calls only read it
}

}  // namespace

PageSender::PageSender() : nowhere_(::open("/dev/null", O_WRONLY | O_CLOEXEC)) {
    if (nowhere_ < 0 || ::pipe2(pipe_.data(), O_CLOEXEC | O_NONBLOCK) != 0) {
        pipe_ = {-1, -1};
        return;
    }
    ::fcntl(pipe_[1], F_SETPIPE_SZ, kPipeBytes);  // without it there are more calls for a tile
}

PageSender::~PageSender() {
    closePipe();
    if (nowhere_ >= 0) ::close(nowhere_);
}

void PageSender::closePipe() {
    for (int& end : pipe_) {
        if (end >= 0) ::close(end);
        end = -1;
    }
}

IoStep PageSender::send(int socket, std::string_view head, ByteView bytes) {
    size_t sent = 0;
    while (sent < head.size() + bytes.size()) {
        const size_t ofHead = std::min(sent, head.size());
        const IoStep step = sendSome(socket, head.substr(ofHead), bytes.subspan(sent - ofHead));
        sent += step.bytes;
        if (step.outcome != Outcome::progressed) return {step.outcome, sent};
    }
    return {Outcome::progressed, sent};
}

IoStep PageSender::sendSome(int socket, std::string_view head, ByteView bytes) {
    const size_t filled = fill(head, bytes);
    if (filled == 0) {
        closePipe();
        return server::sendSome(socket, std::array{pieceOf(head), pieceOf(bytes)}, false);
    }
    const bool moreFollows = filled < head.size() + bytes.size();
    size_t sent = 0;
    IoStep step{Outcome::progressed};
    while (sent < filled && step.outcome == Outcome::progressed) {
        step = spliceSome(pipe_[0], socket, filled - sent, moreFollows);
        sent += step.bytes;
    }
    empty(filled - sent);
    return {step.outcome, sent};
}

size_t PageSender::fill(std::string_view head, ByteView bytes) {
    if (pipe_[1] < 0) return 0;
    const auto size = static_cast<ssize_t>(head.size());
    if (size > 0 && ::write(pipe_[1], head.data(), head.size()) != size) return 0;
    const iovec piece = pieceOf(bytes);
    const ssize_t taken = ::vmsplice(pipe_[1], &piece, 1, SPLICE_F_NONBLOCK);
    return taken > 0 ? head.size() + static_cast<size_t>(taken) : 0;
}

void PageSender::empty(size_t bytes) {
    while (bytes > 0) {
        const IoStep step = spliceSome(pipe_[0], nowhere_, bytes, false);
        if (step.outcome != Outcome::progressed) return closePipe();  // never seen; what is left must not be sent
        bytes -= step.bytes;
    }
}

}  // namespace terray::server
