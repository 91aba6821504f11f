#include "client/render/code_maxima.h"

#include <algorithm>

#include "common/check.h"

namespace terray {

CodeMaxima::CodeMaxima(GridView<const uint16_t> codes) {
    TERRAY_CHECK_OP(codes.width(), ==, kHeightTileSide);
    TERRAY_CHECK_OP(codes.height(), ==, kHeightTileSide);
    for (int y = 0; y < kSquares; ++y) {
        for (int x = 0; x < kSquares; ++x) {
            uint16_t greatest = 0;
            const int left = x * kSquare + kHeightApron - 1;
            for (int row = y * kSquare + kHeightApron - 1, i = 0; i < kSquare + 2; ++row, ++i) {
                const auto cells = codes.row(row).subspan(static_cast<size_t>(left), kSquare + 2);
                greatest = std::max(greatest, *std::ranges::max_element(cells));
            }
            maxima_.at(x, y) = greatest;
        }
    }
}

CodeMaxima::CodeMaxima(const HeightTile& stored, const EditedTile& edited) : CodeMaxima(stored.codes.view()) {
    // The shader rounds what lies halfway between two codes to either.
    const double slack = 1e-3 * edited.encoding.metresPerCode();
    const GridRect core = Tiling::coreSamples(stored.id);
    for (int y = 0; y < kSquares; ++y) {
        for (int x = 0; x < kSquares; ++x) {
            uint16_t& greatest = maxima_.at(x, y);
            if (greatest == kNoSurface) continue;
            const double left = static_cast<double>(core.x + x * kSquare),
                         top = static_cast<double>(core.y + y * kSquare);
            const double west = edited.corner.x + left * edited.spacing, north = edited.corner.y - top * edited.spacing;
            const double side = kSquare * edited.spacing;
            const GroundRect ring = widened({west, north - side, west + side, north}, edited.spacing);
            const double height = stored.encoding.height(greatest);
            const EditBounds bounds = editBounds(editsNear(edited.edits, ring), ring, {height, height}, 0);
            greatest = edited.encoding.code(bounds.heights.highest + slack);
        }
    }
}

uint16_t CodeMaxima::over(double cornerX, double cornerY, double side) const {
    const auto first = [](double corner) { return std::clamp(static_cast<int>(corner) / kSquare, 0, kSquares - 1); };
    const int count = std::max(1, static_cast<int>(side) / kSquare);
    const int left = first(cornerX), top = first(cornerY);
    uint16_t greatest = 0;
    for (int y = top; y < std::min(top + count, kSquares); ++y)
        for (int x = left; x < std::min(left + count, kSquares); ++x) greatest = std::max(greatest, maxima_.at(x, y));
    return greatest;
}

}  // namespace terray
