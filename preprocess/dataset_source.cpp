#include "preprocess/dataset_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/bc1_decode.h"
#include "common/error.h"
#include "common/height_tile.h"
#include "common/imagery_tile.h"
#include "common/projection.h"
#include "preprocess/block_plan.h"
#include "preprocess/raster_layout.h"

namespace terray {
namespace {

using Dataset = std::shared_ptr<const DatasetArchives>;

/// The bytes of a tile, if the archive has it.
std::optional<Bytes> payloadOf(const PmtilesReader& archive, const TileId& id) {
    auto payload = archive.read(id);
    if (!payload.ok()) throw Error(ExitCode::dataset, payload.failure().message);
    return std::move(payload).value();
}

template <class Tile>
Tile require(Result<Tile> tile, const PmtilesReader& archive, const TileId& id) {
    if (tile.ok()) return std::move(tile).value();
    throw Error(ExitCode::dataset, "cannot read tile " + toString(id) + " of " + archive.source().name() + ": " +
                                       tile.failure().message + "; terray-preprocess verify names all that is damaged");
}

/// Calls visit(tile, part) for each tile of a level that `window`, in samples of that level, touches.
template <class Visit>
void forEachTileIn(const GridRect& window, uint32_t level, const Visit& visit) {
    const GridRect inside = intersection(window, {0, 0, int64_t{kTileCore} << level, int64_t{kTileCore} << level});
    if (inside.empty()) return;
    for (int64_t y = inside.y / kTileCore; y * kTileCore < inside.y + inside.height; ++y)
        for (int64_t x = inside.x / kTileCore; x * kTileCore < inside.x + inside.width; ++x) {
            const TileId id{level, static_cast<uint32_t>(x), static_cast<uint32_t>(y)};
            visit(id, intersection(inside, Tiling::coreSamples(id)));
        }
}

class DatasetHeightReader final : public HeightReader {
  public:
    DatasetHeightReader(Dataset dataset, uint32_t level, const GridRect& cells)
        : dataset_(std::move(dataset)), level_(level), cells_(cells) {}

    void read(const GridRect& window, GridView<float> out) override {
        TERRAY_CHECK(out.size() == (GridSize{window.width, window.height}));
        for (int64_t row = 0; row < out.height(); ++row) std::ranges::fill(out.row(row), kNoHeight);
        const GridRect wanted =
            intersection({window.x + cells_.x, window.y + cells_.y, window.width, window.height}, cells_);
        forEachTileIn(wanted, level_, [&](const TileId& id, const GridRect& part) {
            copyTile(id, part,
                     out.window({part.x - cells_.x - window.x, part.y - cells_.y - window.y, part.width, part.height}));
        });
    }

  private:
    void copyTile(const TileId& id, const GridRect& part, GridView<float> out) const {
        const std::optional<Bytes> payload = payloadOf(dataset_->heights, id);
        if (!payload) return;
        const HeightTile tile = require(decodeHeightTile(*payload, id), dataset_->heights, id);
        const GridRect core = Tiling::coreSamples(id);
        const GridView<const uint16_t> codes = tile.codes.view().window(
            {part.x - core.x + kHeightApron, part.y - core.y + kHeightApron, part.width, part.height});
        for (int64_t row = 0; row < out.height(); ++row)
            std::ranges::transform(codes.row(row), out.row(row).begin(), [&](uint16_t code) {
                return code == kNoSurface ? kNoHeight : static_cast<float>(tile.encoding.height(code));
            });
    }

    Dataset dataset_;
    uint32_t level_;
    GridRect cells_;
};

class DatasetHeights final : public HeightSource {
  public:
    DatasetHeights(Dataset dataset, uint32_t level, const GridRect& cells, HeightGridInfo info)
        : dataset_(std::move(dataset)), level_(level), cells_(cells), info_(std::move(info)) {}
    [[nodiscard]] const HeightGridInfo& info() const override { return info_; }
    [[nodiscard]] std::unique_ptr<HeightReader> openReader() const override {
        return std::make_unique<DatasetHeightReader>(dataset_, level_, cells_);
    }

  private:
    Dataset dataset_;
    uint32_t level_;
    GridRect cells_;
    HeightGridInfo info_;
};

/// How a photo's stored texels become those of the part.
struct PhotoPlace {
    uint32_t storedLevel = 0;  ///< in the dataset
    int64_t x = 0;             ///< stored texel at the part's north-west corner
    int64_t y = 0;
    uint32_t repeated = 0;  ///< a stored texel becomes 2^repeated along each axis: so small a part has no coarser level
};

class DatasetPhotoReader final : public ColourReader {
  public:
    DatasetPhotoReader(Dataset dataset, const PhotoPlace& place) : dataset_(std::move(dataset)), place_(place) {}

