#pragma once

#include <span>

#include "common/bytes.h"

namespace terray {

// The only door to zstd. Each thread keeps one context for packing and one for unpacking (about 1 MB).

/// One zstd frame that holds `bytes`. Same bytes, level and zstd version: same frame.
/// @param level  1 (fast) to 19 (small)
[[nodiscard]] Bytes zstdCompress(ByteView bytes, int level);

/// Unpacks one frame into `target`. Allocates nothing whatever the frame claims.
/// @return false when the bytes are not exactly one whole frame of exactly target.size() bytes
[[nodiscard]] bool zstdDecompress(ByteView frame, std::span<std::byte> target);

}  // namespace terray
