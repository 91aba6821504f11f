#include "tests/support/edited_tile.h"

#include <cmath>

#include "common/check.h"

namespace terray {

glm::dvec2 sampleCentre(const Tiling& tiling, const TileId& id, int64_t column, int64_t row) {
    const GridRect core = Tiling::coreSamples(id);
    const double spacing = tiling.spacing(id.level);
    return {tiling.west + (static_cast<double>(core.x + column) + 0.5) * spacing,
            tiling.north - (static_cast<double>(core.y + row) + 0.5) * spacing};
}

HeightTile editedTile(const HeightTile& stored, const EditedGround& ground) {
    const auto edited = ground.describe(stored);
    if (!edited) return stored;
    HeightTile tile = stored;
    tile.encoding = edited->encoding;
    const Tiling at{.west = edited->corner.x,
                    .north = edited->corner.y,
                    .finestSpacing = edited->spacing,
                    .finestLevel = stored.id.level};
    for (int64_t y = 0; y < kHeightTileSide; ++y)
        for (int64_t x = 0; x < kHeightTileSide; ++x) {
            uint16_t& code = tile.codes.at(x, y);
            if (code == kNoSurface) continue;
            const glm::dvec2 place = sampleCentre(at, stored.id, x - kHeightApron, y - kHeightApron);
            // Not HeightEncoding::code(), which clamps: nothing may need clamping.
            const double height = editedHeight(stored.encoding.height(code), place, edited->edits);
            const double nearest =
                std::floor(height / tile.encoding.metresPerCode() + 0.5) - static_cast<double>(tile.encoding.offset);
            TERRAY_CHECK_OP(nearest, >=, 1);
            TERRAY_CHECK_OP(nearest, <=, 65535);
            code = static_cast<uint16_t>(nearest);
        }
    tile.record = measureRecord(tile.codes, tile.encoding, edited->record.error);
    return tile;
}

EditedSource::EditedSource(const TileSource& source, EditList edits)
    : source_(source),
      ground_(source.metadata().tiling, source.metadata().quantum, std::move(edits)),
      metadata_(source.metadata()) {
    const HeightRecord root{
        .exists = true, .minHeight = floatAtMost(metadata_.minHeight), .maxHeight = floatAtLeast(metadata_.maxHeight)};
    const HeightRecord edited = ground_.record({}, root).value_or(root);
    metadata_.minHeight = edited.minHeight;
    metadata_.maxHeight = edited.maxHeight;
}

Result<Bytes> EditedSource::read(TileLayer layer, const TileId& id) const {
    Result<Bytes> payload = source_.read(layer, id);
    if (layer != TileLayer::heights || !payload) return payload;
    const auto tile = decodeHeightTile(*payload, id);
    if (!tile) return tile.failure();
    return encodeHeightTile(editedTile(*tile, ground_));
}

EditList randomEdits(const std::function<double(double, double)>& uniform, const GroundRect& ground, double spacing,
                     int count) {
    const double wide = ground.east - ground.west, high = ground.north - ground.south;
    const auto place = [&] {
        return glm::dvec2(ground.west + wide * uniform(-0.05, 1.05), ground.south + high * uniform(-0.05, 1.05));
    };
    EditList edits;
    for (int i = 0; i < count; ++i) {
        TerrainEdit edit{.kind = static_cast<TerrainEdit::Kind>(i % 3)};
        edit.radius = 0.4 * spacing * std::pow(wide / spacing, uniform(0, 0.85));
        std::vector<glm::dvec2> points = {place()};
        if (edit.kind != TerrainEdit::Kind::crater) {
            while (uniform(0, 1) < 0.6) points.push_back(points.back() + 0.2 * (place() - points.back()));
            edit.full = edit.radius * uniform(0, 0.95);
            edit.height = uniform(-300, 300);
        } else {
            edit.height = uniform(0, 1) * std::min(edit.radius, 400.0);
            edit.rim = edit.height * uniform(0, 0.4);
        }
        edit.line = segmentsThrough(points);
        edits.push_back(edit);
    }
    return edits;
}

}  // namespace terray
