#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/bytes.h"
#include "common/grid.h"
#include "common/result.h"
#include "common/tile_id.h"
#include "common/tiling.h"

namespace terray {

/// A height code that stands for "no surface here": a nodata hole, or beyond the DEM's edge.
inline constexpr uint16_t kNoSurface = 0;

/// How 16-bit codes stand for heights: height = (offset + code) * metresPerCode(), codes 1..65535.
///
/// The quantum is one for the whole dataset, the exponent the smallest that lets a tile's range fit, so two tiles of
/// one level store a shared sample as the same height whenever their exponents agree.
struct HeightEncoding {
    double quantum = 0.01;  ///< metres, > 0, the dataset's
    uint32_t exponent = 0;  ///< a code step is quantum * 2^exponent; 0..40
    int64_t offset = -1;    ///< in code steps, |offset| < 2^40

    bool operator==(const HeightEncoding&) const = default;

    /// Metres between adjacent codes. A stored height is within half of this of the one encoded.
    [[nodiscard]] double metresPerCode() const { return quantum * static_cast<double>(uint64_t{1} << exponent); }
    /// Height of a code in metres; code must not be kNoSurface.
    [[nodiscard]] double height(uint16_t code) const { return static_cast<double>(offset + code) * metresPerCode(); }
    /// The nearest code, 1..65535. The height must lie in the encoded range (or within one step of it).
    [[nodiscard]] uint16_t code(double height) const;
    /// Whether the fields are within the ranges given above, the quantum within 1e-9..1e6 metres.
    [[nodiscard]] bool valid() const;
    /// The encoding with the smallest exponent whose codes reach from minHeight to maxHeight (metres, finite).
    [[nodiscard]] static HeightEncoding covering(double minHeight, double maxHeight, double quantum);
};

/// What a client must know of a tile before it has the tile: whether to fetch it, and where its box is.
struct HeightRecord {
    bool exists = false;    ///< false: no surface anywhere in its core, and no tile is stored
    bool hasHoles = false;  ///< some of its 516 x 516 codes are kNoSurface
    float minHeight = 0;    ///< metres, over all valid codes including the apron, rounded down
    float maxHeight = 0;    ///< metres, likewise, rounded up
    float error = 0;        ///< metres, rounded up: see HeightTile::record

    bool operator==(const HeightRecord&) const = default;
};

/// One tile of the height pyramid. Payload layout: FORMAT.md.
struct HeightTile {
    TileId id;
    HeightEncoding encoding;
    /// The tile's own record. error, in metres, bounds how far the surfaces of the decoded heights lie from those of
    /// the finest source samples, straight up or down, at every place of the core where both have one: columns from
    /// columns exactly (the greatest distance between a core cell and any sample beneath it), bilinear from bilinear by
    /// a proven bound (preprocess/surface_deviation.h). So it contains quantisation. Where ground ends or has holes,
    /// and between columns and a bilinear surface, it says nothing. DatasetMetadata::errorsHoldEverywhere false: at
    /// samples only, the first of the two.
    HeightRecord record;
    /// The four tiles beneath, by quadrant; all absent at the finest level.
    std::array<HeightRecord, 4> children;
    /// kHeightTileSide^2 codes; core texel (0, 0) is cell (kHeightApron, kHeightApron).
    Grid<uint16_t> codes;

    bool operator==(const HeightTile&) const = default;
};

/// The greatest float that is not above a finite value, and the smallest not below it: how bounds and errors become
/// floats.
[[nodiscard]] float floatAtMost(double value);
[[nodiscard]] float floatAtLeast(double value);

/// Exact record of some codes: exists is taken from the core (true if any core code is a surface), the bounds and
/// hasHoles from all of them. `error` is passed through. Without any surface: exists false, bounds and error 0,
/// hasHoles true.
[[nodiscard]] HeightRecord measureRecord(const Grid<uint16_t>& codes, const HeightEncoding& encoding, float error);

/// Serialised tile: header, checksum, predicted and zstd-compressed codes. Same tile, same bytes.
[[nodiscard]] Bytes encodeHeightTile(const HeightTile& tile);

/// Reads a payload, trusting nothing: magic, version, sizes, checksum, ranges and the codes' agreement with the header
/// are checked. Allocates at most one tile. @param expected  the id that the tile must carry, when known
[[nodiscard]] Result<HeightTile> decodeHeightTile(ByteView payload, std::optional<TileId> expected = {});

/// Only the header's part, checked alike but without decompressing; `codes` is empty.
[[nodiscard]] Result<HeightTile> decodeHeightHeader(ByteView payload, std::optional<TileId> expected = {});

}  // namespace terray
