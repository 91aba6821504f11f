#pragma once

#include <array>
#include <string_view>

#include "common/bytes.h"
#include "server/socket_io.h"

namespace terray::server {

/// Sends memory without copying it: by way of a pipe its pages become parts of the socket's queue (vmsplice, splice).
/// Where the system has no such pipe it copies. One thread.
class PageSender {
  public:
    PageSender();
    ~PageSender();
    PageSender(const PageSender&) = delete;
    PageSender& operator=(const PageSender&) = delete;

    /// Sends as much as the socket takes now.
    /// @param head   goes before the bytes, copied; less than a page
    /// @param bytes  as KeptTile's: never written again, since the client gets what is there when it is sent
    /// @return       the bytes of both that were sent, and wouldBlock or ended when those are not all
    IoStep send(int socket, std::string_view head, ByteView bytes);

  private:
    IoStep sendSome(int socket, std::string_view head, ByteView bytes);
    /// @return  bytes of both that the pipe took: all of the head; 0: there is no pipe that works
    size_t fill(std::string_view head, ByteView bytes);
    void closePipe();
    /// Throws away what is left in the pipe.
    void empty(size_t bytes);

    std::array<int, 2> pipe_ = {-1, -1};  ///< its reading end first; -1: there is none
    int nowhere_ = -1;                    ///< /dev/null
};

}  // namespace terray::server
