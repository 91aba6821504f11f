#include "common/zstd_block.h"

#include <memory>

#include <zstd.h>

#include "common/check.h"

namespace terray {

Bytes zstdCompress(ByteView bytes, int level) {
    thread_local const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), ZSTD_freeCCtx);
    TERRAY_CHECK(context != nullptr);
    Bytes frame(ZSTD_compressBound(bytes.size()));
    const size_t size = ZSTD_compressCCtx(context.get(), frame.data(), frame.size(), bytes.data(), bytes.size(), level);
    TERRAY_CHECK(ZSTD_isError(size) == 0);  // cannot fail: the target holds the worst case
    frame.resize(size);
    return frame;
}

bool zstdDecompress(ByteView frame, std::span<std::byte> target) {
    thread_local const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
    TERRAY_CHECK(context != nullptr);
    // zstd may be built to read the formats before its first release, too, with decoders that allocate for themselves.
    if (ByteReader(frame).read<uint32_t>() != ZSTD_MAGICNUMBER) return false;
    // zstd would read several frames in a row; a payload holds one.
    if (ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size()) return false;
    const size_t size = ZSTD_decompressDCtx(context.get(), target.data(), target.size(), frame.data(), frame.size());
    return size == target.size();
}

}  // namespace terray
