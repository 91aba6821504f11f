#include "common/checksum.h"

#include <array>
#include <cstring>

namespace terray {
namespace {

// Slicing by 8 (Kounavis and Berry 2008, "Novel table lookup-based algorithms for high-performance CRC generation",
// doi 10.1109/TC.2008.85): table k gives the effect of a byte that k further bytes follow, so eight bytes go at once.
using Table = std::array<std::array<uint32_t, 256>, 8>;

constexpr Table makeTable() {
    constexpr uint32_t kReflectedPolynomial = 0x82F63B78;
    Table table{};
    for (uint32_t byte = 0; byte < 256; ++byte) {
        uint32_t crc = byte;
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? kReflectedPolynomial : 0);
        table[0][byte] = crc;
    }
    for (size_t slice = 1; slice < 8; ++slice)
        for (size_t byte = 0; byte < 256; ++byte) {
            const uint32_t previous = table[slice - 1][byte];
            table[slice][byte] = (previous >> 8) ^ table[0][previous & 0xff];
        }
    return table;
}

constexpr Table kTable = makeTable();

uint32_t eightBytes(uint32_t crc, const std::byte* bytes) {
    uint64_t word = 0;
    std::memcpy(&word, bytes, sizeof word);
    word ^= crc;
    uint32_t result = 0;
    for (size_t slice = 0; slice < 8; ++slice) result ^= kTable[7 - slice][(word >> (8 * slice)) & 0xff];
    return result;
}

}  // namespace

uint32_t crc32c(ByteView bytes, uint32_t previous) {
    uint32_t crc = ~previous;
    for (; bytes.size() >= 8; bytes = bytes.subspan(8)) crc = eightBytes(crc, bytes.data());
    for (const std::byte byte : bytes) crc = (crc >> 8) ^ kTable[0][(crc ^ static_cast<uint32_t>(byte)) & 0xff];
    return ~crc;
}

}  // namespace terray
