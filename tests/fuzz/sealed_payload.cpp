#include "tests/fuzz/sealed_payload.h"

#include <algorithm>

namespace terray::fuzz {
namespace {

bool beginsWith(ByteView bytes, std::string_view text) {
    return bytes.size() >= text.size() && std::ranges::equal(bytes.first(text.size()), std::as_bytes(std::span(text)));
}

}  // namespace

std::optional<Bytes> sealedPayload(ByteView payload, size_t fieldBytes) {
    const size_t unsealed = kPayloadPrefixBytes + fieldBytes;
    if (payload.size() < unsealed + kPayloadSealBytes) return {};
    ByteWriter out;
    out.writeBytes(payload.first(unsealed));
    sealPayload(out, payload.subspan(unsealed + kPayloadSealBytes));
    return out.release();
}

Bytes repeated(ByteView pattern, size_t count) {
    Bytes bytes(count);
    for (size_t done = 0; done < count; done += pattern.size())
        std::ranges::copy(pattern.first(std::min(pattern.size(), count - done)),
                          bytes.begin() + static_cast<ptrdiff_t>(done));
    return bytes;
}

bool readTile(ByteView bytes, const TileReading& reading) {
    if (bytes.empty()) return false;
    if (!beginsWith(bytes, reading.magic)) {
        reading.readPattern(bytes);
        return true;
    }
    const bool isWhole = reading.readPayload(bytes);
    const auto sealed = sealedPayload(bytes, reading.fieldBytes);
    return isWhole || (sealed && reading.readPayload(*sealed));
}

}  // namespace terray::fuzz
