#include "client/stream/disk_cache.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <span>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/checksum.h"
#include "common/error.h"

namespace terray {
namespace {

namespace fs = std::filesystem;

constexpr uint32_t kMagic = 0x31435954;  // "TYC1"
constexpr size_t kHeaderBytes = 8;       // magic, CRC-32C of archive's name, range and bytes
constexpr const char* kLockFile = "lock";
constexpr const char* kTemporary = ".tmp";
/// What was left by a killed process; nobody writes a range for so long.
constexpr std::chrono::minutes kTemporaryAge(10);
constexpr std::chrono::minutes kUseInterval(1);

class Descriptor {
  public:
    Descriptor(const fs::path& path, int flags) : value_(::open(path.c_str(), flags | O_CLOEXEC, 0644)) {}
    ~Descriptor() {
        if (value_ >= 0) ::close(value_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    [[nodiscard]] bool ok() const { return value_ >= 0; }
    [[nodiscard]] int get() const { return value_; }

  private:
    int value_;
};

uint64_t fnv1a(const std::string& text) {  // Fowler, Noll, Vo, 64 bits
    uint64_t hash = 0xcbf29ce484222325ULL;
    for (const char letter : text) hash = (hash ^ static_cast<uint8_t>(letter)) * 0x100000001b3ULL;
    return hash;
}

std::string hexadecimal(uint64_t value) {
    std::array<char, 17> text{};
    std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
    return text.data();
}

fs::path fileOf(const fs::path& directory, const std::string& archive, const ByteRange& range) {
    return directory / hexadecimal(fnv1a(archive)) / (hexadecimal(range.offset) + "-" + std::to_string(range.length));
}

uint32_t checksumOf(const std::string& archive, const ByteRange& range, ByteView bytes) {
    ByteWriter place;
    place.writeText(archive);
    place.write(range.offset);
    place.write(range.length);
    return crc32c(bytes, crc32c(place.bytes()));
}

bool readAll(int descriptor, std::span<std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t got = ::read(descriptor, bytes.data(), bytes.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        bytes = bytes.subspan(static_cast<size_t>(got));
    }
    return true;
}

bool writeAll(int descriptor, ByteView bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        bytes = bytes.subspan(static_cast<size_t>(written));
    }
    return true;
}

/// A file of the cache, or one that is becoming one.
struct Entry {
    fs::file_time_type used;
    uint64_t bytes = 0;
    fs::path path;
};

/// Whether a name begins as fileOf makes them: whoever gives a directory with other things in it keeps those.
bool beginsWithHexadecimal(const fs::path& name) {
    const std::string text = name.string();
    return text.size() >= 16 && text.find_first_not_of("0123456789abcdef") >= 16;
}

/// Adds the files of one archive; what other processes remove meanwhile is left out. Removes what killed ones left.
void addEntries(const fs::path& folder, std::vector<Entry>& entries) {
    const auto now = fs::file_time_type::clock::now();
    std::error_code error;
    for (fs::directory_iterator place(folder, error), end; !error && place != end; place.increment(error)) {
        std::error_code gone;
        Entry entry{.used = place->last_write_time(gone), .path = place->path()};
        if (gone || !place->is_regular_file(gone) || gone || !beginsWithHexadecimal(entry.path.filename())) continue;
        entry.bytes = place->file_size(gone);
        if (gone) continue;
        if (entry.path.extension() == kTemporary && now - entry.used > kTemporaryAge)
            fs::remove(entry.path, gone);
        else
            entries.push_back(std::move(entry));
    }
}

std::vector<Entry> entriesOf(const fs::path& directory) {
    std::vector<Entry> entries;
    std::error_code error;
    for (fs::directory_iterator place(directory, error), end; !error && place != end; place.increment(error)) {
        std::error_code gone;
        if (place->is_directory(gone) && place->path().filename().string().size() == 16 &&
            beginsWithHexadecimal(place->path().filename()))
            addEntries(place->path(), entries);
    }
    return entries;
}

}  // namespace

DiskCache::DiskCache(DiskCacheOptions options) : options_(std::move(options)) {
    std::error_code error;
    fs::create_directories(options_.directory, error);
    const Descriptor lock(options_.directory / kLockFile, O_RDWR | O_CREAT);
    if (error || !lock.ok())
        throw Error(ExitCode::output, "cannot use " + options_.directory.string() +
                                          " as disk cache: " + (error ? error.message() : std::strerror(errno)) +
                                          "; give a directory that can be written into");
    evict(options_.maxBytes);
}

std::optional<Bytes> DiskCache::read(const std::string& archive, const ByteRange& range) {
    const Descriptor file(fileOf(options_.directory, archive, range), O_RDONLY);
    struct stat status {};
    if (!file.ok() || ::fstat(file.get(), &status) != 0) return {};
    if (static_cast<uint64_t>(status.st_size) != kHeaderBytes + range.length) return {};
    Bytes all(kHeaderBytes + range.length);
    if (!readAll(file.get(), all)) return {};
    ByteReader header(all);
    const auto magic = header.read<uint32_t>();
    const auto checksum = header.read<uint32_t>();
    const ByteView bytes = ByteView(all).subspan(kHeaderBytes);
    if (magic != kMagic || checksum != checksumOf(archive, range, bytes)) return {};
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    if (now.tv_sec - status.st_mtim.tv_sec > std::chrono::seconds(kUseInterval).count())
        ::futimens(file.get(), nullptr);
    const std::lock_guard lock(mutex_);
    ++count_.hits;
    count_.hitBytes += range.length;
    all.erase(all.begin(), all.begin() + kHeaderBytes);
    return all;
}

void DiskCache::write(const std::string& archive, const ByteRange& range, ByteView bytes) {
    if (bytes.size() + kHeaderBytes > options_.maxBytes / 4) return;
    const fs::path target = fileOf(options_.directory, archive, range);
    const std::lock_guard lock(mutex_);
    makeRoomFor(bytes.size() + kHeaderBytes);
    std::error_code error;
    fs::create_directory(target.parent_path(), error);
    const fs::path temporary =
        target.string() + "." + std::to_string(::getpid()) + "." + std::to_string(++temporaryNames_) + kTemporary;
    ByteWriter header;
    header.write(kMagic);
    header.write(checksumOf(archive, range, bytes));
    bool whole = false;
    {
        const Descriptor file(temporary, O_WRONLY | O_CREAT | O_EXCL);
        whole = file.ok() && writeAll(file.get(), header.bytes()) && writeAll(file.get(), bytes);
    }
    if (whole) fs::rename(temporary, target, error);
    if (!whole || error) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        ++count_.failures;
        return;
    }
    ++count_.written;
    heldBytes_ += bytes.size() + kHeaderBytes;
    writtenBytes_ += bytes.size() + kHeaderBytes;
}

/// Looks at the directory once it may be full, or others may have filled it.
void DiskCache::makeRoomFor(uint64_t bytes) {
    if (heldBytes_ + bytes <= options_.maxBytes && writtenBytes_ + bytes <= options_.maxBytes / 16) return;
    evict(options_.maxBytes - bytes);
}

/// Counts what is there, and lets the oldest go if it is more than `mostBytes`. One process at a time.
void DiskCache::evict(uint64_t mostBytes) {
    const Descriptor lock(options_.directory / kLockFile, O_RDWR | O_CREAT);
    while (lock.ok() && ::flock(lock.get(), LOCK_EX) != 0 && errno == EINTR) {
    }
    std::vector<Entry> entries = entriesOf(options_.directory);
    heldBytes_ = writtenBytes_ = 0;
    for (const Entry& entry : entries) heldBytes_ += entry.bytes;
    if (heldBytes_ <= mostBytes) return;
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.used < b.used; });
    const uint64_t target = std::min(mostBytes, options_.maxBytes - options_.maxBytes / 10);
    for (const Entry& entry : entries) {
        if (heldBytes_ <= target) break;
        std::error_code gone;
        fs::remove(entry.path, gone);
        heldBytes_ -= entry.bytes;
    }
}

DiskCacheStatistics DiskCache::statistics() const {
    const std::lock_guard lock(mutex_);
    return count_;
}

}  // namespace terray
