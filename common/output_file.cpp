#include "common/output_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include "common/error.h"

namespace terray {
namespace {

constexpr size_t kBufferBytes = size_t{1} << 20;

/// Whether copy_file_range failed for lack of support rather than for want of space or a broken disk.
bool copyUnsupported(int error) {
    return error == EXDEV || error == ENOSYS || error == EINVAL || error == EOPNOTSUPP || error == EPERM;
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) refuse("create");
}

OutputFile::~OutputFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    ::unlink(path_.c_str());
}

void OutputFile::refuse(const std::string& what) const {
    const int error = errno;
    const char* hint = error == ENOSPC || error == EDQUOT  ? " (free some space, or write elsewhere)"
                       : error == EACCES || error == EROFS ? " (check the directory's permissions)"
                                                           : "";
    throw Error(ExitCode::output, "cannot " + what + " " + path_.string() + ": " + std::strerror(error) + hint);
}

void OutputFile::write(ByteView bytes) {
    if (buffer_.size() + bytes.size() > kBufferBytes) flush();
    if (bytes.size() > kBufferBytes) {
        writeAll(bytes);
    } else {
        buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    }
    size_ += bytes.size();
}

void OutputFile::flush() {
    writeAll(buffer_);
    buffer_.clear();
}

void OutputFile::writeAll(ByteView bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) refuse("write");
        bytes = bytes.subspan(static_cast<size_t>(written));
    }
}

void OutputFile::append(OutputFile& other) {
    flush();
    other.flush();
    off_t position = 0;
    const auto end = static_cast<off_t>(other.size_);
    while (position < end) {
        const ssize_t copied = ::copy_file_range(other.descriptor_, &position, descriptor_, nullptr,
                                                 static_cast<size_t>(end - position), 0);
        if (copied > 0 || (copied < 0 && errno == EINTR)) continue;
        if (copied < 0 && !copyUnsupported(errno)) refuse("write");
        break;
    }
    // What the kernel would not copy (all of it, or nothing).
    Bytes chunk(position < end ? kBufferBytes : 0);
    while (position < end) {
        const size_t wanted = std::min(chunk.size(), static_cast<size_t>(end - position));
        const ssize_t got = ::pread(other.descriptor_, chunk.data(), wanted, position);
        if (got < 0 && errno == EINTR) continue;
        if (got == 0) errno = EIO;  // somebody cut the temporary file short
        if (got <= 0) other.refuse("read back");
        writeAll(ByteView(chunk).first(static_cast<size_t>(got)));
        position += got;
    }
    size_ += other.size_;
}

void OutputFile::publish(const std::filesystem::path& target) {
    flush();
    if (::fsync(descriptor_) != 0) refuse("write");
    if (::rename(path_.c_str(), target.c_str()) != 0) refuse("rename to " + target.string());
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    path_ = target;
    if (closed != 0) refuse("write");

    // The name itself is safe only when its directory is; some file systems cannot sync a directory, which is no
    // failure.
    const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
    const int folderDescriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folderDescriptor < 0) return;
    ::fsync(folderDescriptor);
    ::close(folderDescriptor);
}

void writeWholeFile(const std::filesystem::path& target, ByteView content) {
    std::filesystem::path partial = target;
    partial += ".partial";
    OutputFile file(partial);
    file.write(content);
    file.publish(target);
}

}  // namespace terray
