#include <algorithm>
#include <utility>

#include "common/check.h"
#include "common/error.h"
#include "preprocess/gdal_raster.h"
#include "preprocess/raster_files.h"
#include "preprocess/raster_groups.h"
#include "preprocess/tiled_copies.h"

namespace terray {

namespace {

using gdal::RasterFacts;
using gdal::VirtualRaster;

/// Photos warped to the imagery grid, each to the cells that it touches.
struct PhotoLayer {
    std::string raster;  ///< name for GDAL: four bands of bytes
    std::string label;   ///< in messages
    GridRect cells;      ///< of the imagery level
};

class GdalPhotoReader final : public ColourReader {
  public:
    explicit GdalPhotoReader(const std::vector<PhotoLayer>& layers) {
        for (const PhotoLayer& layer : layers)
            layers_.push_back({layer.cells, gdal::RasterReader(layer.raster, layer.label)});
    }

    void read(const GridRect& window, GridView<Rgba> out) override {
        TERRAY_CHECK(out.size() == (GridSize{window.width, window.height}));
        for (int64_t row = 0; row < out.height(); ++row) std::ranges::fill(out.row(row), Rgba{});
        for (Layer& layer : layers_) {
            const GridRect inside = intersection(window, layer.cells);
            if (inside.empty()) continue;
            Grid<Rgba> texels({inside.width, inside.height});
            layer.reader.read({inside.x - layer.cells.x, inside.y - layer.cells.y, inside.width, inside.height},
                              texels.view());
            layOver(texels.view(), out.window({inside.x - window.x, inside.y - window.y, inside.width, inside.height}));
        }
    }

    [[nodiscard]] bool resamples() const override { return true; }

  private:
    struct Layer {
        GridRect cells;
        gdal::RasterReader reader;
    };

    /// A texel counts as covered when the photo covers at least half of it.
    static void layOver(GridView<const Rgba> upper, GridView<Rgba> lower) {
        for (int64_t row = 0; row < lower.height(); ++row)
            std::ranges::transform(upper.row(row), lower.row(row), lower.row(row).begin(), [](Rgba above, Rgba below) {
                return above[3] >= 128 ? Rgba{above[0], above[1], above[2], 255} : below;
            });
    }

    std::vector<Layer> layers_;
};

class GdalPhotos final : public ColourSource {
  public:
    GdalPhotos(uint32_t level, GroundRect bounds, std::vector<SourceFile> files, std::vector<PhotoLayer> layers,
               std::vector<VirtualRaster> keptAlive, TiledCopies copies)
        : level_(level),
          bounds_(bounds),
          files_(std::move(files)),
          layers_(std::move(layers)),
          keptAlive_(std::move(keptAlive)),
          copies_(std::move(copies)) {}

    [[nodiscard]] uint32_t level() const override { return level_; }
    [[nodiscard]] GroundRect bounds() const override { return bounds_; }
    [[nodiscard]] const std::vector<SourceFile>& files() const override { return files_; }
    [[nodiscard]] std::unique_ptr<ColourReader> openReader() const override {
        return std::make_unique<GdalPhotoReader>(layers_);
    }
    [[nodiscard]] uint64_t preparedBytes() const override { return copies_.bytes(); }
    void prepare(const SourceWorkspace& workspace) const override { copies_.prepare(workspace); }

  private:
    uint32_t level_;
    GroundRect bounds_;
    std::vector<SourceFile> files_;
    std::vector<PhotoLayer> layers_;
    std::vector<VirtualRaster> keptAlive_;
    TiledCopies copies_;
};

/// The heights that photos are laid over.
struct Ground {
    const Tiling& tiling;
    GroundRect area;
    std::string crsWkt;
    std::string crsName;
};

/// Opens the photos step by step.
class PhotoOpener {
  public:
    PhotoOpener(Ground ground, uint64_t cacheBytes) : ground_(std::move(ground)), copies_(cacheBytes) {}

