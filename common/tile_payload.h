#pragma once

#include <array>
#include <optional>
#include <string>

#include "common/bytes.h"
#include "common/result.h"
#include "common/tile_id.h"

namespace terray {

// The frame that both kinds of tile payload share: who I am, what follows, and a checksum over each (FORMAT.md).
// A payload is: prefix, fields of its kind, body's size and checksum, header's checksum, body.

/// What opens a payload.
struct PayloadPrefix {
    std::array<char, 4> magic{};
    uint16_t version = 0;
    uint8_t codec = 0;  ///< how the body is packed; its meaning is the kind's own
    uint8_t flags = 0;  ///< likewise
    TileId id;
};
inline constexpr size_t kPayloadPrefixBytes = 20;
/// Body's size, body's CRC-32C, CRC-32C of all header bytes before it.
inline constexpr size_t kPayloadSealBytes = 12;

void writePayloadPrefix(ByteWriter& out, const PayloadPrefix& prefix);
/// Appends the seal and the body to a header whose fields are all written.
void sealPayload(ByteWriter& out, ByteView body);

/// Splits a payload into its parts after checking its size, magic, version, both checksums and the tile id.
struct OpenedPayload {
    PayloadPrefix prefix;
    ByteView fields;  ///< of the payload's kind
    ByteView body;
};
/// @param what         for messages, such as "height tile"
/// @param expected     magic and version that the payload must carry
/// @param fieldBytes   size of the kind's own fields
/// @param expectedId   the id that the tile must carry, when known
[[nodiscard]] Result<OpenedPayload> openPayload(const std::string& what, ByteView payload,
                                                const PayloadPrefix& expected, size_t fieldBytes,
                                                std::optional<TileId> expectedId);

}  // namespace terray
