#include "client/bench/run_directory.h"

#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/error.h"

namespace terray {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMaps = "maps";

void create(const fs::path& path) {
    std::error_code failure;
    fs::create_directories(path, failure);
    if (!failure && !fs::is_directory(path)) failure = std::make_error_code(std::errc::not_a_directory);
    if (failure) throw Error(ExitCode::output, "cannot make the directory " + path.string() + ": " + failure.message());
}

/// Removes a folder's pictures whose names begin so, and the folder if nothing else lies in it.
void removeFolder(const fs::path& folder, std::string_view prefix) {
    std::error_code failure;
    if (!fs::is_directory(folder, failure)) return;
    std::error_code unreadable;
    for (fs::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
         entry.increment(unreadable)) {
        const fs::path& file = entry->path();
        const bool isPicture = file.extension() == ".png" || file.extension() == ".exr";
        if (isPicture && file.filename().string().starts_with(prefix)) fs::remove(file, failure);
    }
    fs::remove(folder, failure);
}

}  // namespace

RunDirectory::RunDirectory(fs::path path, bool withFrames, bool force) : path_(std::move(path)), existed_(false) {
    std::error_code ignored;  // what cannot be looked at is found out by create()
    for (const fs::path& file :
         {table(), steps(), errors(), split(), stability(), summary(), manifest(), frames(), path_ / kMaps})
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
    for (const fs::path& file : {table(), steps(), errors(), split(), stability(), summary(), manifest()})
        fs::remove(file, failure);
    removeFolder(frames(), "frame_");
    removeFolder(path_ / kMaps, "map_");
}

fs::path RunDirectory::table() const {
    return path_ / "frames.csv";
}

fs::path RunDirectory::errors() const {
    return path_ / "errors.csv";
}

fs::path RunDirectory::split() const {
    return path_ / "split.csv";
}

fs::path RunDirectory::stability() const {
    return path_ / "stability.csv";
}

fs::path RunDirectory::maps() const {
    create(path_ / kMaps);
    return path_ / kMaps;
}

fs::path RunDirectory::steps() const {
    return path_ / "steps.csv";
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
