#pragma once

#include "common/bytes.h"
#include "common/result.h"

namespace terray {

// The only door to zlib. Built without it (TERRAY_WITH_ZLIB=0), both functions fail and say so.

/// One gzip member without time or name, so same bytes in, same bytes out.
[[nodiscard]] Result<Bytes> gzipCompress(ByteView bytes);

/// Unpacks one gzip member that fills `bytes`. Fails when it would unpack to more than maxBytes.
[[nodiscard]] Result<Bytes> gzipDecompress(ByteView bytes, size_t maxBytes);

}  // namespace terray
