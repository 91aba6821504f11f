#include "client/bench/frame_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>
#include <span>

#include "common/percentile.h"

namespace terray {
namespace {

using Value = std::optional<double>;

/// A column of frames.csv.
struct Column {
    std::string name;
    int decimals = 0;
    bool measured = true;  ///< summary.json has it: not the index, the clock and the camera
    std::function<Value(const FrameMeasurement&)> value;
};

template <class Number>
Value count(Number number) {
    return static_cast<double>(number);
}

void addCamera(std::vector<Column>& columns) {
    const auto add = [&](const char* name, int decimals, std::function<Value(const FrameMeasurement&)> value) {
        columns.push_back({name, decimals, false, std::move(value)});
    };
    add("frame", 0, [](const auto& f) { return count(f.index); });
    add("seconds", 6, [](const auto& f) { return f.seconds; });
    add("camera_x", 3, [](const auto& f) { return f.camera.position.x; });
    add("camera_y", 3, [](const auto& f) { return f.camera.position.y; });
    add("camera_z", 3, [](const auto& f) { return f.camera.position.z; });
    add("heading_deg", 4, [](const auto& f) { return degreesFromRadians(f.camera.heading); });
    add("pitch_deg", 4, [](const auto& f) { return degreesFromRadians(f.camera.pitch); });
    add("fov_deg", 4, [](const auto& f) { return degreesFromRadians(f.camera.verticalFov); });
}

void addTimes(std::vector<Column>& columns) {
    const auto add = [&](const std::string& name, std::function<Value(const FrameMeasurement&)> value) {
        columns.push_back({name, 3, true, std::move(value)});
    };
    add("cpu_ms", [](const auto& f) { return f.report.cpuMs; });
    for (size_t pass = 0; pass < kGpuPasses; ++pass)
        add("gpu_" + std::string(name(static_cast<GpuPass>(pass))) + "_ms",
            [pass](const auto& f) { return f.report.gpuMs[pass]; });
    add("gpu_ms", [](const auto& f) { return std::accumulate(f.report.gpuMs.begin(), f.report.gpuMs.end(), 0.0); });
    add("frame_ms", [](const auto& f) { return f.report.frameMs; });
    add("wait_ms", [](const auto& f) { return f.report.waitMs; });
}

void addTiles(std::vector<Column>& columns) {
    const auto add = [&](const char* name, std::function<Value(const FrameMeasurement&)> value) {
        columns.push_back({name, 0, true, std::move(value)});
    };
    const auto addPaged = [&](const char* name, uint64_t PagerStatistics::*counter) {
        add(name, [counter](const auto& f) { return count(f.report.pager.*counter - f.pagerBefore.*counter); });
    };
    add("nodes", [](const auto& f) { return count(f.report.nodes); });
    add("casters", [](const auto& f) { return count(f.report.casters); });
    add("bilinear_nodes", [](const auto& f) { return count(f.report.bilinearNodes); });
    add("rasterised_nodes", [](const auto& f) { return count(f.report.rasterisedNodes); });
    add("triangles", [](const auto& f) { return count(f.report.triangles); });
    add("stand_ins", [](const auto& f) { return count(f.report.standIns); });
    add("wanted", [](const auto& f) { return count(f.report.wanted); });
    columns.push_back({"heights_coarsening", 3, true, [](const auto& f) { return f.report.coarsening.heights; }});
    columns.push_back({"imagery_coarsening", 3, true, [](const auto& f) { return f.report.coarsening.imagery; }});
    add("heights_resident", [](const auto& f) { return count(f.report.residentHeights); });
    add("imagery_resident", [](const auto& f) { return count(f.report.residentImagery); });
    addPaged("requested", &PagerStatistics::requested);
    add("uploaded", [](const auto& f) { return count(f.report.uploadedTiles); });
    add("edited", [](const auto& f) { return count(f.report.editedTiles); });
    addPaged("read_bytes", &PagerStatistics::bytesRead);
    add("received_bytes",
        [](const auto& f) { return count(f.report.pager.reads.receivedBytes - f.pagerBefore.reads.receivedBytes); });
    add("uploaded_bytes", [](const auto& f) { return count(f.report.uploadedBytes); });
    add("host_bytes", [](const auto& f) { return count(f.report.hostBytes); });
    add("gpu_heights_bytes", [](const auto& f) { return count(f.report.gpuTiles.heights); });
    add("gpu_maxima_bytes", [](const auto& f) { return count(f.report.gpuTiles.maxima); });
    add("gpu_method_bytes", [](const auto& f) { return count(f.report.gpuTiles.method); });
    add("gpu_imagery_bytes", [](const auto& f) { return count(f.report.gpuTiles.imagery); });
    add("gpu_targets_bytes", [](const auto& f) { return count(f.report.gpuTargets); });
    add("gpu_buffers_bytes", [](const auto& f) { return count(f.report.gpuBuffers); });
}

void addRays(std::vector<Column>& columns) {
    const auto add = [&](const char* name, auto field, int decimals = 0) {
        columns.push_back({name, decimals, true,
                           [field](const FrameMeasurement& f) { return f.rays ? count((*f.rays).*field) : Value(); }});
    };
    add("steps_mean", &RayStatistics::stepsMean, 3);
    add("steps_p99", &RayStatistics::stepsP99);
    add("steps_max", &RayStatistics::stepsMax);
    add("rays", &RayStatistics::rays);
    add("rays_marched", &RayStatistics::marched);
    add("rays_hit", &RayStatistics::hit);
    add("rays_sky", &RayStatistics::sky);
    add("rays_out_of_steps", &RayStatistics::outOfSteps);
}

const std::vector<Column>& columns() {
    static const std::vector<Column> kColumns = [] {
        std::vector<Column> all;
        addCamera(all);
        addTimes(all);
        addTiles(all);
        addRays(all);
        return all;
    }();
    return kColumns;
}

std::string fixed(double value, int decimals) {
    char text[64];
    std::snprintf(text, sizeof(text), "%.*f", decimals, value);
    return text;
}

Json summaryOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    return Json::Object{{"count", uint64_t{values.size()}},
                        {"median", percentile<double>(values, 50)},
                        {"p95", percentile<double>(values, 95)},
                        {"p99", percentile<double>(values, 99)},
                        {"mean", sum / static_cast<double>(values.size())},
                        {"min", values.front()},
                        {"max", values.back()},
                        {"sum", sum}};
}

}  // namespace

