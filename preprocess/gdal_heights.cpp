#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "common/check.h"
#include "common/error.h"
#include "common/geodesy.h"
#include "preprocess/gdal_raster.h"
#include "preprocess/raster_files.h"
#include "preprocess/raster_groups.h"
#include "preprocess/tiled_copies.h"

namespace terray {

namespace {

using gdal::RasterFacts;
using gdal::VirtualRaster;

/// "63.75 m", for notes.
std::string metres(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g m", value);
    return text;
}

/// A source value times scale plus offset is metres.
struct HeightUnits {
    double scale = 1;
    double offset = 0;
};

/// What is opened for each reader: rasters of one grid, in the order in which they cover one another.
struct HeightStack {
    std::vector<VirtualRaster> keptAlive;  ///< the rasters and all that they are derived from
    std::vector<std::string> rasters;      ///< names for GDAL; all have HeightGridInfo::size
    TiledCopies copies;                    ///< of files that blocks cannot be read from at little cost
    HeightUnits units;
    bool isWarped = false;
    std::string label;  ///< of the whole, in messages
};

class GdalHeightReader final : public HeightReader {
  public:
    GdalHeightReader(const HeightStack& stack, GridSize size)
        : size_(size), units_(stack.units), isWarped_(stack.isWarped) {
        for (const std::string& raster : stack.rasters) rasters_.emplace_back(raster, stack.label);
    }

    void read(const GridRect& window, GridView<float> out) override {
        TERRAY_CHECK(out.size() == (GridSize{window.width, window.height}));
        for (int64_t row = 0; row < out.height(); ++row) std::ranges::fill(out.row(row), kNoHeight);
        const GridRect inside = intersection(window, {0, 0, size_.width, size_.height});
        if (inside.empty()) return;
        const GridView<float> target =
            out.window({inside.x - window.x, inside.y - window.y, inside.width, inside.height});
        rasters_.front().read(inside, target);
        Grid<float> upper(rasters_.size() > 1 ? target.size() : GridSize{});
        for (size_t i = 1; i < rasters_.size(); ++i) {
            rasters_[i].read(inside, upper.view());
            layOver(upper.view(), target);
        }
        convert(target);
    }
    [[nodiscard]] bool resamples() const override { return isWarped_; }

  private:
    static void layOver(GridView<const float> upper, GridView<float> lower) {
        for (int64_t row = 0; row < lower.height(); ++row)
            std::ranges::transform(upper.row(row), lower.row(row), lower.row(row).begin(),
                                   [](float above, float below) { return std::isnan(above) ? below : above; });
    }
    /// To metres; what is no number becomes a hole.
    void convert(GridView<float> heights) const {
        for (int64_t row = 0; row < heights.height(); ++row)
            for (float& height : heights.row(row)) {
                height = static_cast<float>(height * units_.scale + units_.offset);
                if (!std::isfinite(height)) height = kNoHeight;
            }
    }

    GridSize size_;
    HeightUnits units_;
    bool isWarped_;
    std::vector<gdal::RasterReader> rasters_;
};

class GdalHeights final : public HeightSource {
  public:
    GdalHeights(HeightGridInfo info, HeightStack stack) : info_(std::move(info)), stack_(std::move(stack)) {}
    [[nodiscard]] const HeightGridInfo& info() const override { return info_; }
    [[nodiscard]] std::unique_ptr<HeightReader> openReader() const override {
        return std::make_unique<GdalHeightReader>(stack_, info_.size);
    }
    [[nodiscard]] uint64_t preparedBytes() const override { return stack_.copies.bytes(); }
    void prepare(const SourceWorkspace& workspace) const override { stack_.copies.prepare(workspace); }

  private:
    HeightGridInfo info_;
    HeightStack stack_;
};

/// Opens the sources step by step; each step adds to the stack and the info.
class HeightOpener {
  public:
    explicit HeightOpener(const HeightSourceOptions& options)
        : options_(options), stack_{.copies = TiledCopies(options.cacheBytes)} {}

