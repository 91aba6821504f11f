#include "common/height_planes.h"

#include <algorithm>
#include <vector>

namespace terray {
namespace {

// The planar predictor (west + north - northwest) leaves c - west - north + northwest, taken modulo 2^16. Zigzag then
// folds small negative residuals to small positive numbers, so that high bytes are mostly zero.
uint16_t zigzag(uint16_t residual) {
    return static_cast<uint16_t>((residual << 1) ^ (0 - (residual >> 15)));
}
uint16_t unzigzag(uint16_t folded) {
    return static_cast<uint16_t>((folded >> 1) ^ (0 - (folded & 1)));
}

size_t maskBytes(GridSize size) {
    return static_cast<size_t>((size.count() + 7) / 8);
}

/// Codes with each hole replaced by its western neighbour (at the western edge: by the northern one; at the start: by
/// the first surface of the tile), so that a hole costs no residual beyond its rim.
Grid<uint16_t> withHolesFilled(GridView<const uint16_t> codes) {
    Grid<uint16_t> filled(codes.size());
    uint16_t above = 0;
    for (int64_t y = 0; y < codes.height() && above == 0; ++y)
        for (const uint16_t code : codes.row(y))
            if (above == 0) above = code;
    for (int64_t y = 0; y < codes.height(); ++y) {
        uint16_t last = above;
        for (int64_t x = 0; x < codes.width(); ++x) {
            if (codes.at(x, y) != 0) last = codes.at(x, y);
            filled.at(x, y) = last;
        }
        above = filled.at(0, y);
    }
    return filled;
}

void writeMask(GridView<const uint16_t> codes, std::span<std::byte> mask) {
    size_t cell = 0;
    for (int64_t y = 0; y < codes.height(); ++y)
        for (const uint16_t code : codes.row(y)) {
            if (code != 0) mask[cell / 8] |= std::byte{1} << (cell % 8);
            ++cell;
        }
}

void applyMask(ByteView mask, GridView<uint16_t> codes) {
    size_t cell = 0;
    for (int64_t y = 0; y < codes.height(); ++y)
        for (uint16_t& code : codes.row(y)) {
            const auto isSurface = static_cast<int>(mask[cell / 8] >> (cell % 8)) & 1;
            code = static_cast<uint16_t>(code & -isSurface);
            ++cell;
        }
}

/// Residuals of one row against the row above (all zero for the first), folded and split into bytes.
void splitRow(std::span<const uint16_t> row, std::span<const uint16_t> above, std::span<std::byte> low,
              std::span<std::byte> high) {
    uint16_t west = 0;
    uint16_t northWest = 0;
    for (size_t x = 0; x < row.size(); ++x) {
        const auto folded = zigzag(static_cast<uint16_t>(row[x] - west - above[x] + northWest));
        low[x] = static_cast<std::byte>(folded);
        high[x] = static_cast<std::byte>(folded >> 8);
        west = row[x];
        northWest = above[x];
    }
}

/// The inverse in three passes of which the first and the last vectorise; the middle one is an addition per cell.
void joinRow(ByteView low, ByteView high, std::span<const uint16_t> above, std::span<uint16_t> row) {
    for (size_t x = 0; x < row.size(); ++x)
        row[x] = unzigzag(static_cast<uint16_t>(static_cast<unsigned>(low[x]) | static_cast<unsigned>(high[x]) << 8));
    uint16_t sum = 0;
    for (uint16_t& cell : row) cell = sum = static_cast<uint16_t>(sum + cell);
    for (size_t x = 0; x < row.size(); ++x) row[x] = static_cast<uint16_t>(row[x] + above[x]);
}

}  // namespace

size_t heightPlaneBytes(GridSize size, bool hasHoles) {
    return 2 * static_cast<size_t>(size.count()) + (hasHoles ? maskBytes(size) : 0);
}

Bytes planesFromCodes(GridView<const uint16_t> codes, bool hasHoles) {
    const GridSize size = codes.size();
    Bytes planes(heightPlaneBytes(size, hasHoles));
    std::byte* next = planes.data();
    Grid<uint16_t> filled;
    if (hasHoles) {
        writeMask(codes, {next, maskBytes(size)});
        next += maskBytes(size);
        filled = withHolesFilled(codes);
        codes = filled.view();
    }
    const GridView<std::byte> low(next, size);
    const GridView<std::byte> high(next + size.count(), size);
    const std::vector<uint16_t> zeros(static_cast<size_t>(size.width));
    std::span<const uint16_t> above = zeros;
    for (int64_t y = 0; y < size.height; ++y) {
        splitRow(codes.row(y), above, low.row(y), high.row(y));
        above = codes.row(y);
    }
    return planes;
}

void codesFromPlanes(ByteView planes, bool hasHoles, GridView<uint16_t> codes) {
    const GridSize size = codes.size();
    TERRAY_CHECK_OP(planes.size(), ==, heightPlaneBytes(size, hasHoles));
    const std::byte* const first = planes.data() + (hasHoles ? maskBytes(size) : 0);
    const GridView<const std::byte> low(first, size);
    const GridView<const std::byte> high(first + size.count(), size);
    const std::vector<uint16_t> zeros(static_cast<size_t>(size.width));
    std::span<const uint16_t> above = zeros;
    for (int64_t y = 0; y < size.height; ++y) {
        joinRow(low.row(y), high.row(y), above, codes.row(y));
        above = codes.row(y);
    }
    if (hasHoles) applyMask(planes.first(maskBytes(size)), codes);
}

}  // namespace terray