    std::unique_ptr<ColourSource> open(const PhotoSourceOptions& options) {
        TERRAY_CHECK(!options.files.empty());
        for (const std::string& file : options.files) photos_.push_back(gdal::inspect(file));
        for (RasterFacts& photo : photos_) place(photo);
        std::vector<RasterGroup> groups = groupByGrid(photos_, mosaicOrder(photos_, options.priority));
        for (RasterGroup& group : groups) layOut(group);
        measure(groups);
        for (size_t i = 0; i < groups.size(); ++i) addLayer(groups[i], footprints_[i]);
        std::vector<SourceFile> sources;
        for (const RasterFacts& photo : photos_) sources.insert(sources.end(), photo.files.begin(), photo.files.end());
        return std::make_unique<GdalPhotos>(level_, *covered_, std::move(sources), std::move(layers_),
                                            std::move(keptAlive_), std::move(copies_));
    }

  private:
    /// Gives a place to a photo that has none, and the ground's system to one that names none.
    void place(RasterFacts& photo) const {
        if (!photo.geoTransform) {
            if (!ground_.crsWkt.empty())
                throw Error(
                    ExitCode::georeference,
                    "cannot place the photo \"" + photo.name +
                        "\": it does not say where it lies. Georeference it, as with gdal_translate -a_srs -a_ullr");
            const GroundRect& area = ground_.area;
            photo.geoTransform = {area.west, (area.east - area.west) / static_cast<double>(photo.size.width),
                                  0,         area.north,
                                  0,         (area.south - area.north) / static_cast<double>(photo.size.height)};
            photo.isPlacedHere = true;
        }
        // Nothing can be transformed to or from an unnamed plane: both are then taken to lie in the same one.
        if (photo.crs.wkt.empty() || ground_.crsWkt.empty()) {
            photo.crs = Crs{};
            if (!ground_.crsWkt.empty()) photo.crs = gdal::describeCrs(ground_.crsWkt);
        }
    }

    /// The group's photos as red, green, blue and alpha bytes, side by side.
    void layOut(RasterGroup& group) {
        std::vector<std::string> parts;
        for (const size_t index : group.members) parts.push_back(rgbaRaster(photos_[index]));
        group.raster = parts.front();
        if (parts.size() > 1) group.raster = keep(gdal::mosaic(parts, {"-strict"}));
    }

    std::string rgbaRaster(const RasterFacts& photo) {
        if (!photo.isInteger || photo.bits < 1 || photo.bits > 16)
            throw Error(ExitCode::input,
                        "cannot use \"" + photo.name + "\" as a photo: its samples have " + std::to_string(photo.bits) +
                            (photo.isInteger ? "-bit integers" : "-bit floats") +
                            ", expected 8 or 16-bit integers; convert it with gdal_translate -ot Byte -scale");
        std::vector<std::string> place = placeArguments(photo);
        if (photo.hasPalette) {
            place.insert(place.end(), {"-expand", "rgba"});
            return tiled(gdal::translate(photo.name, place), photo);
        }
        std::string source = photo.name;
        std::vector<std::string> bands;
        for (const int band : photo.colourBands) bands.insert(bands.end(), {"-b", std::to_string(band)});
        if (photo.colourNodata) {
            // A pixel is hidden only if all three bands hold their nodata value: black roofs are no holes.
            const auto& [red, green, blue] = *photo.colourNodata;
            std::vector<std::string> labelled = bands;
            labelled.insert(labelled.end(),
                            {"-a_nodata", "none", "-mo",
                             "NODATA_VALUES=" + exactText(red) + " " + exactText(green) + " " + exactText(blue)});
            source = keep(gdal::translate(source, labelled));
            bands = {"-b", "1", "-b", "2", "-b", "3"};
        }
        std::vector<std::string> arguments = bands;
        arguments.insert(arguments.end(), {"-b", "mask", "-ot", "Byte"});
        if (photo.bits != 8) {
            const std::string brightest = std::to_string((1 << photo.bits) - 1);
            for (const char* band : {"-scale_1", "-scale_2", "-scale_3"})
                arguments.insert(arguments.end(), {band, "0", brightest, "0", "255"});
        }
        arguments.insert(arguments.end(), place.begin(), place.end());
        // A mask taken as a band gets its meaning only in a second step.
        return tiled(
            gdal::translate(keep(gdal::translate(source, arguments)), {"-colorinterp", "red,green,blue,alpha"}), photo);
    }

