#include "common/zstd_block.h"

#include <cstring>

#include <gtest/gtest.h>

namespace terray {
namespace {

Bytes frameOf(size_t size) {
    return zstdCompress(Bytes(size, std::byte{7}), 1);
}

bool unpacks(ByteView frame, size_t size) {
    Bytes target(size);
    return zstdDecompress(frame, target);
}

TEST(ZstdBlock, IsOneWholeFrameOfExactlyTheSizeAskedFor) {
    const Bytes frame = frameOf(1000);
    EXPECT_TRUE(unpacks(frame, 1000));
    EXPECT_FALSE(unpacks(frame, 999));
    EXPECT_FALSE(unpacks(frame, 1001));
    for (size_t size = 0; size < frame.size(); ++size) EXPECT_FALSE(unpacks(ByteView(frame).first(size), 1000)) << size;
    Bytes twice = frame;
    twice.insert(twice.end(), frame.begin(), frame.end());
    EXPECT_FALSE(unpacks(twice, 1000));
    EXPECT_FALSE(unpacks(twice, 2000));
}

// zstd reads frames that hold nothing, and those of versions 0.5 to 0.7 if it is built to.
TEST(ZstdBlock, IsNoFrameOfAnotherKind) {
    const uint32_t skippable[] = {0x184D2A50, 4, 0};
    EXPECT_FALSE(unpacks(std::as_bytes(std::span(skippable)), 0));
    for (const uint32_t magic : {0xFD2FB525U, 0xFD2FB526U, 0xFD2FB527U}) {
        Bytes frame = frameOf(1000);
        std::memcpy(frame.data(), &magic, sizeof magic);
        EXPECT_FALSE(unpacks(frame, 1000)) << magic;
    }
}

}  // namespace
}  // namespace terray
