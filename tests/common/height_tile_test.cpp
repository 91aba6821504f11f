#include "common/height_tile.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/common/payload_faults.h"
#include "tests/common/random.h"

namespace terray {
namespace {

using test::Random;

// Where fields lie in a payload (FORMAT.md).
constexpr size_t kVersionAt = 4, kCodecAt = 6, kFlagsAt = 7, kExponentAt = 20, kOwnFlagsAt = 40, kOwnErrorAt = 52;
constexpr size_t kHeaderChecksumAt = 128;

Grid<uint16_t> emptyCodes() {
    return Grid<uint16_t>({kHeightTileSide, kHeightTileSide});
}

/// A tile with these codes and everything else filled in.
HeightTile tileOf(Grid<uint16_t> codes) {
    HeightTile tile{.id = {5, 3, 7}, .encoding = HeightEncoding::covering(1000, 1900, 0.01), .codes = std::move(codes)};
    tile.record = measureRecord(tile.codes, tile.encoding, 2.5F);
    tile.children[1] = {.exists = true, .hasHoles = true, .minHeight = -3, .maxHeight = 12.5F, .error = 0.25F};
    tile.children[3] = {.exists = true, .minHeight = 7, .maxHeight = 7};
    return tile;
}

HeightTile rampTile() {
    auto codes = emptyCodes();
    for (int64_t y = 0; y < codes.height(); ++y)
        for (int64_t x = 0; x < codes.width(); ++x) codes.at(x, y) = static_cast<uint16_t>(1 + x * 20 + y * 100);
    return tileOf(std::move(codes));
}

HeightTile noiseTile(uint64_t seed, uint64_t holesInHundred) {
    Random random(seed);
    auto codes = emptyCodes();
    for (uint16_t& code : codes.cells())
        code = random.below(100) < holesInHundred ? uint16_t{0} : static_cast<uint16_t>(1 + random.below(65535));
    return tileOf(std::move(codes));
}

HeightTile constantTile() {
    auto codes = emptyCodes();
    for (uint16_t& code : codes.cells()) code = 40000;
    return tileOf(std::move(codes));
}

bool accepts(ByteView payload) {
    return decodeHeightTile(payload).ok();
}

void expectRoundTrip(const HeightTile& tile) {
    const Bytes payload = encodeHeightTile(tile);
    const auto decoded = decodeHeightTile(payload, tile.id);
    ASSERT_TRUE(decoded.ok()) << decoded.failure().message;
    EXPECT_TRUE(*decoded == tile);
    EXPECT_EQ(encodeHeightTile(*decoded), payload);
}

TEST(HeightTile, RoundTripsEveryKindOfGround) {
    expectRoundTrip(rampTile());
    expectRoundTrip(constantTile());
    expectRoundTrip(tileOf(emptyCodes()));  // no surface at all: only a root may be so
    for (const uint64_t holes : {0, 1, 50, 99}) expectRoundTrip(noiseTile(holes, holes));
}

TEST(HeightTile, RoundTripsHolesAtEveryBorder) {
    for (int border = 0; border < 4; ++border) {
        HeightTile tile = rampTile();
        for (int64_t along = 0; along < kHeightTileSide; ++along)
            for (int64_t depth = 0; depth < 37; ++depth) {
                const int64_t across = border % 2 == 0 ? depth : kHeightTileSide - 1 - depth;
                (border < 2 ? tile.codes.at(across, along) : tile.codes.at(along, across)) = kNoSurface;
            }
        tile.record = measureRecord(tile.codes, tile.encoding, 1);
        expectRoundTrip(tile);
    }
}

TEST(HeightTile, RoundTripsExtremeCodes) {
    auto codes = emptyCodes();
    for (int64_t y = 0; y < codes.height(); ++y)
        for (int64_t x = 0; x < codes.width(); ++x) codes.at(x, y) = (x + y) % 2 == 0 ? 1 : 65535;
    expectRoundTrip(tileOf(std::move(codes)));
}

TEST(HeightTile, StoresConstantGroundInAFewBytes) {
    EXPECT_LT(encodeHeightTile(constantTile()).size(), 256U);
}

TEST(HeightTile, StoresHolesAtLittleCost) {
    // A hole of a fifth of the tile amid rough ground must not cost more than the ground it replaces.
    HeightTile tile = noiseTile(3, 0);
    for (uint16_t& code : tile.codes.cells()) code = static_cast<uint16_t>(30000 + code % 64);
    tile.record = measureRecord(tile.codes, tile.encoding, 1);
    const size_t whole = encodeHeightTile(tile).size();
    for (int64_t y = 100; y < 330; ++y)
        for (int64_t x = 100; x < 330; ++x) tile.codes.at(x, y) = kNoSurface;
    tile.record = measureRecord(tile.codes, tile.encoding, 1);
    EXPECT_LT(encodeHeightTile(tile).size(), whole);
}

TEST(HeightTile, RefusesEveryTruncation) {
    test::expectRefusesTruncations(encodeHeightTile(rampTile()), accepts);
    test::expectRefusesTruncations(encodeHeightTile(noiseTile(1, 5)), accepts, 300);
}

TEST(HeightTile, RefusesExtraBytes) {
    test::expectRefusesExtraBytes(encodeHeightTile(rampTile()), accepts);
}

TEST(HeightTile, DetectsEveryFlippedBit) {
    test::expectRefusesBitFlips(encodeHeightTile(constantTile()), accepts);
    test::expectRefusesBitFlips(encodeHeightTile(noiseTile(2, 1)), accepts, 200, 300);
}

TEST(HeightTile, RefusesOtherVersionsCodecsAndFlags) {
    const Bytes payload = encodeHeightTile(rampTile());
    const auto changed = [&](size_t position, int value) {
        return decodeHeightTile(test::resealed(payload, position, static_cast<std::byte>(value), kHeaderChecksumAt));
    };
    EXPECT_EQ(changed(kVersionAt, 2).failure().message, "height tile: payload version 2, this build reads 1");
    EXPECT_FALSE(changed(0, 'X').ok());
    EXPECT_FALSE(changed(kCodecAt, 2).ok());
    EXPECT_FALSE(changed(kFlagsAt, 1).ok());
    EXPECT_FALSE(changed(kExponentAt, 41).ok());
    EXPECT_FALSE(changed(kOwnFlagsAt, 7).ok());
    EXPECT_FALSE(changed(kOwnErrorAt + 3, 0xC0).ok());  // a negative error
    EXPECT_TRUE(changed(kCodecAt, 1).ok());
}

TEST(HeightTile, RefusesAbsurdSizes) {
    const Bytes payload = encodeHeightTile(rampTile());
    constexpr size_t kBodySizeAt = 120;
    for (size_t byte = 0; byte < 4; ++byte)
        EXPECT_FALSE(accepts(test::resealed(payload, kBodySizeAt + byte, std::byte{0xFF}, kHeaderChecksumAt)));
}

TEST(HeightTile, RefusesARecordThatContradictsItsCodes) {
    const HeightTile tile = rampTile();
    const Bytes payload = encodeHeightTile(tile);
    constexpr size_t kOwnMinAt = 44, kOwnMaxAt = 48;
    for (const size_t position : {kOwnMinAt, kOwnMaxAt, kOwnFlagsAt}) {
        const std::byte changed = payload[position] ^ std::byte{1};
        EXPECT_FALSE(accepts(test::resealed(payload, position, changed, kHeaderChecksumAt))) << position;
    }
}

TEST(HeightTile, RefusesAnotherId) {
    const Bytes payload = encodeHeightTile(rampTile());
    EXPECT_FALSE(decodeHeightTile(payload, TileId{5, 3, 6}).ok());
    EXPECT_FALSE(decodeHeightHeader(payload, TileId{4, 3, 7}).ok());
    EXPECT_TRUE(decodeHeightTile(payload, TileId{5, 3, 7}).ok());
    // An id that no tile can have: level 5 with x 35.
    EXPECT_FALSE(accepts(test::resealed(payload, 12, std::byte{35}, kHeaderChecksumAt)));
}

TEST(HeightTile, ReadsItsHeaderAlone) {
    const HeightTile tile = noiseTile(9, 10);
    const auto header = decodeHeightHeader(encodeHeightTile(tile));
    ASSERT_TRUE(header.ok());
    EXPECT_EQ(header->id, tile.id);
    EXPECT_EQ(header->encoding, tile.encoding);
    EXPECT_EQ(header->record, tile.record);
    EXPECT_EQ(header->children, tile.children);
    EXPECT_EQ(header->codes.size().count(), 0);
}

TEST(HeightTile, SurvivesRandomBytes) {
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
        Bytes bytes(random.below(400));
        for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.bits());
        EXPECT_FALSE(accepts(bytes));
    }
}