    void read(const GridRect& window, GridView<Rgba> out) override {
        TERRAY_CHECK(out.size() == (GridSize{window.width, window.height}));
        const GridRect stored = storedUnder(window);
        Grid<Rgba> texels({stored.width, stored.height}, Rgba{});
        forEachTileIn(stored, place_.storedLevel, [&](const TileId& id, const GridRect& part) {
            copyTile(id, part, texels.view().window({part.x - stored.x, part.y - stored.y, part.width, part.height}));
        });
        for (int64_t row = 0; row < out.height(); ++row)
            for (int64_t column = 0; column < out.width(); ++column)
                out.at(column, row) = texels.at(place_.x + ((window.x + column) >> place_.repeated) - stored.x,
                                                place_.y + ((window.y + row) >> place_.repeated) - stored.y);
    }

  private:
    [[nodiscard]] GridRect storedUnder(const GridRect& window) const {
        const int64_t left = window.x >> place_.repeated;
        const int64_t top = window.y >> place_.repeated;
        return {place_.x + left, place_.y + top, ((window.x + window.width - 1) >> place_.repeated) + 1 - left,
                ((window.y + window.height - 1) >> place_.repeated) + 1 - top};
    }

    void copyTile(const TileId& id, const GridRect& part, GridView<Rgba> out) const {
        const std::optional<Bytes> payload = payloadOf(*dataset_->imagery, id);
        if (!payload) return;
        const ImageryTile tile = require(decodeImageryTile(*payload, id), *dataset_->imagery, id);
        const Grid<Rgba> texels = decodeBc1(tile.mip(0), {kImageryTileSide, kImageryTileSide});
        const GridRect core = Tiling::coreSamples(id);
        const GridView<const Rgba> inner = texels.view().window(
            {part.x - core.x + kImageryGutter, part.y - core.y + kImageryGutter, part.width, part.height});
        for (int64_t row = 0; row < out.height(); ++row) std::ranges::copy(inner.row(row), out.row(row).begin());
    }

    Dataset dataset_;
    PhotoPlace place_;
};

class DatasetPhoto final : public ColourSource {
  public:
    DatasetPhoto(Dataset dataset, uint32_t level, const GroundRect& bounds, const PhotoPlace& place)
        : dataset_(std::move(dataset)), level_(level), bounds_(bounds), place_(place) {}
    [[nodiscard]] uint32_t level() const override { return level_; }
    [[nodiscard]] GroundRect bounds() const override { return bounds_; }
    [[nodiscard]] const std::vector<SourceFile>& files() const override { return files_; }
    [[nodiscard]] std::unique_ptr<ColourReader> openReader() const override {
        return std::make_unique<DatasetPhotoReader>(dataset_, place_);
    }

  private:
    Dataset dataset_;
    uint32_t level_;
    GroundRect bounds_;
    PhotoPlace place_;
    std::vector<SourceFile> files_;  ///< none: those of the heights name both archives
};

/// Degrees of a part of the ground. Those of the whole ground, which hold it too, where it cannot be told more closely:
/// without PROJ, across the antimeridian, at a pole.
std::optional<GroundRect> lonLatBoundsOf(const GroundRect& ground, const DatasetMetadata& metadata) {
    const std::optional<GroundRect>& whole = metadata.lonLatBounds;
    if (!whole || whole->west > whole->east || whole->south <= -90 || whole->north >= 90) return whole;
    const auto projection = Projection::create(metadata.crsWkt);
    if (!projection.ok()) return whole;
    constexpr int kSteps = 20;
    GroundRect bounds{180, 90, -180, -90};
    for (int i = 0; i <= kSteps; ++i) {
        const double x = std::lerp(ground.west, ground.east, static_cast<double>(i) / kSteps);
        const double y = std::lerp(ground.south, ground.north, static_cast<double>(i) / kSteps);
        for (const glm::dvec2 place : {glm::dvec2(x, ground.south), glm::dvec2(x, ground.north),
                                       glm::dvec2(ground.west, y), glm::dvec2(ground.east, y)}) {
            const auto lonLat = projection->lonLat(place);
            if (!lonLat.ok()) return whole;
            bounds = {std::min(bounds.west, lonLat->longitude), std::min(bounds.south, lonLat->latitude),
                      std::max(bounds.east, lonLat->longitude), std::max(bounds.north, lonLat->latitude)};
        }
    }
    return bounds;
}

/// Opens the part step by step.
class PartOpener {
  public:
    PartOpener(Dataset dataset, const DatasetPart& part) : dataset_(std::move(dataset)), part_(part) {}

    DatasetSources open() {
        chooseLevels();
        chooseCells();
        DatasetSources sources;
        sources.heights = std::make_unique<DatasetHeights>(dataset_, level_, cells_, describe());
        if (hasPhoto())
            sources.openPhoto = [dataset = dataset_, place = place(), bounds = *photoBounds_, level = level_](
                                    const Tiling& tiling, const HeightGridInfo&) -> std::unique_ptr<ColourSource> {
                return photoOver(tiling, dataset, level, bounds, place);
            };
        return sources;
    }

  private:
    [[nodiscard]] const DatasetMetadata& metadata() const { return dataset_->metadata; }
    [[nodiscard]] const Tiling& tiling() const { return metadata().tiling; }