FrameTable::FrameTable(const std::filesystem::path& path)
    : path_(path), file_(path.string() + ".partial"), values_(columns().size()) {
    write(header());
}

std::string FrameTable::header() {
    std::string line;
    for (const Column& column : columns()) line += (line.empty() ? "" : ",") + column.name;
    return line;
}

void FrameTable::add(const FrameMeasurement& frame) {
    std::string line;
    for (size_t n = 0; n < columns().size(); ++n) {
        const Column& column = columns()[n];
        const Value value = column.value(frame);
        if (n > 0) line += ',';
        if (!value) continue;
        line += fixed(*value, column.decimals);
        values_[n].push_back(*value);
    }
    write(line);
}

void FrameTable::write(const std::string& line) {
    const std::string whole = line + '\n';
    file_.write(std::as_bytes(std::span(whole)));
}

void FrameTable::finish() {
    file_.publish(path_);
}

Json FrameTable::summary() const {
    Json all = Json::Object{};
    for (size_t n = 0; n < columns().size(); ++n)
        if (columns()[n].measured && !values_[n].empty()) all.set(columns()[n].name, summaryOf(values_[n]));
    return all;
}

const std::vector<double>& FrameTable::values(const std::string& column) const {
    const auto found =
        std::find_if(columns().begin(), columns().end(), [&](const Column& c) { return c.name == column; });
    TERRAY_CHECK(found != columns().end());
    return values_[static_cast<size_t>(found - columns().begin())];
}

double FrameTable::median(const std::string& column) const {
    std::vector<double> sorted = values(column);
    if (sorted.empty()) return 0;
    std::sort(sorted.begin(), sorted.end());
    return percentile<double>(sorted, 50);
}

double FrameTable::sum(const std::string& column) const {
    const std::vector<double>& all = values(column);
    return std::accumulate(all.begin(), all.end(), 0.0);
}

double FrameTable::max(const std::string& column) const {
    const std::vector<double>& all = values(column);
    return all.empty() ? 0 : *std::max_element(all.begin(), all.end());
}

}  // namespace terray
