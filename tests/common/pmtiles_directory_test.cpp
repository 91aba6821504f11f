#include <limits>

#include <gtest/gtest.h>

#include "common/pmtiles.h"
#include "tests/common/payload_faults.h"
#include "tests/common/random.h"

namespace terray {
namespace {

using test::Random;
using Entries = std::vector<PmtilesEntry>;

PmtilesHeader fullHeader() {
    PmtilesHeader header;
    header.rootOffset = 127, header.rootLength = 5;
    header.metadataOffset = 132, header.metadataLength = uint64_t{1} << 40;
    header.leavesOffset = 3, header.leavesLength = 4;
    header.tilesOffset = ~uint64_t{0}, header.tilesLength = 6;
    header.addressedTiles = 7, header.tileEntries = 8, header.tileContents = 9;
    header.clustered = false;
    header.internalCompression = PmtilesCompression::gzip;
    header.tileCompression = PmtilesCompression::zstd;
    header.tileType = 2;
    header.minZoom = 1, header.maxZoom = 31, header.centerZoom = 12;
    header.minLon = -180, header.minLat = -89.9999999, header.maxLon = 179.9999999, header.maxLat = 90;
    header.centerLon = 7.6543211, header.centerLat = 45.1234567;
    return header;
}

TEST(PmtilesHeader, RoundTrips) {
    for (const PmtilesHeader& header : {PmtilesHeader(), fullHeader()}) {
        const Bytes bytes = encodePmtilesHeader(header);
        EXPECT_EQ(bytes.size(), kPmtilesHeaderBytes);
        const auto decoded = decodePmtilesHeader(bytes);
        ASSERT_TRUE(decoded.ok());
        EXPECT_EQ(*decoded, header);
    }
}

TEST(PmtilesHeader, PutsFieldsWhereTheSpecificationSays) {
    const Bytes bytes = encodePmtilesHeader(fullHeader());
    const auto at = [&](size_t position) { return static_cast<int>(bytes[position]); };
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), 7), "PMTiles");
    EXPECT_EQ(at(7), 3);
    EXPECT_EQ(at(8), 127);
    EXPECT_EQ(at(72), 7);
    EXPECT_EQ(at(96), 0);
    EXPECT_EQ(at(97), 2);
    EXPECT_EQ(at(98), 4);
    EXPECT_EQ(at(99), 2);
    EXPECT_EQ(at(100), 1);
    EXPECT_EQ(at(101), 31);
    EXPECT_EQ(at(118), 12);
}

TEST(PmtilesHeader, RefusesTruncationsOtherVersionsAndUnknownFlags) {
    const Bytes bytes = encodePmtilesHeader(fullHeader());
    for (size_t size = 0; size < bytes.size(); ++size)
        EXPECT_FALSE(decodePmtilesHeader(Bytes(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size))).ok());
    const auto changed = [&](size_t position, int value) {
        Bytes copy = bytes;
        copy[position] = static_cast<std::byte>(value);
        return decodePmtilesHeader(copy);
    };
    EXPECT_EQ(changed(7, 4).failure().message, "PMTiles version 4, this build reads version 3");
    EXPECT_FALSE(changed(7, 2).ok());
    EXPECT_FALSE(changed(0, 'p').ok());
    EXPECT_FALSE(changed(96, 2).ok());
    EXPECT_FALSE(changed(97, 5).ok());
    EXPECT_FALSE(changed(98, 5).ok());
}

/// Entries as a writer makes them: ascending, mostly contiguous, with runs, gaps and shared contents.
Entries randomEntries(Random& random, size_t count) {
    Entries entries;
    uint64_t id = random.below(1000);
    uint64_t end = 0;
    for (size_t i = 0; i < count; ++i) {
        PmtilesEntry entry{.tileId = id, .offset = end, .length = static_cast<uint32_t>(1 + random.below(1 << 20))};
        entry.runLength = static_cast<uint32_t>(random.below(5));
        if (random.below(4) == 0) entry.offset = random.below(uint64_t{1} << 50);
        end = entry.offset + entry.length;
        id += std::max<uint64_t>(entry.runLength, 1) + (random.below(2) == 0 ? 0 : random.below(uint64_t{1} << 40));
        entries.push_back(entry);
    }
    return entries;
}

