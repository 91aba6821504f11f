#include "preprocess/level_store.h"

#include <algorithm>

#include "common/tiling.h"

namespace terray {

LevelStore::LevelStore(const std::filesystem::path& path, const GridRect& tiles, int planes, float fill)
    : tiles_(tiles), planes_(planes), fill_(fill), file_(path), written_({tiles.width, tiles.height}, 0) {}

void LevelStore::write(int64_t tileX, int64_t tileY, std::span<const GridView<const float>> planes) {
    TERRAY_CHECK_OP(static_cast<int>(planes.size()), ==, planes_);
    std::vector<float> cells;
    cells.reserve(size_t{kTileCore} * kTileCore);
    for (int plane = 0; plane < planes_; ++plane) {
        const GridView<const float>& view = planes[static_cast<size_t>(plane)];
        TERRAY_CHECK(view.size() == GridSize(kTileCore, kTileCore));
        cells.clear();
        for (int64_t y = 0; y < kTileCore; ++y) cells.insert(cells.end(), view.row(y).begin(), view.row(y).end());
        file_.write(rowOffset(tileX, tileY, plane, 0), std::as_bytes(std::span(cells)));
    }
}

bool LevelStore::has(int64_t tileX, int64_t tileY) const {
    if (intersection({tileX, tileY, 1, 1}, tiles_).empty()) return false;
    return written_.at(tileX - tiles_.x, tileY - tiles_.y) != 0;
}

void LevelStore::read(const GridRect& window, int plane, GridView<float> out) const {
    TERRAY_CHECK(out.size() == GridSize(window.width, window.height));
    for (int64_t y = 0; y < out.height(); ++y) std::ranges::fill(out.row(y), fill_);
    const GridRect inside = intersection(
        window, {tiles_.x * kTileCore, tiles_.y * kTileCore, tiles_.width * kTileCore, tiles_.height * kTileCore});
    if (inside.empty()) return;

    for (int64_t tileY = inside.y / kTileCore; tileY * kTileCore < inside.y + inside.height; ++tileY) {
        for (int64_t tileX = inside.x / kTileCore; tileX * kTileCore < inside.x + inside.width; ++tileX) {
            if (!has(tileX, tileY)) continue;
            const GridRect core = {tileX * kTileCore, tileY * kTileCore, kTileCore, kTileCore};
            const GridRect part = intersection(inside, core);
            for (int64_t y = part.y; y < part.y + part.height; ++y) {
                const std::span<float> cells =
                    out.row(y - window.y)
                        .subspan(static_cast<size_t>(part.x - window.x), static_cast<size_t>(part.width));
                const auto skipped = static_cast<uint64_t>(part.x - core.x) * sizeof(float);
                file_.read(rowOffset(tileX, tileY, plane, y - core.y) + skipped, std::as_writable_bytes(cells));
            }
        }
    }
}

uint64_t LevelStore::rowOffset(int64_t tileX, int64_t tileY, int plane, int64_t row) const {
    // Tiles row by row, in a tile plane by plane, in a plane row by row: a file layout, not an index into a grid.
    const int64_t tile = (tileY - tiles_.y) * tiles_.width + tileX - tiles_.x;
    return static_cast<uint64_t>(((tile * planes_ + plane) * kTileCore + row) * kTileCore) * sizeof(float);
}

}  // namespace terray
