#include "tests/preprocess_sources/raster_writer.h"

#include <map>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

namespace terray::test {

namespace {

OGRSpatialReference reference(const std::string& crs) {
    OGRSpatialReference result;
    EXPECT_EQ(result.SetFromUserInput(crs.c_str()), OGRERR_NONE) << crs;
    result.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return result;
}

std::pair<double, double> transformed(const std::string& from, const std::string& to, double x, double y) {
    // Kept, since making one takes milliseconds.
    static std::map<std::pair<std::string, std::string>, std::unique_ptr<OGRCoordinateTransformation>> known;
    auto& transformation = known[{from, to}];
    if (!transformation) {
        const OGRSpatialReference source = reference(from);
        const OGRSpatialReference target = reference(to);
        transformation.reset(OGRCreateCoordinateTransformation(&source, &target));
    }
    EXPECT_TRUE(transformation->Transform(1, &x, &y));
    return {x, y};
}

void describeBand(GDALRasterBand& band, const RasterSpec& spec) {
    if (spec.nodata) band.SetNoDataValue(*spec.nodata);
    if (spec.scale != 1) band.SetScale(spec.scale);
    if (spec.offset != 0) band.SetOffset(spec.offset);
    if (!spec.unit.empty()) band.SetUnitType(spec.unit.c_str());
    if (spec.palette.empty()) return;
    GDALColorTable table;
    for (size_t i = 0; i < spec.palette.size(); ++i) {
        const auto& [red, green, blue] = spec.palette[i];
        const GDALColorEntry entry{static_cast<short>(red), static_cast<short>(green), static_cast<short>(blue), 255};
        table.SetColorEntry(static_cast<int>(i), &entry);
    }
    band.SetColorTable(&table);
}

void describe(GDALDataset& dataset, const RasterSpec& spec) {
    GeoTransform transform = spec.transform.value_or(GeoTransform{});
    if (spec.transform) dataset.SetGeoTransform(transform.data());
    if (!spec.crs.empty()) {
        const OGRSpatialReference crs = reference(spec.crs);
        dataset.SetSpatialRef(&crs);
    }
    for (const auto& [name, text] : spec.metadata) dataset.SetMetadataItem(name.c_str(), text.c_str());
    for (int band = 1; band <= spec.bands; ++band) describeBand(*dataset.GetRasterBand(band), spec);
    if (spec.lastBandIsAlpha) dataset.GetRasterBand(spec.bands)->SetColorInterpretation(GCI_AlphaBand);
}

void fill(GDALDataset& dataset, const RasterSpec& spec) {
    const auto width = static_cast<int>(spec.size.width);
    std::vector<double> line(static_cast<size_t>(width));
    for (int band = 0; band < spec.bands; ++band)
        for (int row = 0; row < spec.size.height; ++row) {
            for (int column = 0; column < width; ++column)
                line[static_cast<size_t>(column)] = spec.value(band, column, row);
            EXPECT_EQ(dataset.GetRasterBand(band + 1)->RasterIO(GF_Write, 0, row, width, 1, line.data(), width, 1,
                                                                GDT_Float64, 0, 0, nullptr),
                      CE_None);
        }
}

}  // namespace

GeoTransform northUp(double west, double north, double spacing) {
    return {west, spacing, 0, north, 0, -spacing};
}

std::string writeRaster(const std::string& file, const RasterSpec& spec) {
    GDALAllRegister();
    const GDALDataType type = GDALGetDataTypeByName(spec.type.c_str());
    const bool canCreate = spec.driver == "GTiff";
    CPLStringList options;
    for (const std::string& option : spec.creationOptions) options.AddString(option.c_str());
    GDALDriver* memory = GetGDALDriverManager()->GetDriverByName(canCreate ? spec.driver.c_str() : "MEM");
    {
        const GDALDatasetUniquePtr dataset(memory->Create(file.c_str(), static_cast<int>(spec.size.width),
                                                          static_cast<int>(spec.size.height), spec.bands, type,
                                                          canCreate ? options.List() : nullptr));
        EXPECT_TRUE(dataset) << file;
        describe(*dataset, spec);
        fill(*dataset, spec);
        if (canCreate) return file;
        GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(spec.driver.c_str());
        const GDALDatasetUniquePtr copy(
            driver->CreateCopy(file.c_str(), dataset.get(), FALSE, options.List(), nullptr, nullptr));
        EXPECT_TRUE(copy) << file;
    }
    return file;
}

LonLat lonLatOf(const std::string& crs, double x, double y) {
    const auto [longitude, latitude] = transformed(crs, "EPSG:4326", x, y);
    return {.longitude = longitude, .latitude = latitude};
}

std::pair<double, double> placeOf(const std::string& crs, LonLat lonLat) {
    return transformed("EPSG:4326", crs, lonLat.longitude, lonLat.latitude);
}

Grid<float> readAll(const HeightSource& source, int64_t margin) {
    const GridSize size = source.info().size;
    Grid<float> heights({size.width + 2 * margin, size.height + 2 * margin});
    source.openReader()->read({-margin, -margin, heights.width(), heights.height()}, heights.view());
    return heights;
}

Grid<Rgba> readCells(const ColourSource& source, const GridRect& window) {
    Grid<Rgba> cells({window.width, window.height});
    source.openReader()->read(window, cells.view());
    return cells;
}

Refusal refusalOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return {.code = error.code(), .message = error.what()};
    }
    return {};
}

}  // namespace terray::test
