#include "client/bench/run_directory.h"

#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "common/error.h"

namespace terray {
namespace {

namespace fs = std::filesystem;

void create(const fs::path& path) {
    std::error_code failure;
    fs::create_directories(path, failure);
    if (!failure && !fs::is_directory(path)) failure = std::make_error_code(std::errc::not_a_directory);
    if (failure) throw Error(ExitCode::output, "cannot make the directory " + path.string() + ": " + failure.message());
}

}  // namespace

RunDirectory::RunDirectory(fs::path path, bool withFrames, bool force) : path_(std::move(path)), existed_(false) {
    std::error_code ignored;  // what cannot be looked at is found out by create()
    for (const fs::path& file : {table(), summary(), manifest(), frames()})
        if (!force && fs::exists(file, ignored))
            throw Error(ExitCode::output, path_.string() + " holds an earlier run, found " + file.string() +
                                              " (give --force to replace it)");
    existed_ = fs::exists(path_, ignored);
    create(path_);
    if (force) removeRun();
    if (withFrames) create(frames());
}

RunDirectory::~RunDirectory() {
    if (kept_) return;
    removeRun();
    std::error_code notEmpty;  // then it stays
    if (!existed_) fs::remove(path_, notEmpty);
}

void RunDirectory::removeRun() const {
    std::error_code failure;
    for (const fs::path& file : {table(), summary(), manifest()}) fs::remove(file, failure);
    if (!fs::is_directory(frames(), failure)) return;
    std::error_code unreadable;
    for (fs::directory_iterator entry(frames(), unreadable), end; !unreadable && entry != end;
         entry.increment(unreadable)) {
        const std::string name = entry->path().filename().string();
        if (name.starts_with("frame_") && name.ends_with(".png")) fs::remove(entry->path(), failure);
    }
    fs::remove(frames(), failure);
}

fs::path RunDirectory::table() const {
    return path_ / "frames.csv";
}

fs::path RunDirectory::summary() const {
    return path_ / "summary.json";
}

fs::path RunDirectory::manifest() const {
    return path_ / "manifest.json";
}

fs::path RunDirectory::frames() const {
    return path_ / "frames";
}

fs::path RunDirectory::frame(size_t index) const {
    char name[64];
    std::snprintf(name, sizeof(name), "frame_%05zu.png", index);
    return frames() / name;
}

}  // namespace terray
