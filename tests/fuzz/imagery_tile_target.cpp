#include "common/bc1_decode.h"
#include "common/check.h"
#include "common/imagery_tile.h"
#include "tests/fuzz/allocation_limit.h"
#include "tests/fuzz/sealed_payload.h"
#include "tests/fuzz/targets.h"

namespace terray::fuzz {
namespace {

constexpr size_t kFieldBytes = 4;  // FORMAT.md: the number of mips
constexpr size_t kMessages = size_t{16} << 10;
/// The root's blocks, whole and as halves.
constexpr size_t kLimitBytes = 2 * imageryChainBytes() + kMessages;

/// Decodes the coarsest mip, and gathers the chain of a tile that needs no other.
void useBlocks(const ImageryTile& tile) {
    const int coarsest = tile.mips - 1;
    const int64_t side = imageryMipSide(coarsest);
    TERRAY_CHECK(decodeBc1(tile.mip(coarsest), {side, side}).size() == (GridSize{side, side}));
    if (tile.id.level == 0) TERRAY_CHECK(gatherMipChain(tile, {}) == tile.blocks);
}

/// Reads a payload, and what it wrote itself alike.
bool readPayload(ByteView payload) {
    const auto tile = within(kLimitBytes, [&] { return decodeImageryTile(payload); });
    if (!tile.ok()) return false;
    useBlocks(*tile);
    TERRAY_CHECK(!decodeImageryTile(payload, tile->id.child(0)).ok());
    TERRAY_CHECK(decodeImageryTile(encodeImageryTile(*tile)).value() == *tile);
    return true;
}

/// A tile of these blocks.
void readPattern(ByteView pattern) {
    const bool isRoot = (pattern.front() & std::byte{1}) != std::byte{0};
    ImageryTile tile{.id = {isRoot ? 0U : 1U, 0, 0}, .mips = isRoot ? kImageryMips : 1};
    tile.blocks = repeated(pattern, isRoot ? imageryChainBytes() : imageryMipBytes(0));
    const Bytes payload = encodeImageryTile(tile);
    TERRAY_CHECK(readPayload(payload));
    TERRAY_CHECK(decodeImageryTile(payload).value() == tile);
}

}  // namespace

bool readImageryTile(ByteView bytes) {
    return readTile(bytes, {.magic = "TRYI",
                            .fieldBytes = kFieldBytes,
                            .readPayload = readPayload,
                            .readPattern = readPattern});
}

}  // namespace terray::fuzz
