#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "common/bytes.h"
#include "common/result.h"
#include "common/tile_id.h"
#include "common/tiling.h"

namespace terray {

/// Colour of ground that no photo covers, 8-bit sRGB: about 18 % linear reflectance, a photographer's grey, slightly
/// warm. Texels without photo inside an imagery tile hold it, and the renderer uses it where there is no tile.
inline constexpr std::array<uint8_t, 3> kNeutralGround = {122, 118, 110};

/// Bytes of one BC1 block of 4 x 4 texels.
inline constexpr size_t kBc1BlockBytes = 8;

/// Side in texels of mip m of an imagery tile, gutter included: 576, 288, 144, 72.
[[nodiscard]] constexpr int imageryMipSide(int mip) {
    return kImageryTileSide >> mip;
}
/// Bytes of mip m in BC1.
[[nodiscard]] constexpr size_t imageryMipBytes(int mip) {
    const auto blocks = static_cast<size_t>(imageryMipSide(mip) / 4);
    return blocks * blocks * kBc1BlockBytes;
}

/// One tile of the photo pyramid, BC1 in sRGB. Payload layout: FORMAT.md.
struct ImageryTile {
    TileId id;
    /// Which of the four tiles beneath exist, by quadrant.
    std::array<bool, 4> childExists{};
    /// BC1 blocks, rows of blocks from the north, mip after mip. Every tile stores mip 0; the root alone stores all
    /// kImageryMips, since its coarser ones have no ancestors to be gathered from.
    int mips = 1;
    Bytes blocks;

    bool operator==(const ImageryTile&) const = default;

    /// The blocks of one stored mip.
    [[nodiscard]] ByteView mip(int index) const;
};

[[nodiscard]] Bytes encodeImageryTile(const ImageryTile& tile);

/// Reads a payload, trusting nothing: magic, version, sizes and checksum are checked. Allocates at most one tile.
[[nodiscard]] Result<ImageryTile> decodeImageryTile(ByteView payload, std::optional<TileId> expected = {});

/// The mip chain of a tile as the GPU takes it: mips 0 .. kImageryMips - 1, each with its gutter of 32 >> mip texels,
/// one after the other. Mip m is a sub-rectangle of the m-th ancestor, copied block by block (nothing is decoded), so
/// it is exactly what the ancestor shows (paper 001, section 4).
/// @param tile       the tile itself
/// @param ancestors  its parent, grandparent, ... ; for tiles of level 1 and 2 the last one is the root, whose own mips
///                   stand for what would lie above it. min(level, kImageryMips - 1) of them are needed.
[[nodiscard]] Bytes gatherMipChain(const ImageryTile& tile, std::span<const ImageryTile* const> ancestors);

/// Bytes of such a chain: what a tile costs on the GPU.
[[nodiscard]] constexpr size_t imageryChainBytes() {
    size_t bytes = 0;
    for (int mip = 0; mip < kImageryMips; ++mip) bytes += imageryMipBytes(mip);
    return bytes;
}

}  // namespace terray
