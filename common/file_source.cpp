// The local ByteSource of pmtiles.h.
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/pmtiles.h"

namespace terray {
namespace {

class FileSource final : public ByteSource {
  public:
    FileSource(int descriptor, uint64_t size, std::string name)
        : descriptor_(descriptor), size_(size), name_(std::move(name)) {}
    ~FileSource() override { ::close(descriptor_); }
    FileSource(const FileSource&) = delete;
    FileSource& operator=(const FileSource&) = delete;

    Result<Bytes> read(uint64_t offset, uint64_t length) const override {
        if (offset > size_ || length > size_ - offset)
            return Failure{name_ + ": bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) +
                           " lie beyond its " + std::to_string(size_) + " bytes"};
        Bytes bytes(length);
        size_t done = 0;
        while (done < length) {
            const ssize_t got =
                ::pread(descriptor_, bytes.data() + done, length - done, static_cast<off_t>(offset + done));
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) return Failure{"cannot read " + name_ + ": " + std::strerror(errno)};
            if (got == 0) return Failure{name_ + ": became shorter while it was read"};
            done += static_cast<size_t>(got);
        }
        return bytes;
    }
    uint64_t size() const override { return size_; }
    std::string name() const override { return name_; }
    std::optional<int> descriptor() const override { return descriptor_; }

  private:
    int descriptor_;
    uint64_t size_;
    std::string name_;
};

}  // namespace

Result<std::unique_ptr<ByteSource>> openFileSource(const std::filesystem::path& path) {
    const auto failed = [&] { return Failure{"cannot open " + path.string() + ": " + std::strerror(errno)}; };
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return failed();
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        if (S_ISDIR(status.st_mode)) errno = EISDIR;
        const Failure failure = failed();
        ::close(descriptor);
        return failure;
    }
    return std::unique_ptr<ByteSource>(
        std::make_unique<FileSource>(descriptor, static_cast<uint64_t>(status.st_size), path.string()));
}

}  // namespace terray
