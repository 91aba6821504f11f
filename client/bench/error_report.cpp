#include "client/bench/error_report.h"

#include <cctype>
#include <cstdio>
#include <limits>

#include "common/check.h"
#include "common/percentile.h"
#if TERRAY_WITH_OUTPUT
#include "client/output/picture.h"
#endif

namespace terray {
namespace {

Json spreadJson(const Spread& spread) {
    return Json::Object{{"mean", spread.mean},
                        {"median", spread.median},
                        {"p95", spread.p95},
                        {"p99", spread.p99},
                        {"max", spread.max}};
}

Json countJson(uint64_t count, uint64_t of) {
    return Json::Object{{"sum", count}, {"share", static_cast<double>(count) / static_cast<double>(of)}};
}

double medianOf(const std::vector<double>& sorted) {
    return percentile<double>(sorted, 50);
}

/// A column of errors.csv.
struct Column {
    std::string name;
    std::string value;
};

std::string text(double value) {
    char buffer[64];
    std::snprintf(buffer, sizeof(buffer), "%.6g", value);
    return buffer;
}

void addSpread(std::vector<Column>& columns, const std::string& name, const Spread& spread) {
    columns.push_back({name + "_mean", text(spread.mean)});
    columns.push_back({name + "_median", text(spread.median)});
    columns.push_back({name + "_p95", text(spread.p95)});
    columns.push_back({name + "_p99", text(spread.p99)});
    columns.push_back({name + "_max", text(spread.max)});
}

std::vector<Column> columnsOf(const ErrorResult& result) {
    std::vector<Column> columns{{"curve", "\"" + result.curve + "\""},
                                {"setting", "\"" + result.name + "\""},
                                {"frame_ms_median", text(medianOf(result.frameMs))},
                                {"frame_ms_min", text(result.frameMs.front())},
                                {"frame_ms_max", text(result.frameMs.back())}};
    addSpread(columns, "error_px", result.errorPixels);
    addSpread(columns, "depth_m", result.depthMetres);
    addSpread(columns, "depth_relative", result.depthRelative);
    columns.push_back({"pixels", std::to_string(result.pixels)});
    columns.push_back({"see_through", std::to_string(result.seeThrough)});
    columns.push_back({"covers_sky", std::to_string(result.coversSky)});
    columns.push_back({"flip_mean", text(result.flip.mean)});
    columns.push_back({"flip_max", text(result.flip.max)});
    columns.push_back({"psnr_db", result.psnr ? text(*result.psnr) : ""});
    columns.push_back({"popping_mean", text(result.popping.mean)});
    columns.push_back({"popping_max", text(result.popping.max)});
    columns.push_back({"nodes", std::to_string(result.nodes)});
    columns.push_back({"lacking", std::to_string(result.lacking)});
    columns.push_back({"gpu_bytes", std::to_string(result.gpuBytes)});
    columns.push_back({"pyramid_bytes", std::to_string(result.pyramidBytes)});
    columns.push_back({"method_bytes", std::to_string(result.methodBytes)});
    columns.push_back({"triangles", text(result.triangles)});
    columns.push_back({"triangles_per_s", text(result.trianglesPerSecond)});
    columns.push_back({"bytes_per_triangle", text(result.bytesPerTriangle)});
    columns.push_back({"pyramid_ms", text(result.pyramidMs)});
    columns.push_back({"prepare_ms", text(result.prepareMs)});
    return columns;
}

std::vector<Column> columnsOf(const CauseResult& result) {
    std::vector<Column> columns{{"cause", "\"" + result.cause + "\""}};
    const GroundError ground = result.ground.value_or(GroundError());
    addSpread(columns, "error_px", ground.errorPixels);
    addSpread(columns, "depth_m", ground.depthMetres);
    columns.push_back({"pixels", std::to_string(ground.pixels)});
    columns.push_back({"see_through", std::to_string(ground.seeThrough)});
    columns.push_back({"covers_sky", std::to_string(ground.coversSky)});
    if (!result.ground)
        for (size_t n = 1; n < columns.size(); ++n) columns[n].value.clear();
    columns.push_back({"flip_mean", result.flip ? text(*result.flip) : ""});
    columns.push_back({"psnr_db", result.psnr ? text(*result.psnr) : ""});
    return columns;
}

Json valueJson(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

template <class Row>
std::string tableOf(const std::vector<Row>& results) {
    std::string table;
    for (const Row& result : results) {
        const std::vector<Column> columns = columnsOf(result);
        const auto line = [&](auto field) {
            for (size_t n = 0; n < columns.size(); ++n) table += (n > 0 ? "," : "") + columns[n].*field;
            table += '\n';
        };
        if (table.empty()) line(&Column::name);
        line(&Column::value);
    }
    return table;
}

}  // namespace

std::string errorTable(const std::vector<ErrorResult>& results) {
    return tableOf(results);
}

std::string splitTable(const std::vector<CauseResult>& results) {
    return tableOf(results);
}

Json toJson(const CauseResult& result) {
    Json columns = Json::Object{};
    if (result.ground) {
        const GroundError& ground = *result.ground;
        columns = Json::Object{{"error_px", spreadJson(ground.errorPixels)},
                               {"depth_m", spreadJson(ground.depthMetres)},
                               {"see_through", countJson(ground.seeThrough, ground.pixels)},
                               {"covers_sky", countJson(ground.coversSky, ground.pixels)}};
    }
    columns.set("flip", Json::Object{{"mean", valueJson(result.flip)}});
    columns.set("psnr_db", Json::Object{{"mean", valueJson(result.psnr)}});
    return Json::Object{{"name", result.cause}, {"columns", std::move(columns)}};
}

std::string lineOf(const CauseResult& result) {
    char line[256];
    std::string told;
    if (result.ground) {
        const Spread& error = result.ground->errorPixels;
        std::snprintf(line, sizeof(line), "; error %.3g px median, %.3g p95, %.3g p99, %.3g max; %llu of %llu wrong",
                      error.median, error.p95, error.p99, error.max,
                      static_cast<unsigned long long>(result.ground->seeThrough + result.ground->coversSky),
                      static_cast<unsigned long long>(result.ground->pixels));
        told += line;
    }
    if (result.flip) {
        std::snprintf(line, sizeof(line), "; FLIP %.4f", *result.flip);
        told += line;
    }
    if (result.psnr) {
        std::snprintf(line, sizeof(line), "; PSNR %.1f dB", *result.psnr);
        told += line;
    }
    return result.cause + told;
}

Json toJson(const ErrorResult& result) {
    return Json::Object{
        {"curve", result.curve},
        {"name", result.name},
        {"columns", Json::Object{{"frame_ms", Json::Object{{"median", medianOf(result.frameMs)},
                                                           {"min", result.frameMs.front()},
                                                           {"max", result.frameMs.back()},
                                                           {"repeats", uint64_t{result.frameMs.size()}}}},
                                 {"error_px", spreadJson(result.errorPixels)},
                                 {"depth_m", spreadJson(result.depthMetres)},
                                 {"depth_relative", spreadJson(result.depthRelative)},
                                 {"see_through", countJson(result.seeThrough, result.pixels)},
                                 {"covers_sky", countJson(result.coversSky, result.pixels)},
                                 {"flip", spreadJson(result.flip)},
                                 {"psnr_db", Json::Object{{"mean", valueJson(result.psnr)}}},
                                 {"popping", spreadJson(result.popping)},
                                 {"nodes", Json::Object{{"sum", result.nodes}}},
                                 {"lacking", Json::Object{{"sum", result.lacking}}},
                                 {"gpu_bytes", Json::Object{{"last", result.gpuBytes}}},
                                 {"pyramid_bytes", Json::Object{{"last", result.pyramidBytes}}},
                                 {"method_bytes", Json::Object{{"last", result.methodBytes}}},
                                 {"triangles", Json::Object{{"mean", result.triangles}}},
                                 {"triangles_per_s", Json::Object{{"mean", result.trianglesPerSecond}}},
                                 {"bytes_per_triangle", Json::Object{{"last", result.bytesPerTriangle}}},
                                 {"pyramid_ms", Json::Object{{"mean", result.pyramidMs}}},
                                 {"prepare_ms", Json::Object{{"mean", result.prepareMs}}}}},
        {"pixels", result.pixels}};
}

std::string lineOf(const ErrorResult& result) {
    char line[512];
    std::snprintf(
        line, sizeof(line),
        "%-20s %8.2f ms (%.2f .. %.2f); error %.3f px median, %.3f p95, %.3f p99, %.2f max; see-through %llu, "
        "covers sky %llu of %llu; FLIP %.4f, popping %.4f%s",
        result.name.c_str(), medianOf(result.frameMs), result.frameMs.front(), result.frameMs.back(),
        result.errorPixels.median, result.errorPixels.p95, result.errorPixels.p99, result.errorPixels.max,
        static_cast<unsigned long long>(result.seeThrough), static_cast<unsigned long long>(result.coversSky),
        static_cast<unsigned long long>(result.pixels), result.flip.mean, result.popping.max,
        result.lacking > 0 ? "; tiles lack: give more --gpu-memory" : "");
    return line;
}

#if TERRAY_WITH_OUTPUT

void writeErrorMaps(const std::filesystem::path& folder, const std::string& setting, int frame, GridSize size,
                    const std::vector<PixelError>& errors) {
    TERRAY_CHECK_OP(static_cast<size_t>(size.count()), ==, errors.size());
    constexpr Rgba kSeeThrough{255, 0, 255, 255};
    constexpr Rgba kCoversSky{0, 80, 255, 255};
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    Grid<Rgba> picture(size, {0, 0, 0, 255});
    std::vector<NamedChannel> channels{{"error.pixels", Grid<float>(size, kNone)},
                                       {"depth.metres", Grid<float>(size, kNone)}};
    for (size_t n = 0; n < errors.size(); ++n) {
        const PixelError& error = errors[n];
        if (error.kind == PixelError::Kind::seeThrough) picture.cells()[n] = kSeeThrough;
        if (error.kind == PixelError::Kind::coversSky) picture.cells()[n] = kCoversSky;
        if (error.kind != PixelError::Kind::ground) continue;
        picture.cells()[n] = heatColour(error.pixels);
        channels[0].values.cells()[n] = error.pixels;
        channels[1].values.cells()[n] = error.depthMetres;
    }
    std::string name = setting;
    for (char& letter : name)
        if (std::isalnum(static_cast<unsigned char>(letter)) == 0 && letter != '.') letter = '_';
    char number[16];
    std::snprintf(number, sizeof(number), "_%05d", frame);
    const std::string stem = "map_" + name + number;
    writePng(folder / (stem + ".png"), picture.view());
    writeExr(folder / (stem + ".exr"), channels);
}

#else

void writeErrorMaps(const std::filesystem::path&, const std::string&, int, GridSize, const std::vector<PixelError>&) {
    TERRAY_CHECK(TERRAY_WITH_OUTPUT != 0);
}

#endif

}  // namespace terray