    std::unique_ptr<HeightSource> open() {
        TERRAY_CHECK(!options_.files.empty());
        gdal::limitCache(options_.cacheBytes);
        inspectFiles();
        chooseUnits();
        placeFiles();
        groupFiles();
        chooseCrs();
        chooseGrid();
        for (const RasterFacts& raster : rasters_)
            info_.files.insert(info_.files.end(), raster.files.begin(), raster.files.end());
        return std::make_unique<GdalHeights>(std::move(info_), std::move(stack_));
    }

  private:
    void note(const std::string& text) const {
        if (options_.note) options_.note(text);
    }

    void inspectFiles() {
        for (const std::string& file : options_.files) {
            rasters_.push_back(gdal::inspect(file));
            if (rasters_.back().bands > 1)
                note("\"" + file + "\" has " + std::to_string(rasters_.back().bands) + " bands: heights are the first");
            if (rasters_.back().name != file) note("heights are taken from " + rasters_.back().name);
            for (const std::string& warning : rasters_.back().warnings)
                note("GDAL warns about " + file + ": " + warning);
        }
        stack_.label = rasters_.front().name;
        if (rasters_.size() > 1) stack_.label += " and " + std::to_string(rasters_.size() - 1) + " more";
    }

    /// One conversion to metres for all files: the file's own scale and offset, then its unit or the user's scale.
    void chooseUnits() {
        const RasterFacts& first = rasters_.front();
        for (const RasterFacts& raster : rasters_)
            if (raster.unit != first.unit || raster.scale != first.scale || raster.offset != first.offset)
                throw Error(ExitCode::input, "cannot mosaic \"" + first.name + "\" and \"" + raster.name +
                                                 "\": their heights differ in unit, scale or offset (\"" + first.unit +
                                                 "\" and \"" + raster.unit + "\"); convert one with gdal_translate");
        double userScale = options_.heightScale.value_or(1);
        const std::string unit = first.unit.empty() ? first.crs.verticalUnit : first.unit;
        const std::optional<double> metresPerUnit = metresPerHeightUnit(unit);
        if (!options_.heightScale && metresPerUnit.value_or(1) != 1) {
            userScale = *metresPerUnit;
            note("heights are in \"" + unit + "\": one unit is " + metres(userScale));
        } else if (!unit.empty() && !metresPerUnit) {
            note("heights are in \"" + unit + "\", a unit unknown here: taken as metres times --height-scale");
        }
        stack_.units = {first.scale * userScale, first.offset * userScale + options_.heightOffset};
        const bool isInteger = std::ranges::all_of(rasters_, &RasterFacts::isInteger);
        info_.sourceStep = isInteger ? std::abs(stack_.units.scale) : 0;
    }

    /// Sees that each file has a place, and gives the option's to one that has none.
    void placeFiles() {
        for (RasterFacts& raster : rasters_) {
            if (!raster.geoTransform) placePlainRaster(raster);
            if (!raster.crs.wkt.empty()) continue;
            if (!options_.crs.empty()) raster.crs = gdal::describeCrs(options_.crs);
            note("\"" + raster.name + "\" names no coordinate system: taken " +
                 (options_.crs.empty() ? "as metres in an unnamed plane" : "to be in " + raster.crs.name));
        }
        for (const RasterFacts& raster : rasters_)
            if (raster.crs.wkt.empty() != rasters_.front().crs.wkt.empty())
                throw Error(ExitCode::georeference, "cannot mosaic \"" + rasters_.front().name + "\" and \"" +
                                                        raster.name +
                                                        "\": only one of them names its coordinate system");
    }

    void placePlainRaster(RasterFacts& raster) const {
        const std::string what = "cannot place \"" + raster.name + "\": it does not say where it lies";
        if (!options_.spacing)
            throw Error(ExitCode::georeference, what + ". Give the metres between its samples: --spacing METRES");
        if (rasters_.size() > 1) throw Error(ExitCode::georeference, what + ", so it cannot be part of a mosaic");
        raster.geoTransform = {0, *options_.spacing, 0, 0, 0, -*options_.spacing};
        raster.isPlacedHere = true;
    }

