#include "preprocess/work_file.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/error.h"

namespace terray {
namespace {

[[noreturn]] void fail(const std::string& action, const std::filesystem::path& path) {
    const int reason = errno;
    std::string hint;
    if (reason == ENOSPC || reason == EDQUOT || reason == EFBIG) hint = " (free some space, or choose another --out)";
    throw Error(ExitCode::output,
                "cannot " + action + " temporary file " + path.string() + ": " + std::strerror(reason) + hint);
}

int openOrCreate(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) fail("create", path);
    return descriptor;
}

}  // namespace

WorkFile::WorkFile(std::filesystem::path path) : path_(std::move(path)), descriptor_(openOrCreate(path_)) {}

WorkFile::~WorkFile() {
    ::close(descriptor_);
}

void WorkFile::write(uint64_t offset, ByteView bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) fail("write", path_);
        bytes = bytes.subspan(static_cast<size_t>(written));
        offset += static_cast<uint64_t>(written);
    }
}

void WorkFile::read(uint64_t offset, std::span<std::byte> bytes) const {
    while (!bytes.empty()) {
        const ssize_t got = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got == 0) errno = EIO;  // shorter than what was written to it: somebody else touched it
        if (got <= 0) fail("read", path_);
        bytes = bytes.subspan(static_cast<size_t>(got));
        offset += static_cast<uint64_t>(got);
    }
}

void WorkFile::sync() {
    if (::fdatasync(descriptor_) != 0) fail("write", path_);
}

void WorkFile::reopen() {
    const int fresh = openOrCreate(path_);
    ::close(std::exchange(descriptor_, fresh));
}

uint64_t WorkFile::size() const {
    struct stat status = {};
    if (::fstat(descriptor_, &status) != 0) fail("read", path_);
    return static_cast<uint64_t>(status.st_size);
}

void WorkFile::truncate(uint64_t bytes) {
    if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) fail("write", path_);
}

void WorkFile::discard() {
    if (::unlink(path_.c_str()) != 0 && errno != ENOENT) fail("remove", path_);
}

}  // namespace terray