TEST(HeightTileDeathTest, StopsOnEncodingAFalseRecord) {
    HeightTile tile = rampTile();
    tile.record.maxHeight += 1;
    EXPECT_DEATH((void)encodeHeightTile(tile), "record");
}

TEST(HeightRecord, CoversTheApronButExistsOnlyByItsCore) {
    const HeightEncoding encoding = HeightEncoding::covering(0, 100, 0.01);
    auto codes = emptyCodes();
    codes.at(0, 0) = encoding.code(40);  // apron
    HeightRecord record = measureRecord(codes, encoding, 3);
    EXPECT_FALSE(record.exists);
    EXPECT_TRUE(record.hasHoles);
    EXPECT_FLOAT_EQ(record.minHeight, 40);

    codes.at(2, 2) = encoding.code(10);  // the first core cell
    codes.at(515, 515) = encoding.code(90);
    record = measureRecord(codes, encoding, 3);
    EXPECT_TRUE(record.exists);
    EXPECT_FLOAT_EQ(record.minHeight, 10);
    EXPECT_FLOAT_EQ(record.maxHeight, 90);
    EXPECT_EQ(record.error, 3);

    codes = emptyCodes();
    codes.at(513, 513) = 1;  // the last core cell
    EXPECT_TRUE(measureRecord(codes, encoding, 0).exists);
    codes = emptyCodes();
    codes.at(514, 513) = 1;  // one beyond
    EXPECT_FALSE(measureRecord(codes, encoding, 0).exists);
    EXPECT_EQ(measureRecord(emptyCodes(), encoding, 3), HeightRecord{.hasHoles = true});
}