TEST(PmtilesDirectory, RoundTripsRandomEntries) {
    Random random(1);
    for (int i = 0; i < 300; ++i) {
        const Entries entries = randomEntries(random, 1 + random.below(200));
        const auto decoded = decodePmtilesDirectory(encodePmtilesDirectory(entries));
        ASSERT_TRUE(decoded.ok()) << decoded.failure().message;
        EXPECT_EQ(*decoded, entries);
    }
}

TEST(PmtilesDirectory, EncodesAsTheSpecificationSays) {
    const Bytes bytes = encodePmtilesDirectory({{5, 0, 300, 1}, {42, 300, 10, 2}, {69, 0, 300, 1}});
    const uint8_t expected[] = {3, 5, 37, 27, 1, 2, 1, 0xAC, 2, 10, 0xAC, 2, 1, 0, 1};
    EXPECT_TRUE(std::ranges::equal(bytes, std::as_bytes(std::span(expected))));
}

TEST(PmtilesDirectory, RefusesEveryTruncationAndExtraBytes) {
    Random random(2);
    const Bytes bytes = encodePmtilesDirectory(randomEntries(random, 40));
    const auto accepts = [](ByteView view) { return decodePmtilesDirectory(view).ok(); };
    test::expectRefusesTruncations(bytes, accepts);
    test::expectRefusesExtraBytes(bytes, accepts);
}

TEST(PmtilesDirectory, RefusesEntriesThatMakeNoSense) {
    const auto complaint = [](const Entries& entries) {
        const auto result = decodePmtilesDirectory(encodePmtilesDirectory(entries));
        return result.ok() ? "accepted" : result.failure().message;
    };
    EXPECT_EQ(complaint({{1, 0, 1, 1}, {2, 1, 1, 1}}), "accepted");
    EXPECT_NE(complaint({}), "accepted");
    EXPECT_NE(complaint({{1, 0, 0, 1}}), "accepted");                 // length 0
    EXPECT_NE(complaint({{1, 0, 1, 1}, {1, 1, 1, 1}}), "accepted");   // the same tile twice
    EXPECT_NE(complaint({{1, 0, 1, 3}, {3, 1, 1, 1}}), "accepted");   // a run into the next entry
    EXPECT_NE(complaint({{1, 0, 1, 0}, {1, 1, 1, 0}}), "accepted");   // two leaves from one tile
    EXPECT_NE(complaint({{1, ~uint64_t{0} - 1, 5, 1}}), "accepted");  // an end beyond 2^64
    ByteWriter noOffset;
    for (const uint64_t field : {1, 1, 1, 1, 0}) noOffset.writeVarint(field);
    EXPECT_FALSE(decodePmtilesDirectory(noOffset.bytes()).ok());
    ByteWriter longRun;
    for (const uint64_t field : {uint64_t{1}, uint64_t{1}, uint64_t{1} << 32, uint64_t{1}, uint64_t{1}})
        longRun.writeVarint(field);
    EXPECT_FALSE(decodePmtilesDirectory(longRun.bytes()).ok());
    ByteWriter overflow;
    for (const uint64_t field : {uint64_t{2}, ~uint64_t{0}, uint64_t{1}, uint64_t{1}, uint64_t{1}, uint64_t{1},
                                 uint64_t{1}, uint64_t{1}, uint64_t{1}})
        overflow.writeVarint(field);
    EXPECT_FALSE(decodePmtilesDirectory(overflow.bytes()).ok());
}

TEST(PmtilesDirectory, RefusesAbsurdCountsWithoutAllocating) {
    for (int bit = 2; bit < 64; ++bit) {
        ByteWriter out;
        out.writeVarint(uint64_t{1} << bit);
        out.writeBytes(Bytes(8, std::byte{1}));
        EXPECT_FALSE(decodePmtilesDirectory(out.bytes()).ok());
    }
}

TEST(PmtilesDirectory, SurvivesRandomBytes) {
    Random random(3);
    for (int i = 0; i < 50000; ++i) {
        Bytes bytes(random.below(64));
        // Small numbers get far into the format, large ones to its limits.
        const bool small = random.below(2) == 0;
        for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.below(small ? 6 : 256));
        const auto decoded = decodePmtilesDirectory(bytes);
        if (!decoded.ok()) continue;
        EXPECT_LE(decoded->size(), bytes.size() / 4);
        // Offsets have two spellings, so equality is asked of the entries only.
        EXPECT_EQ(*decodePmtilesDirectory(encodePmtilesDirectory(*decoded)), *decoded);
    }
}

}  // namespace
}  // namespace terray
