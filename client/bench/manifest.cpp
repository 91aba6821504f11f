#include "client/bench/manifest.h"

#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include <sys/resource.h>
#include <sys/utsname.h>

#include "common/checksum.h"
#include "common/error.h"
#include "common/output_file.h"
#include "common/version.h"

namespace terray {
namespace {

/// The text after "<field> :" in a file of /proc; null when there is none.
Json procField(const char* path, const std::string& field) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        const size_t colon = line.find(':');
        if (!line.starts_with(field) || colon == std::string::npos) continue;
        const size_t start = line.find_first_not_of(" \t", colon + 1);
        return start == std::string::npos ? Json() : Json(line.substr(start));
    }
    return {};
}

Json mainMemoryBytes() {
    const Json text = procField("/proc/meminfo", "MemTotal");
    return text.isString() ? Json(1024 * std::strtod(text.string().c_str(), nullptr)) : Json();
}

}  // namespace

Json describeBuild() {
    const BuildInfo& info = buildInfo();
    return Json::Object{{"version", std::string(info.version)},
                        {"commit", std::string(info.commit)},
                        {"modified", info.dirty},
                        {"compiler", std::string(info.compiler)},
                        {"build", std::string(info.build)}};
}

Json describeMachine() {
    utsname system{};
    const bool known = uname(&system) == 0;
    return Json::Object{{"processor", procField("/proc/cpuinfo", "model name")},
                        {"cores", static_cast<int64_t>(std::thread::hardware_concurrency())},
                        {"memoryBytes", mainMemoryBytes()},
                        {"kernel", known ? Json(std::string(system.sysname) + " " + system.release) : Json()},
                        {"architecture", known ? Json(std::string(system.machine)) : Json()}};
}

Json describeGraphics(const GlStrings& strings) {
    return Json::Object{{"vendor", strings.vendor},
                        {"renderer", strings.renderer},
                        {"version", strings.version},
                        {"platform", strings.platform}};
}

Json describeFile(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (!file) throw Error(ExitCode::input, "cannot read " + path.string());
    char sum[16];
    std::snprintf(sum, sizeof(sum), "%08x", crc32c(std::as_bytes(std::span(text))));
    return Json::Object{{"path", path.string()}, {"crc32c", std::string(sum)}};
}

Json describeRun(const RunDescription& run, const GlStrings& graphics, const std::string& started) {
    Json flightFile = describeFile(run.flightFile);
    flightFile.set("name", run.flight.name);
    flightFile.set("seconds", run.flight.seconds());
    return Json::Object{
        {"program", run.program},
        {"build", describeBuild()},
        {"machine", describeMachine()},
        {"graphics", describeGraphics(graphics)},
        {"dataset", Json::Object{{"path", run.dataset.string()}, {"contentHash", run.source.contentHash()}}},
        {"flight", std::move(flightFile)},
        {"protocol", run.protocol},
        {"options", run.options},
        {"started", started}};
}

std::string utcNow() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

uint64_t peakResidentBytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024 * static_cast<uint64_t>(usage.ru_maxrss);  // Linux counts it in KiB
}

void writeJson(const std::filesystem::path& path, const Json& json) {
    const std::string text = json.dump() + "\n";
    writeWholeFile(path, std::as_bytes(std::span(text)));
}

}  // namespace terray
