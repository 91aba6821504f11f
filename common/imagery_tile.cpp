#include "common/imagery_tile.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "common/grid.h"
#include "common/tile_payload.h"
#include "common/zstd_block.h"

namespace terray {
namespace {

constexpr PayloadPrefix kPrefix{.magic = {'T', 'R', 'Y', 'I'}, .version = 1};
constexpr size_t kFieldBytes = 4;
constexpr int kZstdLevel = 3;  // FORMAT.md holds the measurements behind it
constexpr int kBlockSide = 4;  // texels

/// How the blocks are stored: as they are, or split into halves within one zstd frame when that is smaller.
enum class BlockCodec : uint8_t { raw = 0, splitZstd = 1 };

size_t mipOffset(int mip) {
    size_t offset = 0;
    for (int finer = 0; finer < mip; ++finer) offset += imageryMipBytes(finer);
    return offset;
}

/// Only the root holds its own chain, see ImageryTile::mips.
int mipsStored(const TileId& id) {
    return id.level == 0 ? kImageryMips : 1;
}

using Block = std::array<std::byte, kBc1BlockBytes>;
using HalfBlock = std::array<std::byte, kBc1BlockBytes / 2>;

/// The first halves of all blocks (two colours), then the second halves (sixteen choices between them): like stands
/// beside like, which saves about a tenth of the compressed size.
Bytes splitHalves(ByteView blocks) {
    Bytes halves(blocks.size());
    const size_t count = blocks.size() / kBc1BlockBytes;
    const std::span first(reinterpret_cast<HalfBlock*>(halves.data()), count);
    const std::span second(reinterpret_cast<HalfBlock*>(halves.data()) + count, count);
    for (size_t i = 0; i < count; ++i) {
        std::memcpy(&first[i], &blocks[kBc1BlockBytes * i], sizeof(HalfBlock));
        std::memcpy(&second[i], &blocks[kBc1BlockBytes * i + sizeof(HalfBlock)], sizeof(HalfBlock));
    }
    return halves;
}

Bytes joinHalves(ByteView halves) {
    Bytes blocks(halves.size());
    const size_t count = halves.size() / kBc1BlockBytes;
    const std::span first(reinterpret_cast<const HalfBlock*>(halves.data()), count);
    const std::span second(reinterpret_cast<const HalfBlock*>(halves.data()) + count, count);
    for (size_t i = 0; i < count; ++i) {
        std::memcpy(&blocks[kBc1BlockBytes * i], &first[i], sizeof(HalfBlock));
        std::memcpy(&blocks[kBc1BlockBytes * i + sizeof(HalfBlock)], &second[i], sizeof(HalfBlock));
    }
    return blocks;
}

template <class BlockType, class ByteType>
GridView<BlockType> blockView(ByteType* bytes, int mip) {
    const int64_t side = imageryMipSide(mip) / kBlockSide;
    return {reinterpret_cast<BlockType*>(bytes), {side, side}};
}

/// Where a tile's mip lies in an ancestor: texels along one axis from the ancestor's first stored texel.
int64_t mipStart(uint32_t position, int mip, uint32_t levelsUp) {
    const int ownMip = mip - static_cast<int>(levelsUp);  // of the ancestor; above 0 only for the root
    const int64_t core = (position & ((1U << levelsUp) - 1)) * (int64_t{kTileCore} >> mip);
    return (kImageryGutter >> ownMip) + core - (kImageryGutter >> mip);
}

}  // namespace

ByteView ImageryTile::mip(int index) const {
    TERRAY_CHECK_OP(index, >=, 0);
    TERRAY_CHECK_OP(index, <, mips);
    TERRAY_CHECK_OP(blocks.size(), ==, mipOffset(mips));
    return ByteView(blocks).subspan(mipOffset(index), imageryMipBytes(index));
}

Bytes encodeImageryTile(const ImageryTile& tile) {
    TERRAY_CHECK(tile.id.valid());
    TERRAY_CHECK_OP(tile.mips, ==, mipsStored(tile.id));
    TERRAY_CHECK_OP(tile.blocks.size(), ==, mipOffset(tile.mips));

    const Bytes packed = zstdCompress(splitHalves(tile.blocks), kZstdLevel);
    const bool smaller = packed.size() < tile.blocks.size();
    PayloadPrefix prefix = kPrefix;
    prefix.id = tile.id;
    prefix.codec = static_cast<uint8_t>(smaller ? BlockCodec::splitZstd : BlockCodec::raw);
    for (size_t quadrant = 0; quadrant < 4; ++quadrant)
        if (tile.childExists[quadrant]) prefix.flags = static_cast<uint8_t>(prefix.flags | 1U << quadrant);
    ByteWriter out;
    writePayloadPrefix(out, prefix);
    out.write(static_cast<uint32_t>(tile.mips));
    sealPayload(out, smaller ? packed : tile.blocks);
    return out.release();
}

Result<ImageryTile> decodeImageryTile(ByteView payload, std::optional<TileId> expected) {
    auto opened = openPayload("imagery tile", payload, kPrefix, kFieldBytes, expected);
    if (!opened.ok()) return opened.failure();
    ImageryTile tile;
    tile.id = opened->prefix.id;
    const std::string name = "imagery tile " + toString(tile.id);
    if (opened->prefix.flags > 0xF) return Failure{name + ": unknown flags"};
    for (size_t quadrant = 0; quadrant < 4; ++quadrant)
        tile.childExists[quadrant] = (opened->prefix.flags >> quadrant & 1) != 0;
    const auto mips = ByteReader(opened->fields).read<uint32_t>();
    tile.mips = mipsStored(tile.id);
    if (mips != static_cast<uint32_t>(tile.mips))
        return Failure{name + ": has " + std::to_string(mips) + " mips, expected " + std::to_string(tile.mips)};

    const size_t size = mipOffset(tile.mips);
    switch (BlockCodec{opened->prefix.codec}) {
        case BlockCodec::raw:
            if (opened->body.size() != size)
                return Failure{name + ": " + std::to_string(opened->body.size()) + " bytes of blocks, expected " +
                               std::to_string(size)};
            tile.blocks.assign(opened->body.begin(), opened->body.end());
            return tile;
        case BlockCodec::splitZstd:
            Bytes halves(size);
            if (!zstdDecompress(opened->body, halves))
                return Failure{name + ": its blocks do not unpack to their size"};
            tile.blocks = joinHalves(halves);
            return tile;
    }
    return Failure{name + ": codec " + std::to_string(opened->prefix.codec) + " is unknown"};
}

Bytes gatherMipChain(const ImageryTile& tile, std::span<const ImageryTile* const> ancestors) {
    Bytes chain(imageryChainBytes());
    for (int mip = 0; mip < kImageryMips; ++mip) {
        // The ancestor as many levels up as there are; what lies above the root is in the root's own mips.
        const uint32_t levelsUp = std::min(static_cast<uint32_t>(mip), tile.id.level);
        TERRAY_CHECK_OP(levelsUp, <=, ancestors.size());
        const ImageryTile& source = levelsUp == 0 ? tile : *ancestors[levelsUp - 1];
        TERRAY_CHECK_OP(source.id, ==, tile.id.ancestor(levelsUp));

        const int sourceMip = mip - static_cast<int>(levelsUp);
        const auto from = blockView<const Block>(source.mip(sourceMip).data(), sourceMip);
        const auto to = blockView<Block>(chain.data() + mipOffset(mip), mip);
        const auto window = from.window({mipStart(tile.id.x, mip, levelsUp) / kBlockSide,
                                         mipStart(tile.id.y, mip, levelsUp) / kBlockSide, to.width(), to.height()});
        for (int64_t y = 0; y < to.height(); ++y) std::ranges::copy(window.row(y), to.row(y).begin());
    }
    return chain;
}

}  // namespace terray
