#pragma once

#include <optional>
#include <string_view>

#include "common/tile_payload.h"

namespace terray::fuzz {

/// A payload with the body size and checksums that its bytes should have, so that fuzzing gets behind them.
/// @param fieldBytes  of its kind's own fields
/// @return            nothing when it is shorter than a header
[[nodiscard]] std::optional<Bytes> sealedPayload(ByteView payload, size_t fieldBytes);

/// How one kind of tile is read.
struct TileReading {
    std::string_view magic;  ///< that its payloads begin with
    size_t fieldBytes = 0;   ///< of its own fields
    bool (*readPayload)(ByteView payload) = nullptr;
    void (*readPattern)(ByteView pattern) = nullptr;  ///< makes a tile of whatever does not begin so, and reads it
};
/// Reads bytes as a tile: as they are and sealed, or as a pattern. @return whether they make a tile
[[nodiscard]] bool readTile(ByteView bytes, const TileReading& reading);

/// `count` bytes: the pattern again and again. It must not be empty.
[[nodiscard]] Bytes repeated(ByteView pattern, size_t count);

}  // namespace terray::fuzz