TEST(HeightRecord, RoundsItsBoundsOutward) {
    Random random(17);
    for (int i = 0; i < 200; ++i) {
        const double low = random.between(-12000, 9000);
        const HeightEncoding encoding = HeightEncoding::covering(low, low + 500, random.between(1e-4, 0.1));
        auto codes = emptyCodes();
        codes.at(10, 10) = encoding.code(low);
        codes.at(11, 10) = encoding.code(low + 500);
        const HeightRecord record = measureRecord(codes, encoding, 0);
        EXPECT_LE(static_cast<double>(record.minHeight), encoding.height(codes.at(10, 10)));
        EXPECT_GE(static_cast<double>(record.maxHeight), encoding.height(codes.at(11, 10)));
    }
}

TEST(HeightRecord, RoundsFloatsToTheNearestOnTheAskedSide) {
    Random random(23);
    for (int i = 0; i < 10000; ++i) {
        const double value = random.between(-1e5, 1e5);
        const float below = floatAtMost(value);
        const float above = floatAtLeast(value);
        EXPECT_LE(static_cast<double>(below), value);
        EXPECT_GE(static_cast<double>(above), value);
        EXPECT_EQ(std::nextafter(below, std::numeric_limits<float>::infinity()), above);
    }
    EXPECT_EQ(floatAtMost(0.5), 0.5F);
    EXPECT_EQ(floatAtLeast(0.5), 0.5F);
    EXPECT_EQ(floatAtLeast(0), 0.0F);
}

TEST(HeightEncoding, StoresEveryHeightWithinHalfAStep) {
    Random random(31);
    for (int i = 0; i < 3000; ++i) {
        const double quantum = std::pow(10, random.between(-4, 1));
        const double low = random.between(-12000, 9000);
        const double high = low + std::pow(10, random.between(-3, 4.5));
        const HeightEncoding encoding = HeightEncoding::covering(low, high, quantum);
        // Half a step, and as much again as doubles of this size round.
        const double bound = encoding.metresPerCode() * (0.5 + 1e-6);
        for (int j = 0; j < 20; ++j) {
            const double height = j == 0 ? low : j == 1 ? high : random.between(low, high);
            const uint16_t code = encoding.code(height);
            ASSERT_GE(code, 1);
            ASSERT_NEAR(encoding.height(code), height, bound);
        }
    }
}

TEST(HeightEncoding, TakesTheSmallestExponentThatFits) {
    EXPECT_EQ(HeightEncoding::covering(0, 655.34, 0.01).exponent, 0U);
    EXPECT_EQ(HeightEncoding::covering(0, 655.35, 0.01).exponent, 1U);
    EXPECT_EQ(HeightEncoding::covering(-11000, 9000, 0.01).exponent, 5U);
    const HeightEncoding flat = HeightEncoding::covering(12.34, 12.34, 0.01);
    EXPECT_EQ(flat.exponent, 0U);
    EXPECT_EQ(flat.code(12.34), 1);
    Random random(37);
    for (int i = 0; i < 2000; ++i) {
        const double low = random.between(-12000, 9000);
        const double high = low + random.between(0, 30000);
        const HeightEncoding encoding = HeightEncoding::covering(low, high, 0.01);
        if (encoding.exponent == 0) continue;
        const double finer = encoding.metresPerCode() / 2;
        EXPECT_GT(std::round(high / finer) - std::round(low / finer), 65534);
    }
}

TEST(HeightEncoding, NeighboursOfOneExponentAgreeOnSharedHeights) {
    Random random(41);
    for (int i = 0; i < 2000; ++i) {
        const double shared = random.between(0, 100);
        const HeightEncoding a = HeightEncoding::covering(shared - random.between(0, 300), shared + 10, 0.01);
        const HeightEncoding b = HeightEncoding::covering(shared - 5, shared + random.between(0, 300), 0.01);
        ASSERT_EQ(a.exponent, b.exponent);
        EXPECT_EQ(a.height(a.code(shared)), b.height(b.code(shared)));
    }
}

TEST(HeightEncodingDeathTest, StopsOnMisuse) {
    EXPECT_DEATH((void)HeightEncoding::covering(2, 1, 0.01), "minHeight");
    EXPECT_DEATH((void)HeightEncoding::covering(0, std::numeric_limits<double>::infinity(), 0.01), "isfinite");
    EXPECT_DEATH((void)HeightEncoding::covering(0, 1, 0), "");
    EXPECT_DEATH((void)HeightEncoding::covering(0, 1, 0.01).code(-1), "code");
}

}  // namespace
}  // namespace terray
