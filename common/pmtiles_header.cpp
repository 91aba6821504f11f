// The fixed header of pmtiles.h, and tile ids along Hilbert curves.
#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>
#include <utility>

#include "common/check.h"
#include "common/pmtiles.h"

namespace terray {
namespace {

constexpr std::string_view kMagic = "PMTiles";
constexpr uint8_t kVersion = 3;
constexpr double kDegreeSteps = 1e7;  // per degree

/// Tiles of all levels above `level`: 1 + 4 + 16 + ... = (4^level - 1) / 3.
uint64_t tilesAbove(uint32_t level) {
    return ((uint64_t{1} << (2 * level)) - 1) / 3;
}

/// One turn of the curve: within a quadrant of side `half` it is the whole curve mirrored or transposed.
void turn(uint64_t half, uint64_t& x, uint64_t& y, bool right, bool lower) {
    if (lower) return;
    if (right) {
        x = half - 1 - x;
        y = half - 1 - y;
    }
    std::swap(x, y);
}

int32_t stepsFromDegrees(double degrees, double limit) {
    return static_cast<int32_t>(std::llround(std::clamp(degrees, -limit, limit) * kDegreeSteps));
}

std::optional<PmtilesCompression> compressionFrom(uint8_t number) {
    if (number > static_cast<uint8_t>(PmtilesCompression::zstd)) return {};
    return PmtilesCompression{number};
}

}  // namespace

uint64_t hilbertId(const TileId& id) {
    TERRAY_CHECK(id.valid());
    uint64_t x = id.x;
    uint64_t y = id.y;
    uint64_t along = 0;
    for (uint64_t half = (uint64_t{1} << id.level) / 2; half > 0; half /= 2) {
        const bool right = (x & half) != 0;
        const bool lower = (y & half) != 0;
        along += half * half * ((right ? 3 : 0) ^ (lower ? 1 : 0));
        x &= half - 1;
        y &= half - 1;
        turn(half, x, y, right, lower);
    }
    return tilesAbove(id.level) + along;
}

Result<TileId> tileFromHilbert(uint64_t hilbert) {
    uint32_t level = 0;
    while (level < kMaxTileLevel && hilbert >= tilesAbove(level + 1)) ++level;
    const uint64_t along = hilbert - tilesAbove(level);
    if (along >= uint64_t{1} << (2 * level))
        return Failure{"tile number " + std::to_string(hilbert) + " lies beyond level " +
                       std::to_string(kMaxTileLevel)};

    uint64_t x = 0;
    uint64_t y = 0;
    uint64_t rest = along;
    for (uint64_t half = 1; half < uint64_t{1} << level; half *= 2) {
        const bool right = (rest & 2) != 0;
        const bool lower = ((rest & 1) != 0) != right;
        turn(half, x, y, right, lower);
        x += right ? half : 0;
        y += lower ? half : 0;
        rest /= 4;
    }
    return TileId{level, static_cast<uint32_t>(x), static_cast<uint32_t>(y)};
}

Bytes encodePmtilesHeader(const PmtilesHeader& header) {
    ByteWriter out;
    out.writeText(kMagic);
    out.write(kVersion);
    for (const uint64_t field : {header.rootOffset, header.rootLength, header.metadataOffset, header.metadataLength,
                                 header.leavesOffset, header.leavesLength, header.tilesOffset, header.tilesLength,
                                 header.addressedTiles, header.tileEntries, header.tileContents})
        out.write(field);
    out.write(static_cast<uint8_t>(header.clustered ? 1 : 0));
    out.write(static_cast<uint8_t>(header.internalCompression));
    out.write(static_cast<uint8_t>(header.tileCompression));
    out.write(header.tileType);
    out.write(header.minZoom);
    out.write(header.maxZoom);
    out.write(stepsFromDegrees(header.minLon, 180));
    out.write(stepsFromDegrees(header.minLat, 90));
    out.write(stepsFromDegrees(header.maxLon, 180));
    out.write(stepsFromDegrees(header.maxLat, 90));
    out.write(header.centerZoom);
    out.write(stepsFromDegrees(header.centerLon, 180));
    out.write(stepsFromDegrees(header.centerLat, 90));
    TERRAY_CHECK_OP(out.size(), ==, kPmtilesHeaderBytes);
    return out.release();
}

Result<PmtilesHeader> decodePmtilesHeader(ByteView bytes) {
    if (bytes.size() < kPmtilesHeaderBytes)
        return Failure{"PMTiles header: " + std::to_string(bytes.size()) + " bytes, expected " +
                       std::to_string(kPmtilesHeaderBytes)};
    ByteReader in(bytes);
    const ByteView magic = in.take(kMagic.size());
    if (!std::ranges::equal(magic, std::as_bytes(std::span(kMagic)))) return Failure{"not a PMTiles archive"};
    const auto version = in.read<uint8_t>();
    if (version != kVersion)
        return Failure{"PMTiles version " + std::to_string(version) + ", this build reads version 3"};

    PmtilesHeader header;
    for (uint64_t* field : {&header.rootOffset, &header.rootLength, &header.metadataOffset, &header.metadataLength,
                            &header.leavesOffset, &header.leavesLength, &header.tilesOffset, &header.tilesLength,
                            &header.addressedTiles, &header.tileEntries, &header.tileContents})
        *field = in.read<uint64_t>();
    const auto clustered = in.read<uint8_t>();
    header.clustered = clustered == 1;
    const auto internalCompression = compressionFrom(in.read<uint8_t>());
    const auto tileCompression = compressionFrom(in.read<uint8_t>());
    if (clustered > 1 || !internalCompression || !tileCompression)
        return Failure{"PMTiles header: a flag has a value that the specification does not know"};
    header.internalCompression = *internalCompression;
    header.tileCompression = *tileCompression;
    header.tileType = in.read<uint8_t>();
    header.minZoom = in.read<uint8_t>();
    header.maxZoom = in.read<uint8_t>();
    header.minLon = in.read<int32_t>() / kDegreeSteps;
    header.minLat = in.read<int32_t>() / kDegreeSteps;
    header.maxLon = in.read<int32_t>() / kDegreeSteps;
    header.maxLat = in.read<int32_t>() / kDegreeSteps;
    header.centerZoom = in.read<uint8_t>();
    header.centerLon = in.read<int32_t>() / kDegreeSteps;
    header.centerLat = in.read<int32_t>() / kDegreeSteps;
    return header;
}

}  // namespace terray
