#include "common/imagery_tile.h"

#include <cstring>

#include <gtest/gtest.h>

#include "common/grid.h"
#include "tests/common/payload_faults.h"
#include "tests/common/random.h"

namespace terray {
namespace {

using test::Random;

constexpr size_t kCodecAt = 6, kFlagsAt = 7, kMipsAt = 20, kHeaderChecksumAt = 32;

/// What a synthetic BC1 block says of itself: its place in an endless plane of blocks of its level. Levels below 0 are
/// the root's own mips.
struct BlockName {
    int8_t level = 0;
    int16_t x = 0;
    int16_t y = 0;
    bool operator==(const BlockName&) const = default;
};
std::ostream& operator<<(std::ostream& out, const BlockName& name) {
    return out << "level " << int{name.level} << " block " << name.x << ", " << name.y;
}

using Block = std::array<std::byte, kBc1BlockBytes>;
static_assert(sizeof(BlockName) <= sizeof(Block));

size_t chainOffset(int mip) {
    size_t offset = 0;
    for (int finer = 0; finer < mip; ++finer) offset += imageryMipBytes(finer);
    return offset;
}

GridView<const Block> blocksOf(ByteView bytes, int mip) {
    const int64_t side = imageryMipSide(mip) / 4;
    return {reinterpret_cast<const Block*>(bytes.data()), {side, side}};
}

BlockName nameAt(GridView<const Block> blocks, int64_t x, int64_t y) {
    BlockName name;
    std::memcpy(&name, blocks.at(x, y).data(), sizeof name);
    return name;
}

/// The block at (x, y) of a tile's image at `level` with this gutter, counted from the plane's origin.
BlockName expectedName(int level, uint32_t tileX, uint32_t tileY, int core, int gutter, int64_t x, int64_t y) {
    return {static_cast<int8_t>(level), static_cast<int16_t>((int64_t{tileX} * core - gutter) / 4 + x),
            static_cast<int16_t>((int64_t{tileY} * core - gutter) / 4 + y)};
}

/// A tile whose blocks all name themselves.
ImageryTile namedTile(const TileId& id) {
    ImageryTile tile{.id = id, .mips = id.level == 0 ? kImageryMips : 1};
    for (int mip = 0; mip < tile.mips; ++mip) {
        const int level = static_cast<int>(id.level) - mip;
        for (int64_t y = 0; y < imageryMipSide(mip) / 4; ++y)
            for (int64_t x = 0; x < imageryMipSide(mip) / 4; ++x) {
                const BlockName name = expectedName(level, id.x, id.y, kTileCore >> mip, kImageryGutter >> mip, x, y);
                Block block{};
                std::memcpy(block.data(), &name, sizeof name);
                tile.blocks.insert(tile.blocks.end(), block.begin(), block.end());
            }
    }
    return tile;
}

ImageryTile noiseTile(const TileId& id) {
    Random random(id.level + 1);
    ImageryTile tile{.id = id, .childExists = {true, false, false, true}, .mips = id.level == 0 ? kImageryMips : 1};
    tile.blocks.resize(chainOffset(tile.mips));
    for (std::byte& byte : tile.blocks) byte = static_cast<std::byte>(random.bits());
    return tile;
}

bool accepts(ByteView payload) {
    return decodeImageryTile(payload).ok();
}

TEST(ImageryTile, RoundTripsRootAndOthersCompressibleOrNot) {
    for (const TileId& id : {TileId{0, 0, 0}, TileId{7, 100, 3}})
        for (const ImageryTile& tile : {namedTile(id), noiseTile(id)}) {
            const Bytes payload = encodeImageryTile(tile);
            const auto decoded = decodeImageryTile(payload, id);
            ASSERT_TRUE(decoded.ok()) << decoded.failure().message;
            EXPECT_TRUE(*decoded == tile);
            EXPECT_EQ(encodeImageryTile(*decoded), payload);
        }
}

TEST(ImageryTile, StoresBlocksRawWhenCompressionDoesNotPay) {
    const ImageryTile tile = noiseTile({1, 0, 0});
    EXPECT_EQ(encodeImageryTile(tile).size(), tile.blocks.size() + 36);
    EXPECT_LT(encodeImageryTile(namedTile({1, 0, 0})).size(), tile.blocks.size() / 4);
}

TEST(ImageryTile, RefusesEveryTruncation) {
    test::expectRefusesTruncations(encodeImageryTile(namedTile({1, 1, 0})), accepts, 600);
    test::expectRefusesTruncations(encodeImageryTile(noiseTile({0, 0, 0})), accepts, 600);
}

TEST(ImageryTile, RefusesExtraBytes) {
    test::expectRefusesExtraBytes(encodeImageryTile(namedTile({2, 1, 0})), accepts);
    test::expectRefusesExtraBytes(encodeImageryTile(noiseTile({2, 1, 0})), accepts);
}

TEST(ImageryTile, DetectsEveryFlippedBit) {
    ImageryTile plain{.id = {1, 0, 1}, .blocks = Bytes(imageryMipBytes(0), std::byte{0x5A})};
    test::expectRefusesBitFlips(encodeImageryTile(plain), accepts);
    test::expectRefusesBitFlips(encodeImageryTile(noiseTile({3, 1, 0})), accepts, 100, 500);
}

TEST(ImageryTile, RefusesOtherVersionsCodecsFlagsAndSizes) {
    const Bytes payload = encodeImageryTile(namedTile({2, 1, 1}));
    const auto changed = [&](size_t position, int value) {
        return decodeImageryTile(test::resealed(payload, position, static_cast<std::byte>(value), kHeaderChecksumAt));
    };
    EXPECT_EQ(changed(4, 2).failure().message, "imagery tile: payload version 2, this build reads 1");
    EXPECT_FALSE(changed(0, 'X').ok());
    EXPECT_FALSE(changed(kCodecAt, 0).ok());  // raw, but not of a raw tile's size
    EXPECT_FALSE(changed(kCodecAt, 2).ok());
    EXPECT_FALSE(changed(kFlagsAt, 16).ok());
    EXPECT_TRUE(changed(kFlagsAt, 15).ok());
    EXPECT_FALSE(changed(kMipsAt, 4).ok());
    EXPECT_FALSE(changed(kMipsAt + 3, 0xFF).ok());
    for (size_t byte = 0; byte < 4; ++byte) EXPECT_FALSE(changed(24 + byte, 0xFF).ok());
}

TEST(ImageryTile, RefusesAnotherId) {
    EXPECT_FALSE(decodeImageryTile(encodeImageryTile(namedTile({2, 1, 1})), TileId{2, 1, 2}).ok());
}

TEST(ImageryTile, HasSidesThatAreWholeBlocksInEveryMip) {
    for (int mip = 0; mip < kImageryMips; ++mip) {
        EXPECT_EQ(imageryMipSide(mip) % 4, 0);
        EXPECT_EQ((kImageryGutter >> mip) % 4, 0);
        EXPECT_EQ(imageryMipSide(mip), (kTileCore >> mip) + 2 * (kImageryGutter >> mip));
    }
}

/// Gathers the chain of a tile and checks every block of every mip, gutters included, against the name that its place
/// calls for.
void expectChainFromAncestors(const TileId& id) {
    const ImageryTile tile = namedTile(id);
    std::vector<ImageryTile> ancestors;
    for (uint32_t up = 1; up <= std::min(id.level, uint32_t{kImageryMips - 1}); ++up)
        ancestors.push_back(namedTile(id.ancestor(up)));
    std::vector<const ImageryTile*> pointers;
    for (const ImageryTile& ancestor : ancestors) pointers.push_back(&ancestor);

    const Bytes chain = gatherMipChain(tile, pointers);
    ASSERT_EQ(chain.size(), imageryChainBytes());
    for (int mip = 0; mip < kImageryMips; ++mip) {
        const auto blocks = blocksOf(ByteView(chain).subspan(chainOffset(mip), imageryMipBytes(mip)), mip);
        for (int64_t y = 0; y < blocks.height(); ++y)
            for (int64_t x = 0; x < blocks.width(); ++x)
                ASSERT_EQ(nameAt(blocks, x, y), expectedName(static_cast<int>(id.level) - mip, id.x, id.y,
                                                             kTileCore >> mip, kImageryGutter >> mip, x, y))
                    << "mip " << mip << " block " << x << ", " << y << " of " << id;
    }
}

TEST(MipChain, IsGatheredFromAncestorsBlockByBlock) {
    expectChainFromAncestors({0, 0, 0});
    for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
        expectChainFromAncestors(TileId{0, 0, 0}.child(quadrant));
        expectChainFromAncestors(TileId{1, 1, 0}.child(quadrant));
        expectChainFromAncestors(TileId{2, 2, 1}.child(quadrant));
        expectChainFromAncestors(TileId{4, 7, 12}.child(quadrant));
    }
    for (const TileId& corner : {TileId{5, 0, 0}, TileId{5, 31, 0}, TileId{5, 0, 31}, TileId{5, 31, 31}})
        expectChainFromAncestors(corner);
}

TEST(MipChainDeathTest, StopsOnMissingOrWrongAncestors) {
    const ImageryTile tile = namedTile({2, 1, 1});
    const ImageryTile stranger = namedTile({1, 1, 1});
    const ImageryTile* ancestors[] = {&stranger, &stranger};
    EXPECT_DEATH((void)gatherMipChain(tile, {}), "ancestors");
    EXPECT_DEATH((void)gatherMipChain(tile, ancestors), "ancestor");
}

}  // namespace
}  // namespace terray