    /// Each file as 32-bit floats with NaN for nodata; files that share a grid side by side.
    void groupFiles() {
        groups_ = groupByGrid(rasters_, mosaicOrder(rasters_, options_.priority));
        for (RasterGroup& group : groups_) {
            std::vector<std::string> parts;
            for (const size_t index : group.members) parts.push_back(floatRaster(rasters_[index]));
            group.raster = parts.front();
            // A rotated raster cannot be laid beside others, and needs not be: the warp knows its nodata.
            if (isNorthUp(group.transform)) group.raster = keep(gdal::mosaic(parts, {"-strict", "-vrtnodata", "nan"}));
        }
    }

    std::string floatRaster(const RasterFacts& raster) {
        std::vector<std::string> arguments = placeArguments(raster);
        arguments.insert(arguments.end(), {"-b", "1", "-ot", "Float32"});
        if (options_.nodata) arguments.insert(arguments.end(), {"-a_nodata", exactText(*options_.nodata)});
        stack_.keptAlive.push_back(gdal::translate(raster.name, arguments));
        return stack_.copies.nameOf(stack_.keptAlive.back(), raster);
    }

    /// UTM (or UPS) where the ground is; for ground so wide that its scale would be off by more than 1 % at the rim, an
    /// equal-area projection around the middle.
    static Crs metricCrs(const std::string& raster) {
        constexpr double kWidestUtm = 1.8e6;  // metres: k = 0.9996 (1 + x^2 / 2 R^2) reaches 1.01 at x = 920 km
        const LonLat middle = gdal::centre(raster);
        Crs utm = gdal::describeCrs("EPSG:" + std::to_string(metricEpsg(middle)));
        const GroundRect extent = gdal::footprint(raster, utm.wkt).extent;
        if (std::max(extent.east - extent.west, extent.north - extent.south) <= kWidestUtm) return utm;
        const std::string place =
            "+lat_0=" + exactText(std::round(middle.latitude)) + " +lon_0=" + exactText(std::round(middle.longitude));
        Crs wide = gdal::describeCrs("+proj=laea " + place + " +datum=WGS84 +units=m +no_defs +type=crs");
        wide.name = "Lambert azimuthal equal area, WGS 84, " + place;
        return wide;
    }

    void chooseCrs() {
        // The file that the user named first, wherever it lies in the mosaic.
        const RasterGroup& home = *std::ranges::find_if(groups_, [](const RasterGroup& group) {
            return std::ranges::find(group.members, 0u) != group.members.end();
        });
        const Crs& own = home.crs;
        crs_ = options_.crs.empty() ? own : gdal::describeCrs(options_.crs);
        if (!options_.crs.empty() && !crs_.isMetric())
            throw Error(ExitCode::georeference,
                        "cannot build in " + crs_.name + ": expected a projected system in metres, such as EPSG:32632");
        if (!crs_.isMetric()) {
            crs_ = metricCrs(home.raster);
            note(own.name + " is not in metres: warped to " + crs_.name + " (another: --crs)");
        }
        info_.crsWkt = crs_.wkt;
        info_.crsName = crs_.name;
        info_.verticalDatum = own.verticalDatum;
        const bool isOne = std::ranges::all_of(
            rasters_, [&](const RasterFacts& raster) { return raster.crs.verticalWkt == own.verticalWkt; });
        if (isOne) info_.verticalWkt = own.verticalWkt;
    }

