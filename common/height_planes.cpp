#include "common/height_planes.h"

#include <algorithm>
#include <span>
#include <utility>
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
Grid<uint16_t> withHolesFilled(const Grid<uint16_t>& codes) {
    const auto first =
        std::find_if(codes.cells().begin(), codes.cells().end(), [](uint16_t code) { return code != 0; });
    uint16_t above = first == codes.cells().end() ? uint16_t{0} : *first;
    Grid<uint16_t> filled = codes;
    for (int64_t y = 0; y < codes.height(); ++y) {
        uint16_t last = above;
        for (uint16_t& code : filled.view().row(y)) code = last = code != 0 ? code : last;
        above = filled.at(0, y);
    }
    return filled;
}

void writeMask(std::span<const uint16_t> codes, std::span<std::byte> mask) {
    for (size_t cell = 0; cell < codes.size(); ++cell)
        if (codes[cell] != 0) mask[cell / 8] |= std::byte{1} << (cell % 8);
}

/// Eight cells at a time, since nearly all eights are whole ground or whole hole.
void applyMask(ByteView mask, std::span<uint16_t> codes) {
    for (const std::byte eight : mask) {
        const auto cells = codes.first(std::min<size_t>(8, codes.size()));
        codes = codes.subspan(cells.size());
        if (eight == std::byte{0xFF}) continue;
        for (size_t i = 0; i < cells.size(); ++i)
            if ((eight >> i & std::byte{1}) == std::byte{0}) cells[i] = 0;
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

Bytes planesFromCodes(const Grid<uint16_t>& codes, bool hasHoles) {
    const GridSize size = codes.size();
    Bytes planes(heightPlaneBytes(size, hasHoles));
    std::byte* next = planes.data();
    Grid<uint16_t> filled;
    if (hasHoles) {
        writeMask(codes.cells(), {next, maskBytes(size)});
        next += maskBytes(size);
        filled = withHolesFilled(codes);
    }
    const GridView<const uint16_t> ground = hasHoles ? std::as_const(filled).view() : codes.view();
    const GridView<std::byte> low(next, size);
    const GridView<std::byte> high(next + size.count(), size);
    const std::vector<uint16_t> zeros(static_cast<size_t>(size.width));
    std::span<const uint16_t> above = zeros;
    for (int64_t y = 0; y < size.height; ++y) {
        splitRow(ground.row(y), above, low.row(y), high.row(y));
        above = ground.row(y);
    }
    return planes;
}

Grid<uint16_t> codesFromPlanes(ByteView planes, bool hasHoles, GridSize size) {
    TERRAY_CHECK_OP(planes.size(), ==, heightPlaneBytes(size, hasHoles));
    const size_t masked = hasHoles ? maskBytes(size) : 0;
    const GridView<const std::byte> low(planes.data() + masked, size);
    const GridView<const std::byte> high(planes.data() + masked + size.count(), size);
    Grid<uint16_t> codes(size);
    const std::vector<uint16_t> zeros(static_cast<size_t>(size.width));
    std::span<const uint16_t> above = zeros;
    for (int64_t y = 0; y < size.height; ++y) {
        joinRow(low.row(y), high.row(y), above, codes.view().row(y));
        above = codes.view().row(y);
    }
    if (hasHoles) applyMask(planes.first(masked), codes.cells());
    return codes;
}

}  // namespace terray
