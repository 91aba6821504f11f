#pragma once

#include <string_view>
#include <vector>

namespace terray::server {

/// Answers whatever bytes a client may send, as a connection does but without sockets, and stops the program
/// (TERRAY_CHECK) when an answer is none that a client may get: status 500 or 503, a head that breaks HTTP's grammar, a
/// body beyond the end of its archive, or other answers when the bytes come in other pieces.
///
/// @return  statuses of the answers in their order, up to the one that ends the connection
std::vector<int> answerBytes(std::string_view bytes);

}  // namespace terray::server
