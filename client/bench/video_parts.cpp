#include "client/bench/video_parts.h"

#include <cstdio>
#include <fstream>
#include <span>
#include <system_error>

#include "client/bench/manifest.h"
#include "common/error.h"
#include "common/output_file.h"

namespace terray {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDescription = "video.json";

Error refusal(const fs::path& path, const std::string& why) {
    return {ExitCode::output,
            "cannot go on with " + path.string() + ": " + why + "; leave --resume away to begin anew"};
}

Json readDescription(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw refusal(path, "it cannot be opened");
    const auto json = Json::parse(std::string{std::istreambuf_iterator<char>(file), {}});
    if (!json) throw refusal(path, json.failure().message);
    return *json;
}

/// Throws where a member of what is wanted is not what the parts were made of.
void requireSame(const Json& wanted, const Json& found, const fs::path& directory) {
    for (const auto& [name, value] : wanted.object()) {
        const Json* before = found.find(name);
        if (before != nullptr && *before == value) continue;
        if (before != nullptr && before->isObject() && value.isObject()) {
            requireSame(value, *before, directory);
            continue;
        }
        throw Error(ExitCode::usage, "cannot go on with " + directory.string() + ": its " + name + " was " +
                                         (before == nullptr ? "not told" : before->dump(0)) + ", now it is " +
                                         value.dump(0) + "; give what it began with, or leave --resume away");
    }
}

}  // namespace

VideoParts::VideoParts(const fs::path& video, const Json& description, bool resume)
    : video_(video), directory_(video.string() + ".parts"), description_(description) {
    std::error_code failure;
    if (resume && fs::exists(directory_ / kDescription, failure)) {
        const Json found = readDescription(directory_ / kDescription);
        requireSame(description, found, directory_);
        const auto launch = found.stringAt("launch");
        if (launch) launch_ = *launch;
        return;
    }
    fs::remove_all(directory_, failure);
    fs::create_directory(directory_, failure);
    if (failure)
        throw Error(ExitCode::output, "cannot make the directory " + directory_.string() + ": " + failure.message());
}

void VideoParts::setLaunch(const std::string& launch) {
    launch_ = launch;
    Json json = description_;
    json.set("launch", launch);
    writeJson(directory_ / kDescription, json);
}

fs::path VideoParts::segment(size_t segment) const {
    char name[64];
    std::snprintf(name, sizeof(name), "segment_%05zu%s", segment, video_.extension().c_str());
    return directory_ / name;
}

fs::path VideoParts::unfinished(size_t segment) const {
    return directory_ / ("unfinished_" + this->segment(segment).filename().string());
}

void VideoParts::publish(size_t segment) const {
    std::error_code failure;
    fs::rename(unfinished(segment), this->segment(segment), failure);
    if (failure)
        throw Error(ExitCode::output, "cannot rename " + unfinished(segment).string() + ": " + failure.message());
}

bool VideoParts::has(size_t segment) const {
    return fs::exists(this->segment(segment));
}

fs::path VideoParts::list(size_t segments) const {
    std::string text;
    for (size_t n = 0; n < segments; ++n) text += "file '" + segment(n).filename().string() + "'\n";
    const fs::path path = directory_ / "segments.txt";
    writeWholeFile(path, std::as_bytes(std::span(text)));
    return path;
}

fs::path VideoParts::whole() const {
    return directory_ / ("whole" + video_.extension().string());
}

void VideoParts::finish() const {
    std::error_code failure;
    fs::rename(whole(), video_, failure);
    if (failure)
        throw Error(ExitCode::output,
                    "cannot rename " + whole().string() + " to " + video_.string() + ": " + failure.message());
    fs::remove_all(directory_, failure);
}

}  // namespace terray
