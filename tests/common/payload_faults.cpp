#include "tests/common/payload_faults.h"

#include <cstring>

#include <gtest/gtest.h>

#include "common/checksum.h"
#include "tests/common/random.h"

namespace terray::test {

void expectRefusesTruncations(const Bytes& payload, const Accepts& accepts, size_t every) {
    EXPECT_TRUE(accepts(payload));
    for (size_t size = 0; size < payload.size(); size += size < every || size + 300 > payload.size() ? 1 : 251)
        EXPECT_FALSE(accepts(Bytes(payload.begin(), payload.begin() + static_cast<ptrdiff_t>(size)))) << size;
}

void expectRefusesExtraBytes(const Bytes& payload, const Accepts& accepts) {
    for (const std::byte extra : {std::byte{0}, std::byte{0xFF}}) {
        Bytes longer = payload;
        longer.push_back(extra);
        EXPECT_FALSE(accepts(longer));
    }
    Bytes twice = payload;
    twice.insert(twice.end(), payload.begin(), payload.end());
    EXPECT_FALSE(accepts(twice));
}

void expectRefusesBitFlips(const Bytes& payload, const Accepts& accepts, size_t every, size_t random) {
    const auto refusesFlip = [&](size_t position, size_t bit) {
        Bytes damaged = payload;
        damaged[position] ^= std::byte{1} << bit;
        EXPECT_FALSE(accepts(damaged)) << "byte " << position << ", bit " << bit;
    };
    const size_t whole = std::min(every, payload.size());
    for (size_t position = 0; position < whole; ++position)
        for (size_t bit = 0; bit < 8; ++bit) refusesFlip(position, bit);
    Random numbers(42);
    for (size_t i = 0; i < random && whole < payload.size(); ++i)
        refusesFlip(whole + numbers.below(payload.size() - whole), numbers.below(8));
}

Bytes resealed(Bytes payload, size_t position, std::byte value, size_t checksumPosition) {
    payload[position] = value;
    const uint32_t checksum = crc32c(ByteView(payload).first(checksumPosition));
    std::memcpy(payload.data() + checksumPosition, &checksum, sizeof checksum);
    return payload;
}

}  // namespace terray::test
