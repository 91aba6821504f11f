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
constexpr const char* kDatasetName = "dataset";
constexpr const char* kJournalName = "journal";

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

/// What `directory` holds beside the files of a dataset, if it has these; empty when nothing.
std::string strangerIn(const fs::path& directory) {
    if (fs::is_symlink(directory) || !fs::is_directory(directory)) return "it is not a directory";
    for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
        const std::string name = entry.path().filename().string();
        if (name != kHeightsFile && name != kImageryFile) return "it also holds " + name;
    }
    return "";
}

/// What forbids deleting `directory` as an old dataset; empty when nothing does. An empty directory may go.
std::string foreignContent(const fs::path& directory) {
    const std::string stranger = strangerIn(directory);
    if (!stranger.empty() || fs::is_empty(directory)) return stranger;
    std::array<char, 7> magic{};
    std::ifstream(directory / kHeightsFile, std::ios::binary).read(magic.data(), magic.size());
    if (std::string(magic.data(), magic.size()) != "PMTiles")
        return "its " + std::string(kHeightsFile) + " is missing, or no PMTiles archive";
    return "";
}

bool isThere(const fs::path& path) {
    std::error_code ignored;
    return fs::symlink_status(path, ignored).type() != fs::file_type::not_found;
}

/// Whether OUT has its name already, so that a resumed build has nothing left to do but to make sure that it is the
/// same: the run that gave it that was killed at its last steps, or came to its end. Of an OUT that is to be replaced
/// only the journal can tell: the dataset is made before it, so a journal without a dataset beside it says so.
bool isPublishedAt(const fs::path& out, const fs::path& partial, const OutputPermissions& permissions) {
    if (!permissions.resume || !isThere(out) || isThere(partial / kDatasetName)) return false;
    return isThere(partial / kJournalName) || !permissions.replace;
}

void refuseExisting(const fs::path& out, bool replace) {
    if (!isThere(out)) return;
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

/// Refuses an OUT.partial that is not what a run leaves.
void requireOurs(const fs::path& partial) {
    if (!isThere(partial)) return;
    if (!fs::is_directory(partial) || (!fs::is_empty(partial) && !isThere(partial / kLockName)))
        fail(partial.string() + " is in the way and was not made by terray-preprocess; move it, or give another --out");
}

void makeDirectory(const fs::path& path) {
    std::error_code error;
    fs::create_directory(path, error);
    if (error) fail("cannot make output directory " + path.string() + ": " + error.message());
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

/// Removes all but the lock, the journal last, which tells a later run how far this one got.
void emptyPartial(const fs::path& partial) {
    fs::remove_all(partial / kDatasetName);
    fs::remove_all(partial / kWorkName);
    fs::remove(partial / kJournalName);
}

/// Removes an OUT.partial that nobody will go on with. What cannot be removed, since another process of the build still
/// has it open on a network's disk, keeps the lock beside it, by which the next run knows whose it is.
void removeUnused(const fs::path& partial) noexcept {
    try {
        emptyPartial(partial);
        fs::remove(partial / kLockName);
        std::error_code stillUsed;
        if (!fs::remove(partial, stillUsed)) std::ofstream(partial / kLockName);
    } catch (const fs::filesystem_error&) {
        // It stays, with its lock.
    }
}

}  // namespace

void OutputDirectory::check(const fs::path& out, const OutputPermissions& permissions) {
    const fs::path whole = normalised(out);
    if (!fs::is_directory(whole.parent_path()))
        fail("cannot make output " + whole.string() + ": " + whole.parent_path().string() + " is not a directory");
    if (!isPublishedAt(whole, beside(whole, ".partial"), permissions)) refuseExisting(whole, permissions.replace);
}

OutputDirectory::OutputDirectory(const fs::path& out, const OutputPermissions& permissions)
    : out_(normalised(out)), partial_(beside(out_, ".partial")), permissions_(permissions) {
    check(out_, permissions);
    requireOurs(partial_);
    const bool wasThere = isThere(partial_);
    if (!wasThere) makeDirectory(partial_);
    try {
        lock_ = lockDirectory(partial_);
        if (lock_ < 0) fail("another terray-preprocess is writing " + partial_.string() + "; wait for it to end");
        kept_ = permissions.resume && isThere(journal());
        published_ = isPublishedAt(out_, partial_, permissions);
        if (published_) return;
        if (!kept_) emptyPartial(partial_);
        makeDirectory(directory());
        makeDirectory(workDirectory());
        syncDirectory(partial_);
    } catch (...) {
        std::error_code ignored;
        if (!wasThere) fs::remove_all(partial_, ignored);
        if (lock_ >= 0) ::close(lock_);
        throw;
    }
}

OutputDirectory::~OutputDirectory() {
    if (!partial_.empty() && !kept_) removeUnused(partial_);
    if (lock_ >= 0) ::close(lock_);
}

fs::path OutputDirectory::directory() const {
    return partial_ / kDatasetName;
}

fs::path OutputDirectory::workDirectory() const {
    return partial_ / kWorkName;
}

fs::path OutputDirectory::journal() const {
    return partial_ / kJournalName;
}

void OutputDirectory::publish() {
    syncDirectory(directory());
    // What is at OUT now may not be what was there when the run began.
    refuseExisting(out_, permissions_.replace);
    const fs::path old = beside(out_, ".replaced");
    const bool replaces = isThere(out_);
    if (replaces) moveDirectory(out_, old);
    try {
        moveDirectory(directory(), out_);
    } catch (const Error&) {
        if (replaces) moveDirectory(old, out_);
        throw;
    }
    syncDirectory(out_.parent_path());
    syncDirectory(partial_);
    published_ = true;
}

void OutputDirectory::commit() {
    if (!published_) publish();
    // A run that was killed here may have left the old dataset, or half of it, to this one.
    const fs::path old = beside(out_, ".replaced");
    if (permissions_.replace && isThere(old) && strangerIn(old).empty()) fs::remove_all(old);
    emptyPartial(partial_);
    fs::remove_all(partial_);
    partial_.clear();
}

}  // namespace terray
