#include "preprocess/gdal_raster.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_alg.h>
#include <gdal_priv.h>
#include <gdal_utils.h>
#include <ogr_spatialref.h>

#include "common/check.h"
#include "preprocess/gdal_door.h"
#include "preprocess/plain_image.h"
#include "preprocess/raster_layout.h"

namespace terray::gdal {

void initialise() {
    static std::once_flag once;
    std::call_once(once, [] {
        CPLSetErrorHandler(CPLQuietErrorHandler);
        CPLSetConfigOption("VRT_SHARED_SOURCE", "NO");
        CPLSetConfigOption("GTIFF_REPORT_COMPD_CS", "YES");  // what heights are above, also in files of GeoTIFF 1.0
        GDALAllRegister();
    });
}

namespace {

[[noreturn]] void refusePlace(const std::string& message) {
    throw Error(ExitCode::georeference, message);
}

/// As open(); the message of a failure says which of the usual reasons it has.
GDALDatasetUniquePtr openOrExplain(const std::string& file, const Messages& messages) {
    VSIStatBufL status;
    const bool exists = VSIStatL(file.c_str(), &status) == 0;
    if (exists && VSI_ISREG(status.st_mode) && status.st_size == 0)
        refuse("cannot read \"" + file + "\": the file is empty (0 bytes)");
    GDALDatasetUniquePtr dataset = open(file);
    if (dataset) return dataset;
    if (exists)
        refuse("cannot read \"" + file + "\": it is no raster that GDAL can open, or is cut short (" + messages.text() +
               ")");
    refuse("cannot read \"" + file + "\": there is no such file");
}

/// The one grid of a container (netCDF, HDF) that opens without bands of its own.
GDALDatasetUniquePtr openOnlyGrid(const std::string& file, GDALDataset& container) {
    const CPLStringList entries(container.GetMetadata("SUBDATASETS"), FALSE);
    std::vector<std::string> names;
    std::vector<std::string> grids;
    for (int i = 1; const char* name = entries.FetchNameValue(CPLSPrintf("SUBDATASET_%d_NAME", i)); ++i) {
        names.emplace_back(name);
        const GDALDatasetUniquePtr part = open(names.back());
        if (part && part->GetRasterCount() == 1 && part->GetRasterXSize() > 1 && part->GetRasterYSize() > 1)
            grids.push_back(names.back());
    }
    if (grids.size() == 1) return open(grids.front());
    std::string list;
    for (const std::string& name : names) list += "\n  " + name;
    if (names.empty()) refuse("cannot read \"" + file + "\": GDAL opens it but finds no raster bands in it");
    refuse("cannot read \"" + file + "\": it holds several grids. Name one of them instead of the file:" + list);
}

/// WKT of a compound system's vertical part.
std::string verticalPartOf(const OGRSpatialReference& compound) {
    const OGR_SRSNode* part = compound.GetAttrNode("VERT_CS");
    char* wkt = nullptr;
    std::string text;
    if (part != nullptr && part->exportToWkt(&wkt) == OGRERR_NONE) text = wkt;
    CPLFree(wkt);
    return text;
}

Crs crsOf(const OGRSpatialReference* reference) {
    Crs crs;
    if (reference == nullptr || reference->IsEmpty()) return crs;
    OGRSpatialReference horizontal(*reference);
    if (horizontal.IsCompound()) {
        if (const char* datum = horizontal.GetAttrValue("VERT_CS")) crs.verticalDatum = datum;
        const char* unit = nullptr;
        horizontal.GetTargetLinearUnits("VERT_CS", &unit);
        crs.verticalUnit = unit != nullptr ? unit : "";
        crs.verticalWkt = verticalPartOf(horizontal);
        horizontal.StripVertical();
    }
    const std::array<const char*, 3> options{"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
    char* wkt = nullptr;
    if (horizontal.exportToWkt(&wkt, options.data()) == OGRERR_NONE) crs.wkt = wkt;
    CPLFree(wkt);
    crs.isProjected = horizontal.IsProjected() || horizontal.IsLocal();
    crs.metresPerUnit = crs.isProjected ? horizontal.GetLinearUnits() : 1;
    // Only to name it: files often spell out a well-known system without its code.
    if (horizontal.GetAuthorityCode(nullptr) == nullptr) horizontal.AutoIdentifyEPSG();
    const char* authority = horizontal.GetAuthorityName(nullptr);
    const char* code = horizontal.GetAuthorityCode(nullptr);
    const char* name = horizontal.GetName();
    crs.name = authority != nullptr && code != nullptr ? std::string(authority) + ":" + code
               : name != nullptr                       ? name
                                                       : "";
    return crs;
}

bool hasDegreeAxes(GDALDataset& dataset) {
    const CPLStringList items(dataset.GetMetadata(), FALSE);
    return namesDegreeAxes({items.List(), items.List() + items.Count()});
}

/// Bands of red, green and blue by their label, else the first three; a grey band three times.
std::vector<int> colourBandsOf(GDALDataset& dataset) {
    std::vector<int> bands;
    for (const GDALColorInterp colour : {GCI_RedBand, GCI_GreenBand, GCI_BlueBand})
        for (int band = 1; band <= dataset.GetRasterCount(); ++band)
            if (dataset.GetRasterBand(band)->GetColorInterpretation() == colour) bands.push_back(band);
    if (bands.size() == 3) return bands;
    if (dataset.GetRasterCount() >= 3) return {1, 2, 3};
    return {1, 1, 1};
}

std::optional<double> nodataOf(GDALRasterBand& band) {
    int declared = FALSE;
    const double value = band.GetNoDataValue(&declared);
    if (declared == FALSE) return {};
    return value;
}

std::vector<SourceFile> filesOf(GDALDataset& dataset) {
    std::vector<SourceFile> files;
    const CPLStringList list(dataset.GetFileList(), TRUE);
    for (int i = 0; i < list.Count(); ++i)
        if (auto file = fileOnDisk(list[i])) files.push_back(std::move(*file));
    return files;
}

/// The block in which a raster is stored; of a VRT, whose own blocks are none, the widest of its first few files'.
GridSize storedBlock(GDALDataset& dataset) {
    constexpr int kMostFiles = 4;  // parts of one product are stored alike
    GridSize widest;
    const auto look = [&](GDALDataset& raster) {
        if (raster.GetRasterCount() == 0) return;
        int width = 0;
        int height = 0;
        raster.GetRasterBand(1)->GetBlockSize(&width, &height);
        if (width > widest.width) widest = {width, height};
    };
    if (dataset.GetDriver() == nullptr || !EQUAL(dataset.GetDriver()->GetDescription(), "VRT")) {
        look(dataset);
        return widest;
    }
    const CPLStringList files(dataset.GetFileList(), TRUE);
    for (int i = 0, looked = 0; i < files.Count() && looked < kMostFiles; ++i) {
        if (EQUAL(files[i], dataset.GetDescription())) continue;
        const GDALDatasetUniquePtr part(GDALDataset::Open(files[i], GDAL_OF_RASTER));
        if (!part) continue;
        look(*part);
        ++looked;
    }
    return widest;
}

void describeBands(GDALDataset& dataset, RasterFacts& facts) {
    GDALRasterBand& band = *dataset.GetRasterBand(1);
    const GDALDataType type = band.GetRasterDataType();
    const char* usedBits = band.GetMetadataItem("NBITS", "IMAGE_STRUCTURE");
    facts.bands = dataset.GetRasterCount();
    facts.block = storedBlock(dataset);
    facts.pixelBytes = static_cast<uint64_t>(facts.bands) * static_cast<uint64_t>(GDALGetDataTypeSizeBytes(type));
    facts.isInteger = GDALDataTypeIsInteger(type) != 0;
    facts.bits = usedBits != nullptr ? std::atoi(usedBits) : GDALGetDataTypeSizeBits(type);
    facts.hasPalette = band.GetColorTable() != nullptr;
    facts.nodata = nodataOf(band);
    facts.scale = band.GetScale();
    facts.offset = band.GetOffset();
    facts.unit = band.GetUnitType();
    facts.colourBands = colourBandsOf(dataset);
    std::array<double, 3> colour{};
    bool isDeclared = true;
    for (size_t i = 0; i < 3; ++i) {
        const std::optional<double> value = nodataOf(*dataset.GetRasterBand(facts.colourBands[i]));
        isDeclared = isDeclared && value;
        colour[i] = value.value_or(0);
    }
    if (isDeclared) facts.colourNodata = colour;
}

/// Frees a transformer when it goes out of scope.
struct DestroyTransformer {
    void operator()(void* transformer) const { GDALDestroyGenImgProjTransformer(transformer); }
};
using Transformer = std::unique_ptr<void, DestroyTransformer>;

/// From a raster's pixels to another system's plane; degrees as longitude, latitude.
Transformer transformerTo(GDALDataset& dataset, const std::string& crsWkt, const Messages& messages) {
    CPLStringList options;
    if (!crsWkt.empty()) options.SetNameValue("DST_SRS", crsWkt.c_str());
    Transformer transformer(GDALCreateGenImgProjTransformer2(GDALDataset::ToHandle(&dataset), nullptr, options.List()));
    if (!transformer) refusePlace(std::string("cannot transform the raster's coordinates: ") + messages.text());
    return transformer;
}

using Point = PixelPlace;

/// Places of pixels, and only of those that have one.
std::vector<Point> placesOf(void* transformer, const std::vector<Point>& pixels) {
    std::vector<Point> places;
    for (Point point : pixels) {
        double z = 0;
        int succeeded = FALSE;
        GDALGenImgProjTransform(transformer, FALSE, 1, &point.x, &point.y, &z, &succeeded);
        if (succeeded != FALSE && std::isfinite(point.x) && std::isfinite(point.y)) places.push_back(point);
    }
    return places;
}

/// Extends bounds in degrees by the poles inside an area of the plane. PROJ (9.1) looks for the second pole only where
/// it has not found the first, and so cuts a map of the whole earth off near the equator.
void includePoles(const GroundRect& area, const OGRCoordinateTransformation& degreesFromPlane, GroundRect& bounds) {
    const std::unique_ptr<OGRCoordinateTransformation> planeFromDegrees(degreesFromPlane.GetInverse());
    for (const double latitude : {-90.0, 90.0}) {
        Point pole{.x = 0, .y = latitude};
        if (!planeFromDegrees || !planeFromDegrees->Transform(1, &pole.x, &pole.y)) continue;
        const bool isInside = pole.x > area.west && pole.x < area.east && pole.y > area.south && pole.y < area.north;
        if (isInside) bounds = unionOf({-180, bounds.south, 180, bounds.north}, {-180, latitude, 180, latitude});
    }
}

[[noreturn]] void refuseCentre(const Messages& messages) {
    refusePlace(
        "cannot place the raster: its centre lies where the coordinate system is not defined; choose another with "
        "--crs (" +
        messages.text() + ")");
}

std::string nextVirtualName() {
    static std::atomic<uint64_t> count{0};
    return "/vsimem/terray/" + std::to_string(++count) + ".vrt";
}

CPLStringList argumentsOf(std::vector<std::string> options, const char* format) {
    CPLStringList list;
    if (format != nullptr) options.insert(options.begin(), {"-of", format});
    for (const std::string& option : options) list.AddString(option.c_str());
    return list;
}

/// Writes the description of a derived raster, which happens when its handle is closed.
void finish(GDALDatasetH derived, const std::string& what, const Messages& messages) {
    const bool made = derived != nullptr;
    if (made) GDALClose(derived);
    if (!made || messages.failed()) refuse("cannot prepare " + what + ": " + messages.text());
}

}  // namespace

void limitCache(uint64_t bytes) {
    initialise();
    GDALSetCacheMax64(static_cast<GIntBig>(bytes));
}

RasterFacts inspect(const std::string& file) {
    initialise();
    const Messages messages;
    GDALDatasetUniquePtr dataset = openOrExplain(file, messages);
    RasterFacts facts{.name = file};
    if (dataset->GetRasterCount() == 0) {
        dataset = openOnlyGrid(file, *dataset);
        facts.name = dataset->GetDescription();
    }
    facts.size = {dataset->GetRasterXSize(), dataset->GetRasterYSize()};
    if (facts.size.width <= 0 || facts.size.height <= 0) refuse("cannot read \"" + file + "\": it has no pixels");
    GeoTransform transform{};
    if (dataset->GetGeoTransform(transform.data()) == CE_None) facts.geoTransform = transform;
    if (!facts.geoTransform && dataset->GetGCPCount() > 0)
        refusePlace("cannot place \"" + file +
                    "\": it has only ground control points. Rectify it first: gdalwarp -t_srs ...");
    facts.crs = crsOf(dataset->GetSpatialRef());
    if (facts.crs.wkt.empty() && facts.geoTransform && hasDegreeAxes(*dataset)) facts.crs = describeCrs("EPSG:4326");
    describeBands(*dataset, facts);
    facts.files = filesOf(*dataset);
    facts.warnings = messages.warnings();
    return facts;
}

Crs describeCrs(const std::string& text) {
    initialise();
    const Messages messages;
    OGRSpatialReference reference;
    const std::array<const char*, 3> options{"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};
    if (reference.SetFromUserInput(text.c_str(), options.data()) != OGRERR_NONE)
        refusePlace("unknown coordinate system \"" + text + "\": expected a code such as EPSG:32632, or WKT (" +
                    messages.text() + ")");
    return crsOf(&reference);
}

bool sameCrs(const Crs& a, const Crs& b) {
    if (a.wkt == b.wkt || a.wkt.empty() || b.wkt.empty()) return a.wkt == b.wkt;
    const Messages messages;
    const OGRSpatialReference first(a.wkt.c_str());
    const OGRSpatialReference second(b.wkt.c_str());
    return first.IsSame(&second) != 0;
}

VirtualRaster::VirtualRaster()
    : name_(new std::string(nextVirtualName()), [](const std::string* name) {
          VSIUnlink(name->c_str());
          delete name;
      }) {}

VirtualRaster translate(const std::string& source, const std::vector<std::string>& options) {
    VirtualRaster result;
    describeAnew(result, source, options);
    return result;
}

void describeAnew(const VirtualRaster& target, const std::string& source, const std::vector<std::string>& options) {
    const Messages messages;
    const GDALDatasetUniquePtr input = openSource(source, messages);
    CPLStringList arguments(argumentsOf(options, "VRT"));
    arguments.AddString("-noxmp");  // looking for it walks through half of a PNG
    GDALTranslateOptions* parsed = GDALTranslateOptionsNew(arguments.List(), nullptr);
    GDALDatasetH made = GDALTranslate(target.name().c_str(), GDALDataset::ToHandle(input.get()), parsed, nullptr);
    GDALTranslateOptionsFree(parsed);
    finish(made, "\"" + source + "\"", messages);
}

VirtualRaster mosaic(const std::vector<std::string>& sources, const std::vector<std::string>& options) {
    const Messages messages;
    CPLStringList names;
    for (const std::string& source : sources) names.AddString(source.c_str());
    GDALBuildVRTOptions* parsed = GDALBuildVRTOptionsNew(argumentsOf(options, nullptr).List(), nullptr);
    VirtualRaster result;
    GDALDatasetH made = GDALBuildVRT(result.name().c_str(), names.Count(), nullptr, names.List(), parsed, nullptr);
    GDALBuildVRTOptionsFree(parsed);
    finish(made, "the mosaic of " + std::to_string(sources.size()) + " rasters", messages);
    return result;
}

VirtualRaster warp(const std::string& source, const std::vector<std::string>& options) {
    const Messages messages;
    const GDALDatasetUniquePtr input = openSource(source, messages);
    GDALWarpAppOptions* parsed = GDALWarpAppOptionsNew(argumentsOf(options, "VRT").List(), nullptr);
    VirtualRaster result;
    GDALDatasetH handle = GDALDataset::ToHandle(input.get());
    GDALDatasetH made = GDALWarp(result.name().c_str(), nullptr, 1, &handle, parsed, nullptr);
    GDALWarpAppOptionsFree(parsed);
    finish(made, "the resampling of \"" + source + "\"", messages);
    return result;
}

Footprint footprint(const std::string& raster, const std::string& crsWkt) {
    const Messages messages;
    const GDALDatasetUniquePtr dataset = openSource(raster, messages);
    const Transformer transformer = transformerTo(*dataset, crsWkt, messages);
    const Point middle{dataset->GetRasterXSize() / 2.0, dataset->GetRasterYSize() / 2.0};
    const std::vector<Point> steps =
        placesOf(transformer.get(), {middle, {middle.x + 1, middle.y}, {middle.x, middle.y + 1}});
    if (steps.size() < 3) refuseCentre(messages);
    const Point& here = steps.front();
    const auto stepTo = [&](const Point& there) { return std::hypot(there.x - here.x, there.y - here.y); };
    Footprint result{.extent = {here.x, here.y, here.x, here.y},
                     .finestSpacing = std::min(stepTo(steps[1]), stepTo(steps[2]))};
    for (const Point& place :
         placesOf(transformer.get(), outlinePixels({dataset->GetRasterXSize(), dataset->GetRasterYSize()})))
        result.extent = unionOf(result.extent, {place.x, place.y, place.x, place.y});
    return result;
}

LonLat centre(const std::string& raster) {
    const Messages messages;
    const GDALDatasetUniquePtr dataset = openSource(raster, messages);
    const Transformer transformer = transformerTo(*dataset, "EPSG:4326", messages);
    const std::vector<Point> places =
        placesOf(transformer.get(), {{dataset->GetRasterXSize() / 2.0, dataset->GetRasterYSize() / 2.0}});
    if (places.empty()) refuseCentre(messages);
    return {.longitude = std::remainder(places.front().x, 360.0), .latitude = places.front().y};
}

std::optional<GroundRect> lonLatBounds(const GroundRect& area, const std::string& crsWkt) {
    if (crsWkt.empty()) return {};
    const Messages messages;
    OGRSpatialReference plane;
    OGRSpatialReference degrees;
    if (plane.SetFromUserInput(crsWkt.c_str()) != OGRERR_NONE || degrees.importFromEPSG(4326) != OGRERR_NONE) return {};
    plane.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> transformation(
        OGRCreateCoordinateTransformation(&plane, &degrees));
    constexpr int kPointsPerSide = 21;
    GroundRect bounds;
    if (!transformation || !transformation->TransformBounds(area.west, area.south, area.east, area.north, &bounds.west,
                                                            &bounds.south, &bounds.east, &bounds.north, kPointsPerSide))
        return {};
    includePoles(area, *transformation, bounds);
    // Numbers that JSON has no words for would make metadata that nobody can read.
    const bool isFinite = std::isfinite(bounds.west) && std::isfinite(bounds.south) && std::isfinite(bounds.east) &&
                          std::isfinite(bounds.north);
    if (!isFinite) return {};
    return bounds;
}

}  // namespace terray::gdal

bool terray::hasGeoreference(const std::string& file) {
    gdal::initialise();
    const gdal::Messages messages;
    const GDALDatasetUniquePtr dataset = gdal::open(file);
    if (!dataset) return false;
    GeoTransform transform{};
    return dataset->GetRasterCount() == 0 || dataset->GetGeoTransform(transform.data()) == CE_None ||
           dataset->GetGCPCount() > 0;
}
