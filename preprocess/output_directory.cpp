#include "preprocess/output_directory.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "common/dataset_metadata.h"
#include "common/error.h"

namespace terray {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLockName = "lock";
constexpr const char* kWorkName = "work";

[[noreturn]] void fail(const std::string& message) {
    throw Error(ExitCode::output, message);
}

/// OUT with its parent, absolute, without a trailing slash.
fs::path normalised(const fs::path& out) {
    if (out.empty()) throw Error(ExitCode::usage, "--out must name a directory; found an empty name");
    const fs::path whole = fs::absolute(out).lexically_normal();
    return whole.has_filename() ? whole : whole.parent_path();
}

fs::path beside(const fs::path& out, const char* suffix) {
    fs::path path = out;
    path += suffix;
    return path;
}

/// What forbids deleting `directory` as an old dataset; empty when nothing does. An empty directory may go.
std::string foreignContent(const fs::path& directory) {
    if (fs::is_symlink(directory) || !fs::is_directory(directory)) return "it is not a directory";
    bool empty = true;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
        empty = false;
        const std::string name = entry.path().filename().string();
        if (name != kHeightsFile && name != kImageryFile) return "it also holds " + name;
    }
    if (empty) return "";
    std::array<char, 7> magic{};
    std::ifstream(directory / kHeightsFile, std::ios::binary).read(magic.data(), magic.size());
    if (std::string(magic.data(), magic.size()) != "PMTiles")
        return "its " + std::string(kHeightsFile) + " is missing, or no PMTiles archive";
    return "";
}

void refuseExisting(const fs::path& out, bool replace) {
    std::error_code ignored;
    if (fs::symlink_status(out, ignored).type() == fs::file_type::not_found) return;
    if (!replace) fail("output " + out.string() + " exists already; give another --out, or --force to replace it");
    const std::string reason = foreignContent(out);
    if (!reason.empty())
        fail("output " + out.string() + " exists and is not a Terray dataset alone (" + reason +
             "), so --force will not delete it; give another --out");
}

/// Takes the lock of OUT.partial. @return its descriptor, or -1 when a live run holds it
int lockDirectory(const fs::path& partial) {
    const int descriptor = ::open((partial / kLockName).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) fail("cannot write in " + partial.string() + ": " + std::strerror(errno));
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
    ::close(descriptor);
    return -1;
}

/// Removes an OUT.partial that a killed run left.
void removeAbandoned(const fs::path& partial) {
    std::error_code ignored;
    if (fs::symlink_status(partial, ignored).type() == fs::file_type::not_found) return;
    if (!fs::is_directory(partial) || !fs::exists(partial / kLockName))
        fail(partial.string() + " is in the way and was not made by terray-preprocess; move it, or give another --out");
    const int descriptor = lockDirectory(partial);
    if (descriptor < 0) fail("another terray-preprocess is writing " + partial.string() + "; wait for it to end");
    fs::remove_all(partial);
    ::close(descriptor);
}

void moveDirectory(const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::rename(from, to, error);
    if (error) fail("cannot rename " + from.string() + " to " + to.string() + ": " + error.message());
}

/// Makes renames in a directory survive a power cut.
void syncDirectory(const fs::path& directory) {
    const int descriptor = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

}  // namespace

void OutputDirectory::check(const fs::path& out, bool replace) {
    const fs::path whole = normalised(out);
    if (!fs::is_directory(whole.parent_path()))
        fail("cannot make output " + whole.string() + ": " + whole.parent_path().string() + " is not a directory");
    refuseExisting(whole, replace);
}

OutputDirectory::OutputDirectory(const fs::path& out, bool replace)
    : out_(normalised(out)), partial_(beside(out_, ".partial")), replace_(replace) {
    check(out_, replace_);
    removeAbandoned(partial_);
    std::error_code error;
    fs::create_directory(partial_, error);
    if (error) fail("cannot make output directory " + partial_.string() + ": " + error.message());
    try {
        lock_ = lockDirectory(partial_);
        if (lock_ < 0) fail("another terray-preprocess is writing " + partial_.string() + "; wait for it to end");
        fs::create_directory(workDirectory(), error);
        if (error) fail("cannot make " + workDirectory().string() + ": " + error.message());
    } catch (...) {
        fs::remove_all(partial_, error);
        throw;
    }
}

OutputDirectory::~OutputDirectory() {
    std::error_code ignored;
    if (!partial_.empty()) fs::remove_all(partial_, ignored);
    if (lock_ >= 0) ::close(lock_);
}

fs::path OutputDirectory::workDirectory() const {
    return partial_ / kWorkName;
}

void OutputDirectory::commit() {
    fs::remove_all(workDirectory());
    fs::remove(partial_ / kLockName);
    syncDirectory(partial_);

    // What is at OUT now may not be what was there when the run began.
    refuseExisting(out_, replace_);
    const fs::path old = beside(out_, ".replaced");
    const bool replaces = fs::exists(out_);
    if (replaces) moveDirectory(out_, old);
    try {
        moveDirectory(partial_, out_);
    } catch (const Error&) {
        if (replaces) moveDirectory(old, out_);
        throw;
    }
    partial_.clear();
    syncDirectory(out_.parent_path());
    if (replaces) fs::remove_all(old);
}

}  // namespace terray
