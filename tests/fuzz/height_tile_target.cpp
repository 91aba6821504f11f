#include "common/check.h"
#include "common/height_planes.h"
#include "common/height_tile.h"
#include "tests/fuzz/allocation_limit.h"
#include "tests/fuzz/sealed_payload.h"
#include "tests/fuzz/targets.h"

namespace terray::fuzz {
namespace {

constexpr size_t kFieldBytes = 20 + 5 * 16;  // FORMAT.md: encoding, its own record and four children's
constexpr GridSize kSize{kHeightTileSide, kHeightTileSide};
constexpr size_t kMessages = size_t{16} << 10;

/// One tile of codes, and the planes that they are made of.
size_t limitBytes() {
    return static_cast<size_t>(kSize.count()) * sizeof(uint16_t) + heightPlaneBytes(kSize, true) + kMessages;
}

/// Reads a payload, and what it wrote itself alike.
bool readPayload(ByteView payload) {
    const auto header = within(kMessages, [&] { return decodeHeightHeader(payload); });
    const auto tile = within(limitBytes(), [&] { return decodeHeightTile(payload); });
    if (!tile.ok()) return false;
    TERRAY_CHECK(header.ok() && header->record == tile->record && header->children == tile->children);
    TERRAY_CHECK(!decodeHeightTile(payload, tile->id.child(0)).ok());
    TERRAY_CHECK(decodeHeightTile(encodeHeightTile(*tile)).value() == *tile);
    return true;
}

/// A tile of these residuals.
void readPattern(ByteView pattern) {
    const bool hasHoles = (pattern.front() & std::byte{1}) != std::byte{0};
    HeightTile tile;
    tile.codes = codesFromPlanes(repeated(pattern, heightPlaneBytes(kSize, hasHoles)), hasHoles, kSize);
    tile.record = measureRecord(tile.codes, tile.encoding, 0);
    const Bytes payload = encodeHeightTile(tile);
    TERRAY_CHECK(within(limitBytes(), [&] { return decodeHeightTile(payload); }).value() == tile);
}

}  // namespace

bool readHeightTile(ByteView bytes) {
    return readTile(bytes, {.magic = "TRYH",
                            .fieldBytes = kFieldBytes,
                            .readPayload = readPayload,
                            .readPattern = readPattern});
}

}  // namespace terray::fuzz
