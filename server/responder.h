#pragma once

#include "server/catalogue.h"
#include "server/http_message.h"
#include "server/metrics.h"

namespace terray::server {

/// Answers a request: a pure function of request, datasets and counters, without sockets. At most it reads directories
/// of an archive that are not cached (PmtilesReader::locate).
///
/// Never throws for anything a client may send; answers 500 only when a file cannot be read.
[[nodiscard]] Response respond(const Request& request, const Catalogue& catalogue, const Metrics& metrics);

}  // namespace terray::server
