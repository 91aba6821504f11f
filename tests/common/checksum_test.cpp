#include "common/checksum.h"

#include <gtest/gtest.h>

#include "tests/common/random.h"

namespace terray {
namespace {

ByteView bytesOf(std::string_view text) {
    return std::as_bytes(std::span(text));
}

/// The definition, bit by bit: what slicing must equal.
uint32_t slowCrc32c(ByteView bytes) {
    uint32_t crc = 0xFFFFFFFF;
    for (const std::byte byte : bytes) {
        crc ^= static_cast<uint32_t>(byte);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0x82F63B78 : 0);
    }
    return ~crc;
}

Bytes randomBytes(size_t size) {
    test::Random random(size);
    Bytes bytes(size);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.bits());
    return bytes;
}

TEST(Crc32c, GivesThePublishedValues) {
    EXPECT_EQ(crc32c(bytesOf("123456789")), 0xE3069283U);
    EXPECT_EQ(crc32c({}), 0U);
    // RFC 3720, appendix B.4
    EXPECT_EQ(crc32c(Bytes(32, std::byte{0})), 0x8A9136AAU);
    EXPECT_EQ(crc32c(Bytes(32, std::byte{0xFF})), 0x62A8AB43U);
}

TEST(Crc32c, EqualsItsDefinitionAtEveryLengthAndAlignment) {
    const Bytes bytes = randomBytes(80);
    for (size_t start = 0; start < 8; ++start)
        for (size_t size = 0; start + size <= bytes.size(); ++size) {
            const ByteView piece = ByteView(bytes).subspan(start, size);
            EXPECT_EQ(crc32c(piece), slowCrc32c(piece)) << start << "+" << size;
        }
}

TEST(Crc32c, ContinuesOverPieces) {
    const Bytes bytes = randomBytes(100);
    for (size_t cut = 0; cut <= bytes.size(); ++cut)
        EXPECT_EQ(crc32c(ByteView(bytes).subspan(cut), crc32c(ByteView(bytes).first(cut))), crc32c(bytes)) << cut;
}

}  // namespace
}  // namespace terray