    std::string tiled(VirtualRaster raster, const RasterFacts& photo) {
        keptAlive_.push_back(std::move(raster));
        return copies_.nameOf(keptAlive_.back(), photo);
    }

    /// Where the groups lie, what of the ground they cover, and the level that the finest of them asks for.
    void measure(const std::vector<RasterGroup>& groups) {
        for (const RasterGroup& group : groups) {
            footprints_.push_back(gdal::footprint(group.raster, ground_.crsWkt));
            const std::optional<GroundRect> part = overlapOf(footprints_.back().extent, ground_.area);
            if (!part) continue;
            covered_ = covered_ ? unionOf(*covered_, *part) : *part;
            level_ = std::max(level_, imageryLevelFor(footprints_.back().finestSpacing, ground_.tiling));
        }
        if (covered_) return;
        GroundRect all = footprints_.front().extent;
        for (const gdal::Footprint& footprint : footprints_) all = unionOf(all, footprint.extent);
        throw Error(ExitCode::georeference, "the imagery does not overlap the heights: \"" + photos_.front().name +
                                                (photos_.size() > 1 ? "\" and others cover " : "\" covers ") +
                                                describe(all, ground_.crsName) + ", the heights " +
                                                describe(ground_.area, ground_.crsName));
    }

    void addLayer(const RasterGroup& group, const gdal::Footprint& footprint) {
        const std::optional<GroundRect> part = overlapOf(footprint.extent, ground_.area);
        if (!part) return;
        const GridRect cells = imageryCells(*part, ground_.tiling, level_);
        const double spacing = ground_.tiling.spacing(level_);
        const SquareGrid grid{.west = ground_.tiling.west + static_cast<double>(cells.x) * spacing,
                              .north = ground_.tiling.north - static_cast<double>(cells.y) * spacing,
                              .spacing = spacing,
                              .size = {cells.width, cells.height}};
        std::vector<std::string> arguments = gridArguments(grid, ground_.crsWkt);
        // Where texels are coarser than the photo's, each is the mean of what lies under it, so nothing is skipped.
        // Where they are finer (down to 0.6 times), cubic keeps the contrast of fine detail, of which bilinear would
        // lose a third.
        const bool isCoarser = spacing > footprint.finestSpacing * 1.001;
        for (const char* argument : {"-srcalpha", "-dstalpha", "-r", isCoarser ? "average" : "cubic", "-et", "0.125"})
            arguments.emplace_back(argument);
        const std::string& label = photos_[group.members.front()].name;
        layers_.push_back({keep(gdal::warp(group.raster, arguments)), label, cells});
    }

    std::string keep(VirtualRaster raster) {
        keptAlive_.push_back(std::move(raster));
        return keptAlive_.back().name();
    }

    Ground ground_;
    std::vector<RasterFacts> photos_;
    std::vector<gdal::Footprint> footprints_;
    std::optional<GroundRect> covered_;
    uint32_t level_ = 0;
    std::vector<PhotoLayer> layers_;
    std::vector<VirtualRaster> keptAlive_;
    TiledCopies copies_;
};

}  // namespace

std::unique_ptr<ColourSource> openGdalPhotos(const PhotoSourceOptions& options, const Tiling& tiling, GridSize samples,
                                             const std::string& crsWkt) {
    gdal::limitCache(options.cacheBytes);
    const SquareGrid heights{
        .west = tiling.west, .north = tiling.north, .spacing = tiling.finestSpacing, .size = samples};
    const std::string crsName = crsWkt.empty() ? "" : gdal::describeCrs(crsWkt).name;
    return PhotoOpener({.tiling = tiling, .area = heights.bounds(), .crsWkt = crsWkt, .crsName = crsName},
                       options.cacheBytes)
        .open(options);
}

}  // namespace terray
