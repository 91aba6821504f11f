#include "common/height_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "common/height_planes.h"
#include "common/tile_payload.h"
#include "common/zstd_block.h"

namespace terray {
namespace {

constexpr PayloadPrefix kPrefix{.magic = {'T', 'R', 'Y', 'H'}, .version = 1, .codec = 1};
constexpr GridSize kSize{kHeightTileSide, kHeightTileSide};
constexpr size_t kRecordBytes = 16;
constexpr size_t kFieldBytes = 20 + 5 * kRecordBytes;
constexpr uint32_t kMaxExponent = 40;
constexpr double kMaxOffset = 1099511627776.0;  // 2^40
constexpr int kZstdLevel = 1;                   // FORMAT.md holds the measurements behind it

constexpr uint32_t kExistsBit = 1;
constexpr uint32_t kHolesBit = 2;

void writeRecord(ByteWriter& out, const HeightRecord& record) {
    out.write((record.exists ? kExistsBit : 0) | (record.hasHoles ? kHolesBit : 0));
    out.write(record.minHeight);
    out.write(record.maxHeight);
    out.write(record.error);
}

/// Nothing when the flags hold unknown bits or the numbers make no sense.
std::optional<HeightRecord> readRecord(ByteReader& in) {
    const auto flags = in.read<uint32_t>();
    HeightRecord record{.exists = (flags & kExistsBit) != 0, .hasHoles = (flags & kHolesBit) != 0};
    record.minHeight = in.read<float>();
    record.maxHeight = in.read<float>();
    record.error = in.read<float>();
    const bool finite =
        std::isfinite(record.minHeight) && std::isfinite(record.maxHeight) && std::isfinite(record.error);
    if ((flags & ~(kExistsBit | kHolesBit)) != 0 || !finite) return {};
    if (record.minHeight > record.maxHeight || record.error < 0) return {};
    return record;
}

/// Header and checksums of a payload; `body` is a view into it.
struct OpenedTile {
    HeightTile tile;
    ByteView body;
};

Result<OpenedTile> openTile(ByteView payload, std::optional<TileId> expected) {
    auto opened = openPayload("height tile", payload, kPrefix, kFieldBytes, expected);
    if (!opened.ok()) return opened.failure();
    HeightTile tile;
    tile.id = opened->prefix.id;
    const std::string name = "height tile " + toString(tile.id);
    if (opened->prefix.codec != kPrefix.codec)
        return Failure{name + ": codec " + std::to_string(opened->prefix.codec) + " is unknown"};
    if (opened->prefix.flags != 0) return Failure{name + ": unknown flags"};

    ByteReader fields(opened->fields);
    tile.encoding.exponent = fields.read<uint32_t>();
    tile.encoding.quantum = fields.read<double>();
    tile.encoding.offset = fields.read<int64_t>();
    if (!tile.encoding.valid()) return Failure{name + ": its encoding is out of range"};
    const auto own = readRecord(fields);
    if (!own) return Failure{name + ": its record is out of range"};
    tile.record = *own;
    for (HeightRecord& child : tile.children) {
        const auto record = readRecord(fields);
        if (!record) return Failure{name + ": the record of a child is out of range"};
        if (!record->exists && *record != HeightRecord{})
            return Failure{name + ": the record of an absent child is not empty"};
        child = *record;
    }
    return OpenedTile{std::move(tile), opened->body};
}

}  // namespace

bool HeightEncoding::valid() const {
    return quantum >= 1e-9 && quantum <= 1e6 && exponent <= kMaxExponent &&
           std::abs(static_cast<double>(offset)) < kMaxOffset;
}

uint16_t HeightEncoding::code(double height) const {
    const double code = std::round(height / metresPerCode()) - static_cast<double>(offset);
    TERRAY_CHECK_OP(code, >=, 0);
    TERRAY_CHECK_OP(code, <=, 65536);
    return static_cast<uint16_t>(std::clamp(code, 1.0, 65535.0));
}

HeightEncoding HeightEncoding::covering(double minHeight, double maxHeight, double quantum) {
    TERRAY_CHECK_OP(minHeight, <=, maxHeight);
    TERRAY_CHECK(std::isfinite(minHeight) && std::isfinite(maxHeight));
    constexpr double kSpan = 65534;  // from code 1 to code 65535
    HeightEncoding encoding{.quantum = quantum, .exponent = 0};
    const auto steps = [&](double height) { return std::round(height / encoding.metresPerCode()); };
    while (encoding.exponent < kMaxExponent &&
           (steps(maxHeight) - steps(minHeight) > kSpan || std::abs(steps(minHeight)) + 1 >= kMaxOffset))
        ++encoding.exponent;
    TERRAY_CHECK_OP(steps(maxHeight) - steps(minHeight), <=, kSpan);
    TERRAY_CHECK_OP(std::abs(steps(minHeight)) + 1, <, kMaxOffset);
    encoding.offset = static_cast<int64_t>(steps(minHeight)) - 1;
    TERRAY_CHECK(encoding.valid());
    return encoding;
}

float floatAtMost(double value) {
    const auto nearest = static_cast<float>(value);
    return static_cast<double>(nearest) <= value ? nearest
                                                 : std::nextafter(nearest, -std::numeric_limits<float>::infinity());
}

float floatAtLeast(double value) {
    return -floatAtMost(-value);
}

HeightRecord measureRecord(const Grid<uint16_t>& codes, const HeightEncoding& encoding, float error) {
    TERRAY_CHECK(codes.size() == kSize);
    // Less one, a hole becomes the greatest number, so that one pass of plain minima and maxima finds all.
    uint16_t leastLessOne = std::numeric_limits<uint16_t>::max();
    uint16_t greatestLessOne = 0;
    uint16_t greatest = 0;
    for (const uint16_t code : codes.cells()) {
        const auto lessOne = static_cast<uint16_t>(code - 1);
        leastLessOne = std::min(leastLessOne, lessOne);
        greatestLessOne = std::max(greatestLessOne, lessOne);
        greatest = std::max(greatest, code);
    }
    HeightRecord record{.exists = false, .hasHoles = greatestLessOne == std::numeric_limits<uint16_t>::max()};
    if (greatest == kNoSurface) return record;

    record.minHeight = floatAtMost(encoding.height(static_cast<uint16_t>(leastLessOne + 1)));
    record.maxHeight = floatAtLeast(encoding.height(greatest));
    record.error = error;
    const auto core = codes.view().window({kHeightApron, kHeightApron, kTileCore, kTileCore});
    for (int64_t y = 0; y < core.height() && !record.exists; ++y) {
        const auto row = core.row(y);
        record.exists = std::any_of(row.begin(), row.end(), [](uint16_t code) { return code != kNoSurface; });
    }
    return record;
}

Bytes encodeHeightTile(const HeightTile& tile) {
    TERRAY_CHECK(tile.id.valid());
    TERRAY_CHECK(tile.encoding.valid());
    TERRAY_CHECK(tile.record == measureRecord(tile.codes, tile.encoding, tile.record.error));

    ByteWriter out;
    PayloadPrefix prefix = kPrefix;
    prefix.id = tile.id;
    writePayloadPrefix(out, prefix);
    out.write(tile.encoding.exponent);
    out.write(tile.encoding.quantum);
    out.write(tile.encoding.offset);
    writeRecord(out, tile.record);
    for (const HeightRecord& child : tile.children) {
        TERRAY_CHECK(child.exists || child == HeightRecord{});
        writeRecord(out, child);
    }
    sealPayload(out, zstdCompress(planesFromCodes(tile.codes, tile.record.hasHoles), kZstdLevel));
    return out.release();
}

Result<HeightTile> decodeHeightHeader(ByteView payload, std::optional<TileId> expected) {
    auto opened = openTile(payload, expected);
    if (!opened.ok()) return opened.failure();
    return std::move(opened->tile);
}

Result<HeightTile> decodeHeightTile(ByteView payload, std::optional<TileId> expected) {
    auto opened = openTile(payload, expected);
    if (!opened.ok()) return opened.failure();
    HeightTile& tile = opened->tile;
    const std::string name = "height tile " + toString(tile.id);

    thread_local Bytes planes;  // kept, since clearing half a megabyte for each tile would cost as much as decoding it
    planes.reserve(heightPlaneBytes(kSize, true));  // once: growing would take room for two
    planes.resize(heightPlaneBytes(kSize, tile.record.hasHoles));
    if (!zstdDecompress(opened->body, planes)) return Failure{name + ": its codes do not unpack to their size"};
    tile.codes = codesFromPlanes(planes, tile.record.hasHoles, kSize);
    if (measureRecord(tile.codes, tile.encoding, tile.record.error) != tile.record)
        return Failure{name + ": its record does not agree with its codes"};
    return std::move(tile);
}

}  // namespace terray