    /// The grid of the only group when it fits as it is; else one that covers all, to which each group is warped.
    void chooseGrid() {
        std::vector<gdal::Footprint> footprints;
        for (const RasterGroup& group : groups_) footprints.push_back(gdal::footprint(group.raster, crs_.wkt));
        const size_t finest = static_cast<size_t>(
            std::ranges::min_element(footprints, {}, &gdal::Footprint::finestSpacing) - footprints.begin());
        const std::optional<SquareGrid> own = nativeGrid(groups_[finest]);
        const double spacing = options_.spacing.value_or(own ? own->spacing : footprints[finest].finestSpacing);
        const bool keepsOwn = own && std::abs(spacing - own->spacing) <= 1e-6 * spacing;
        if (keepsOwn && groups_.size() == 1) {
            takeAsItIs(groups_.front(), *own);
            return;
        }
        GroundRect extent = footprints.front().extent;
        for (const gdal::Footprint& footprint : footprints) extent = unionOf(extent, footprint.extent);
        const SquareGrid grid =
            within(coveringGrid(extent, keepsOwn ? own->spacing : spacing, keepsOwn ? &*own : nullptr));
        for (const RasterGroup& group : groups_) stack_.rasters.push_back(warped(group, grid));
        note("heights are resampled (bilinear) to " + metres(grid.spacing) + " in " +
             (crs_.wkt.empty() ? "the unnamed plane" : crs_.name));
        info_.sourceStep = 0;
        stack_.isWarped = true;
        setGrid(grid);
    }

    void takeAsItIs(const RasterGroup& group, const SquareGrid& own) {
        const SquareGrid grid = within(own);
        stack_.rasters = {group.raster};
        if (grid.size != own.size) {
            const int64_t column = std::llround((grid.west - own.west) / own.spacing);
            const int64_t row = std::llround((own.north - grid.north) / own.spacing);
            stack_.rasters = {keep(
                gdal::translate(group.raster, {"-srcwin", std::to_string(column), std::to_string(row),
                                               std::to_string(grid.size.width), std::to_string(grid.size.height)}))};
        }
        setGrid(grid);
    }

    /// The part of a grid that the user asked for.
    SquareGrid within(const SquareGrid& grid) const {
        if (!options_.bounds) return grid;
        const std::optional<SquareGrid> part = clippedGrid(grid, *options_.bounds);
        if (part) return *part;
        throw Error(ExitCode::georeference, "the heights do not reach into the area of --bbox: they cover " +
                                                describe(grid.bounds(), info_.crsName) + ", the area is " +
                                                describe(*options_.bounds, info_.crsName));
    }

    /// The group's grid when its samples can be taken as they are.
    std::optional<SquareGrid> nativeGrid(const RasterGroup& group) const {
        if (!gdal::sameCrs(group.crs, crs_)) return {};
        return squareGrid(group.transform, group.size);
    }

    std::string warped(const RasterGroup& group, const SquareGrid& grid) {
        std::vector<std::string> arguments = gridArguments(grid, crs_.wkt);
        const RasterFacts& first = rasters_[group.members.front()];
        const std::optional<double> nodata = options_.nodata ? options_.nodata : first.nodata;
        const bool isNan = isNorthUp(group.transform) || !nodata;
        const std::string hidden = isNan ? "nan" : exactText(*nodata);
        for (const char* argument :
             {"-r", "bilinear", "-ot", "Float32", "-srcnodata", hidden.c_str(), "-dstnodata", "nan", "-et", "0.125"})
            arguments.emplace_back(argument);
        return keep(gdal::warp(group.raster, arguments));
    }

    void setGrid(const SquareGrid& grid) {
        info_.size = grid.size;
        info_.west = grid.west;
        info_.north = grid.north;
        info_.spacing = grid.spacing;
        info_.lonLatBounds = gdal::lonLatBounds(grid.bounds(), crs_.wkt);
    }

    std::string keep(VirtualRaster raster) {
        stack_.keptAlive.push_back(std::move(raster));
        return stack_.keptAlive.back().name();
    }

    const HeightSourceOptions& options_;
    std::vector<RasterFacts> rasters_;
    std::vector<RasterGroup> groups_;
    Crs crs_;
    HeightGridInfo info_;
    HeightStack stack_;
};

}  // namespace

void interpolateHoles(Grid<float>& heights, int distance) {
    gdal::fillHoles(heights, distance);
}

std::unique_ptr<HeightSource> openGdalHeights(const HeightSourceOptions& options) {
    return HeightOpener(options).open();
}

}  // namespace terray