    void chooseLevels() {
        const uint32_t finest = std::max(tiling().finestLevel, metadata().imageryLevel.value_or(0));
        if (part_.finestLevel && *part_.finestLevel > finest)
            throw Error(ExitCode::usage, "--levels is " + std::to_string(*part_.finestLevel) + ": " +
                                             dataset_->directory.string() + " has levels 0 to " +
                                             std::to_string(finest));
        const uint32_t wanted = part_.finestLevel.value_or(finest);
        level_ = std::min(wanted, tiling().finestLevel);
        if (metadata().imageryLevel) photoLevel_ = std::min(wanted, *metadata().imageryLevel);
    }

    /// Samples of the level that touch the bounds, grown to whole texels of a coarser photo.
    void chooseCells() {
        const double spacing = tiling().spacing(level_);
        const SquareGrid whole{.west = tiling().west,
                               .north = tiling().north,
                               .spacing = spacing,
                               .size = PyramidExtent{tiling().finestLevel, metadata().samples}.samplesAt(level_)};
        const std::optional<SquareGrid> grid = part_.bounds ? clippedGrid(whole, *part_.bounds) : whole;
        if (!grid)
            throw Error(ExitCode::georeference, "the area of --bbox lies outside the dataset: it covers " +
                                                    terray::describe(metadata().groundBounds(), metadata().crsName) +
                                                    ", the area is " +
                                                    terray::describe(*part_.bounds, metadata().crsName));
        const int64_t texel = photoLevel_ && *photoLevel_ < level_ ? int64_t{1} << (level_ - *photoLevel_) : 1;
        const int64_t left = std::llround((grid->west - whole.west) / spacing);
        const int64_t top = std::llround((whole.north - grid->north) / spacing);
        const auto roundedUp = [&](int64_t cells) { return (cells + texel - 1) / texel * texel; };
        cells_ = {left / texel * texel, top / texel * texel, 0, 0};
        cells_.width = std::min(roundedUp(left + grid->size.width), whole.size.width) - cells_.x;
        cells_.height = std::min(roundedUp(top + grid->size.height), whole.size.height) - cells_.y;
    }

    [[nodiscard]] GroundRect ground() const {
        const double spacing = tiling().spacing(level_);
        const double west = tiling().west + static_cast<double>(cells_.x) * spacing;
        const double north = tiling().north - static_cast<double>(cells_.y) * spacing;
        return {west, north - static_cast<double>(cells_.height) * spacing,
                west + static_cast<double>(cells_.width) * spacing, north};
    }

    [[nodiscard]] HeightGridInfo describe() const {
        const GroundRect area = ground();
        HeightGridInfo info;
        info.size = {cells_.width, cells_.height};
        info.west = area.west;
        info.north = area.north;
        info.spacing = tiling().spacing(level_);
        info.crsWkt = metadata().crsWkt;
        info.crsName = metadata().crsName;
        info.lonLatBounds = lonLatBoundsOf(area, metadata());
        info.verticalDatum = metadata().verticalDatum;
        for (const char* name : {kHeightsFile, kImageryFile})
            if (auto file = fileOnDisk((dataset_->directory / name).string())) info.files.push_back(std::move(*file));
        info.files.insert(info.files.end(), metadata().sources.begin(), metadata().sources.end());
        return info;
    }

    bool hasPhoto() {
        if (!photoLevel_) return false;
        photoBounds_ = overlapOf(*metadata().imageryBounds, ground());
        if (!photoBounds_ && part_.note) part_.note("the photo does not reach into this area: heights alone are taken");
        return photoBounds_.has_value();
    }

    [[nodiscard]] PhotoPlace place() const {
        PhotoPlace place{.storedLevel = *photoLevel_};
        const auto texelAt = [&](int64_t cell) {
            return *photoLevel_ >= level_ ? cell << (*photoLevel_ - level_) : cell >> (level_ - *photoLevel_);
        };
        place.x = texelAt(cells_.x);
        place.y = texelAt(cells_.y);
        return place;
    }

    /// @param level  of the stored heights that became the finest level of `tiling`
    static std::unique_ptr<ColourSource> photoOver(const Tiling& tiling, const Dataset& dataset, uint32_t level,
                                                   const GroundRect& bounds, PhotoPlace place) {
        const int64_t wanted = int64_t{tiling.finestLevel} + place.storedLevel - level;
        if (wanted < 0) place.repeated = static_cast<uint32_t>(-wanted);
        return std::make_unique<DatasetPhoto>(dataset, static_cast<uint32_t>(std::max<int64_t>(wanted, 0)), bounds,
                                              place);
    }

    Dataset dataset_;
    const DatasetPart& part_;
    uint32_t level_ = 0;
    std::optional<uint32_t> photoLevel_;
    GridRect cells_;
    std::optional<GroundRect> photoBounds_;
};

}  // namespace

DatasetSources openDatasetPart(std::shared_ptr<const DatasetArchives> dataset, const DatasetPart& part) {
    return PartOpener(std::move(dataset), part).open();
}

}  // namespace terray
