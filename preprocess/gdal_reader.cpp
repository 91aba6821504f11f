#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_alg.h>

#include "common/check.h"
#include "preprocess/gdal_door.h"
#include "preprocess/gdal_raster.h"

namespace terray::gdal {

namespace {

constexpr int kTileSide = 256;  // of a copy; its tiles are lower where rows are so wide that fewer fit into memory

/// A TIFF like `source` in everything but how it is stored.
GDALDatasetUniquePtr createLike(GDALDataset& source, const std::string& file, int64_t tileRows, bool hasMask,
                                const Messages& messages) {
    GDALRasterBand& first = *source.GetRasterBand(1);
    const int bands = source.GetRasterCount();
    const bool isFloat = first.GetRasterDataType() == GDT_Float32;
    CPLStringList options;
    options.SetNameValue("TILED", "YES");
    options.SetNameValue("BLOCKXSIZE", std::to_string(kTileSide).c_str());
    options.SetNameValue("BLOCKYSIZE", std::to_string(tileRows).c_str());
    options.SetNameValue("COMPRESS", "ZSTD");
    options.SetNameValue("ZSTD_LEVEL", "1");
    options.SetNameValue("PREDICTOR", isFloat ? "3" : "2");
    options.SetNameValue("BIGTIFF", "IF_SAFER");
    if (bands == 4) options.SetNameValue("ALPHA", "YES");
    GDALDriver& tiff = *GetGDALDriverManager()->GetDriverByName("GTiff");
    GDALDatasetUniquePtr copy(tiff.Create(file.c_str(), source.GetRasterXSize(), source.GetRasterYSize(), bands,
                                          first.GetRasterDataType(), options.List()));
    if (!copy) throw Error(ExitCode::output, "cannot create " + file + ": " + messages.text());
    std::array<double, 6> transform{};
    if (source.GetGeoTransform(transform.data()) == CE_None) copy->SetGeoTransform(transform.data());
    if (source.GetSpatialRef() != nullptr) copy->SetSpatialRef(source.GetSpatialRef());
    int hasNodata = FALSE;
    const double nodata = first.GetNoDataValue(&hasNodata);
    if (hasNodata != FALSE) copy->GetRasterBand(1)->SetNoDataValue(nodata);
    if (hasMask) copy->CreateMaskBand(GMF_PER_DATASET);
    return copy;
}

/// Reads or writes whole rows of all bands, one band after the other: asked for all at once, GDAL would read a VRT in
/// squares of 128 pixels, and so each row of a strip many times.
CPLErr moveRows(GDALDataset& dataset, GDALRWFlag way, int row, int rows, std::vector<std::byte>& pixels) {
    const int width = dataset.GetRasterXSize();
    const GDALDataType type = dataset.GetRasterBand(1)->GetRasterDataType();
    const size_t bandBytes = pixels.size() / static_cast<size_t>(dataset.GetRasterCount());
    CPLErr status = CE_None;
    for (int band = 0; band < dataset.GetRasterCount(); ++band)
        status = std::max(
            status, dataset.GetRasterBand(band + 1)->RasterIO(
                        way, 0, row, width, rows, pixels.data() + band * bandBytes, width, rows, type, 0, 0, nullptr));
    return status;
}

}  // namespace

int64_t rowsOfCopy(GridSize size) {
    // Each band is read by itself, so the cache has to hold these rows of all bands (8 bytes for four of 16 bits)
    // beside the copy's own (4 bytes); else they would be read anew for each band.
    const int64_t pixels = GDALGetCacheMax64() / 16;
    return std::clamp(pixels / size.width / 16 * 16, int64_t{16}, int64_t{kTileSide});
}

void copyInTiles(const std::string& raster, const std::string& label, const std::string& file,
                 const std::function<void()>& rowsDone) {
    const Messages messages;
    const GDALDatasetUniquePtr source = openSource(raster, messages);
    GDALRasterBand& first = *source->GetRasterBand(1);
    const int width = source->GetRasterXSize();
    const int height = source->GetRasterYSize();
    const auto step = static_cast<int>(rowsOfCopy({width, height}));
    const bool hasMask = first.GetMaskFlags() == GMF_PER_DATASET;
    CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
    GDALDatasetUniquePtr copy = createLike(*source, file, step, hasMask, messages);
    CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", nullptr);
    const auto pixelBytes =
        static_cast<size_t>(source->GetRasterCount() * GDALGetDataTypeSizeBytes(first.GetRasterDataType()));
    std::vector<std::byte> pixels(static_cast<size_t>(width) * static_cast<size_t>(step) * pixelBytes);
    for (int row = 0; row < height; row += step) {
        const int rows = std::min(step, height - row);
        const auto maskRows = [&](GDALRasterBand& band, GDALRWFlag way) {
            return band.GetMaskBand()->RasterIO(way, 0, row, width, rows, pixels.data(), width, rows, GDT_Byte, 0, 0,
                                                nullptr);
        };
        const auto requireRead = [&](CPLErr status) {
            if (status != CE_None || messages.failed())
                refuse("cannot read rows " + std::to_string(row) + " to " + std::to_string(row + rows) + " of \"" +
                       label + "\"; the file is cut short or damaged (" + messages.text() + ")");
        };
        requireRead(moveRows(*source, GF_Read, row, rows, pixels));
        CPLErr status = moveRows(*copy, GF_Write, row, rows, pixels);
        if (hasMask) {
            requireRead(maskRows(first, GF_Read));
            status = std::max(status, maskRows(*copy->GetRasterBand(1), GF_Write));
        }
        copy->FlushCache(false);
        if (status != CE_None || messages.failed())
            throw Error(ExitCode::output, "cannot write " + file + ": " + messages.text());
        rowsDone();
    }
    copy.reset();
    if (messages.failed()) throw Error(ExitCode::output, "cannot write " + file + ": " + messages.text());
}

void fillHoles(Grid<float>& heights, int distance) {
    initialise();
    const Messages messages;
    const auto width = static_cast<int>(heights.width());
    const auto height = static_cast<int>(heights.size().height);
    GDALDriver& memory = *GetGDALDriverManager()->GetDriverByName("MEM");
    const GDALDatasetUniquePtr raster(memory.Create("", width, height, 1, GDT_Float32, nullptr));
    const GDALDatasetUniquePtr mask(memory.Create("", width, height, 1, GDT_Byte, nullptr));
    std::vector<uint8_t> valid;
    for (const float value : heights.cells()) valid.push_back(std::isnan(value) ? 0 : 255);
    const std::array<const char*, 2> options{"TEMP_FILE_DRIVER=MEM", nullptr};
    const auto pass = [&](GDALDataset& dataset, GDALRWFlag way, void* cells, GDALDataType type) {
        return dataset.GetRasterBand(1)->RasterIO(way, 0, 0, width, height, cells, width, height, type, 0, 0, nullptr);
    };
    const bool isDone = raster && mask && pass(*raster, GF_Write, heights.cells().data(), GDT_Float32) == CE_None &&
                        pass(*mask, GF_Write, valid.data(), GDT_Byte) == CE_None &&
                        GDALFillNodata(raster->GetRasterBand(1), mask->GetRasterBand(1), distance, 0, 0,
                                       const_cast<char**>(options.data()), nullptr, nullptr) == CE_None &&
                        pass(*raster, GF_Read, heights.cells().data(), GDT_Float32) == CE_None;
    if (!isDone) refuse("cannot fill the holes of the heights (" + messages.text() + ")");
}

struct RasterReader::State {
    std::string name;
    std::string label;
    GDALDatasetUniquePtr dataset;

