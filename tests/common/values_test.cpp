// Small value types: bytes, units, Result.
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "common/bytes.h"
#include "common/error.h"
#include "common/result.h"
#include "common/units.h"
#include "common/version.h"

namespace terray {
namespace {

TEST(ByteReader, ReadsWhatAWriterWrote) {
    ByteWriter out;
    out.write(uint8_t{7});
    out.write(uint16_t{0x1234});
    out.write(-5.5F);
    out.write(int64_t{-9});
    out.writeText("abc");
    EXPECT_EQ(out.bytes()[1], std::byte{0x34});  // little-endian

    ByteReader in(out.bytes());
    EXPECT_EQ(in.read<uint8_t>(), 7);
    EXPECT_EQ(in.read<uint16_t>(), 0x1234);
    EXPECT_EQ(in.read<float>(), -5.5F);
    EXPECT_EQ(in.read<int64_t>(), -9);
    EXPECT_EQ(in.take(3).size(), 3U);
    EXPECT_TRUE(in.ok());
    EXPECT_EQ(in.remaining(), 0U);
}

TEST(ByteReader, FailsForGoodAtTheEnd) {
    const Bytes three(3, std::byte{1});
    ByteReader in(three);
    EXPECT_EQ(in.read<uint32_t>(), 0U);
    EXPECT_FALSE(in.ok());
    EXPECT_EQ(in.read<uint8_t>(), 0);
    EXPECT_TRUE(in.take(1).empty());
    EXPECT_EQ(in.position(), 0U);
}

TEST(ByteReader, RoundTripsVarints) {
    for (int bit = 0; bit < 64; ++bit)
        for (const uint64_t value : {uint64_t{1} << bit, (uint64_t{1} << bit) - 1, ~uint64_t{0} >> bit}) {
            ByteWriter out;
            out.writeVarint(value);
            EXPECT_LE(out.size(), 10U);
            ByteReader in(out.bytes());
            EXPECT_EQ(in.readVarint(), value);
            EXPECT_TRUE(in.ok());
            for (size_t size = 0; size < out.size(); ++size) {
                const Bytes cut(out.bytes().begin(), out.bytes().begin() + static_cast<ptrdiff_t>(size));
                ByteReader shortened(cut);
                (void)shortened.readVarint();
                EXPECT_FALSE(shortened.ok());
            }
        }
}

TEST(ByteReader, RefusesVarintsOver64Bits) {
    Bytes bytes(9, std::byte{0xFF});
    bytes.push_back(std::byte{0x02});  // bit 64
    ByteReader tooLarge(bytes);
    (void)tooLarge.readVarint();
    EXPECT_FALSE(tooLarge.ok());
    const Bytes endless(20, std::byte{0x80});
    ByteReader tooLong(endless);
    (void)tooLong.readVarint();
    EXPECT_FALSE(tooLong.ok());
}

TEST(Units, KeepTheirArithmetic) {
    EXPECT_EQ((Metres(3) + Metres(4) - Metres(2)).value(), 5);
    EXPECT_EQ((2 * Metres(3) / 4).value(), 1.5);
    EXPECT_EQ(Metres(3) / Metres(4), 0.75);
    EXPECT_LT(Pixels(1), Pixels(2));
    EXPECT_DOUBLE_EQ(radiansFromDegrees(180).value(), 3.14159265358979323846);
    EXPECT_DOUBLE_EQ(degreesFromRadians(radiansFromDegrees(37)), 37);
}

TEST(Result, HoldsAValueOrAReason) {
    const Result<int> good = 3;
    const Result<int> bad = Failure{"no"};
    EXPECT_TRUE(good.ok());
    EXPECT_EQ(*good, 3);
    EXPECT_FALSE(bad);
    EXPECT_EQ(bad.failure().message, "no");
    EXPECT_TRUE(Result<void>().ok());
    EXPECT_EQ(Result<void>(Failure{"why"}).failure().message, "why");
}

TEST(Result, MovesOutOfTemporaries) {
    const auto make = []() -> Result<std::unique_ptr<int>> { return std::make_unique<int>(5); };
    const std::unique_ptr<int> taken = *make();
    EXPECT_EQ(*taken, 5);
}

TEST(ResultDeathTest, StopsOnReadingWhatIsNotThere) {
    const Result<int> bad = Failure{"no"};
    const Result<int> good = 3;
    EXPECT_DEATH((void)*bad, "ok");
    EXPECT_DEATH((void)good.failure(), "ok");
}

TEST(BuildInfo, SaysWhatThisBuildIs) {
    EXPECT_FALSE(buildInfo().version.empty());
    EXPECT_FALSE(buildInfo().compiler.empty());
    EXPECT_TRUE(buildInfo().commit == "unknown" || buildInfo().commit.size() == 40) << buildInfo().commit;
}

}  // namespace
}  // namespace terray
