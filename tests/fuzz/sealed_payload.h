#pragma once

#include <optional>

#include "common/tile_payload.h"

namespace terray::fuzz {

/// A payload with the body size and checksums that its bytes should have, so that fuzzing gets behind them.
/// @param fieldBytes  of its kind's own fields
/// @return            nothing when it is shorter than a header
[[nodiscard]] std::optional<Bytes> sealedPayload(ByteView payload, size_t fieldBytes);

/// `count` bytes: the pattern again and again. It must not be empty.
[[nodiscard]] Bytes repeated(ByteView pattern, size_t count);

/// Whether the bytes begin with a text.
[[nodiscard]] bool beginsWith(ByteView bytes, std::string_view text);

}  // namespace terray::fuzz
