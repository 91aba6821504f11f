#include "common/tile_payload.h"

#include <limits>

#include "common/check.h"
#include "common/checksum.h"

namespace terray {
namespace {

PayloadPrefix readPrefix(ByteView payload) {
    ByteReader reader(payload);
    PayloadPrefix prefix;
    for (char& c : prefix.magic) c = reader.read<char>();
    prefix.version = reader.read<uint16_t>();
    prefix.codec = reader.read<uint8_t>();
    prefix.flags = reader.read<uint8_t>();
    prefix.id.level = reader.read<uint32_t>();
    prefix.id.x = reader.read<uint32_t>();
    prefix.id.y = reader.read<uint32_t>();
    return prefix;
}

}  // namespace

void writePayloadPrefix(ByteWriter& out, const PayloadPrefix& prefix) {
    out.writeText(std::string_view(prefix.magic.data(), prefix.magic.size()));
    out.write(prefix.version);
    out.write(prefix.codec);
    out.write(prefix.flags);
    out.write(prefix.id.level);
    out.write(prefix.id.x);
    out.write(prefix.id.y);
}

void sealPayload(ByteWriter& out, ByteView body) {
    TERRAY_CHECK_OP(body.size(), <=, std::numeric_limits<uint32_t>::max());
    out.write(static_cast<uint32_t>(body.size()));
    out.write(crc32c(body));
    out.write(crc32c(out.bytes()));
    out.writeBytes(body);
}

Result<OpenedPayload> openPayload(const std::string& what, ByteView payload, const PayloadPrefix& expected,
                                  size_t fieldBytes, std::optional<TileId> expectedId) {
    const size_t headerBytes = kPayloadPrefixBytes + fieldBytes + kPayloadSealBytes;
    if (payload.size() < headerBytes)
        return Failure{what + ": cut short, " + std::to_string(payload.size()) + " bytes where the header alone has " +
                       std::to_string(headerBytes)};
    const PayloadPrefix prefix = readPrefix(payload);
    if (prefix.magic != expected.magic) return Failure{what + ": does not start with its magic number"};
    if (prefix.version != expected.version)
        return Failure{what + ": payload version " + std::to_string(prefix.version) + ", this build reads " +
                       std::to_string(expected.version)};

    // The header's checksum comes before any other field is believed.
    ByteReader seal(payload.subspan(kPayloadPrefixBytes + fieldBytes, kPayloadSealBytes));
    const auto bodyBytes = seal.read<uint32_t>();
    const auto bodyChecksum = seal.read<uint32_t>();
    const auto headerChecksum = seal.read<uint32_t>();
    if (crc32c(payload.first(headerBytes - sizeof headerChecksum)) != headerChecksum)
        return Failure{what + ": damaged, the header's checksum does not match"};
    const std::string name = what + " " + toString(prefix.id);
    if (!prefix.id.valid()) return Failure{name + ": no such tile can exist"};
    if (expectedId && prefix.id != *expectedId)
        return Failure{name + ": found where " + toString(*expectedId) + " was expected"};
    if (payload.size() - headerBytes != bodyBytes)
        return Failure{name + ": " + std::to_string(payload.size() - headerBytes) +
                       " bytes follow the header, it says " + std::to_string(bodyBytes)};
    const ByteView body = payload.subspan(headerBytes);
    if (crc32c(body) != bodyChecksum) return Failure{name + ": damaged, the body's checksum does not match"};
    return OpenedPayload{prefix, payload.subspan(kPayloadPrefixBytes, fieldBytes), body};
}

}  // namespace terray