    GDALDataset& opened(const Messages& messages) {
        if (!dataset) dataset = open(name);
        if (!dataset) refuse("cannot read \"" + label + "\": " + messages.text());
        return *dataset;
    }
    /// Some drivers report damage without failing the call, so the messages count as well.
    void check(CPLErr status, const GridRect& window, const Messages& messages) const {
        if (status == CE_None && !messages.failed()) return;
        refuse("cannot read " + std::to_string(window.width) + " x " + std::to_string(window.height) +
               " pixels at column " + std::to_string(window.x) + ", row " + std::to_string(window.y) + " of \"" +
               label + "\"; the file is cut short or damaged (" + messages.text() + ")");
    }
};

RasterReader::RasterReader(std::string name, std::string label)
    : state_(std::make_unique<State>(State{.name = std::move(name), .label = std::move(label)})) {}
RasterReader::~RasterReader() = default;
RasterReader::RasterReader(RasterReader&&) noexcept = default;

void RasterReader::read(const GridRect& window, GridView<float> out) {
    TERRAY_CHECK(out.size() == (GridSize{window.width, window.height}));
    const Messages messages;
    GDALRasterBand& band = *state_->opened(messages).GetRasterBand(1);
    const auto x = static_cast<int>(window.x);
    const auto y = static_cast<int>(window.y);
    const auto width = static_cast<int>(window.width);
    const auto height = static_cast<int>(window.height);
    const GSpacing lineBytes = out.stride() * static_cast<GSpacing>(sizeof(float));
    state_->check(band.RasterIO(GF_Read, x, y, width, height, out.data(), width, height, GDT_Float32, sizeof(float),
                                lineBytes, nullptr),
                  window, messages);
    if ((band.GetMaskFlags() & GMF_PER_DATASET) == 0) return;  // NaN stands for nodata already
    Grid<uint8_t> mask(out.size());
    state_->check(band.GetMaskBand()->RasterIO(GF_Read, x, y, width, height, mask.view().data(), width, height,
                                               GDT_Byte, 1, mask.width(), nullptr),
                  window, messages);
    for (int64_t row = 0; row < out.height(); ++row)
        for (int64_t column = 0; column < out.width(); ++column)
            if (mask.at(column, row) == 0) out.at(column, row) = kNoHeight;
}

void RasterReader::read(const GridRect& window, GridView<Rgba> out) {
    TERRAY_CHECK(out.size() == (GridSize{window.width, window.height}));
    const Messages messages;
    GDALDataset& dataset = state_->opened(messages);
    const auto width = static_cast<int>(window.width);
    const auto height = static_cast<int>(window.height);
    const GSpacing lineBytes = out.stride() * static_cast<GSpacing>(sizeof(Rgba));
    state_->check(
        dataset.RasterIO(GF_Read, static_cast<int>(window.x), static_cast<int>(window.y), width, height, out.data(),
                         width, height, GDT_Byte, 4, nullptr, sizeof(Rgba), lineBytes, 1, nullptr),
        window, messages);
}

}  // namespace terray::gdal
