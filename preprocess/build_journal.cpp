#include "preprocess/build_journal.h"

#include <optional>
#include <utility>

#include "common/check.h"
#include "common/checksum.h"

namespace terray {
namespace {

constexpr uint64_t kFrameBytes = 8;
/// Far above any entry: a block of 64 x 64 tiles takes 150 kB.
constexpr uint32_t kMaxContentBytes = 64u << 20;

/// The content of the entry at `place`; none when it is not whole.
std::optional<Bytes> readEntry(const WorkFile& file, uint64_t fileBytes, uint64_t place) {
    if (place + kFrameBytes > fileBytes) return {};
    Bytes frame(kFrameBytes);
    file.read(place, frame);
    ByteReader in(frame);
    const auto length = in.read<uint32_t>();
    const auto checksum = in.read<uint32_t>();
    // A power cut may leave zeros, whose checksum would be right: so no entry is empty.
    if (length == 0 || length > kMaxContentBytes || place + kFrameBytes + length > fileBytes) return {};
    Bytes content(length);
    file.read(place + kFrameBytes, content);
    if (crc32c(content) != checksum) return {};
    return content;
}

}  // namespace

BuildJournal::BuildJournal(const std::filesystem::path& path, Access access) : file_(path) {
    findEnd();
    if (access == Access::write && end_ < file_.size()) file_.truncate(end_);
    reserved_ = end_;
}

void BuildJournal::refresh() {
    file_.reopen();
    findEnd();
}

void BuildJournal::findEnd() {
    const uint64_t bytes = file_.size();
    while (const std::optional<Bytes> content = readEntry(file_, bytes, end_)) end_ += kFrameBytes + content->size();
}

void BuildJournal::forEach(const std::function<void(uint64_t, ByteView)>& visit) const {
    for (uint64_t place = 0; place < end_;) {
        const Bytes content = read(place);
        visit(place, content);
        place += kFrameBytes + content.size();
    }
}

Bytes BuildJournal::read(uint64_t place) const {
    std::optional<Bytes> content = readEntry(file_, file_.size(), place);
    TERRAY_CHECK(content.has_value());  // it was whole when its place was told
    return *std::move(content);
}

uint64_t BuildJournal::commit(ByteView content, std::span<WorkFile* const> data) {
    TERRAY_CHECK_OP(content.size(), >, 0u);
    TERRAY_CHECK_OP(content.size(), <=, size_t{kMaxContentBytes});
    ByteWriter frame;
    frame.write(static_cast<uint32_t>(content.size()));
    frame.write(crc32c(content));
    frame.writeBytes(content);

    std::unique_lock lock(mutex_);
    const uint64_t place = reserved_;
    pending_.insert(pending_.end(), frame.bytes().begin(), frame.bytes().end());
    reserved_ += frame.size();
    if (!data.empty()) pendingData_.assign(data.begin(), data.end());
    // Whoever finds the disk idle writes for all that wait.
    while (end_ <= place) {
        if (failure_) std::rethrow_exception(failure_);
        if (writing_)
            batchDone_.wait(lock);
        else
            writeBatch(lock);
    }
    return place;
}

void BuildJournal::writeBatch(std::unique_lock<std::mutex>& lock) {
    const Bytes batch = std::exchange(pending_, {});
    const std::vector<WorkFile*> data = std::exchange(pendingData_, {});
    const uint64_t start = end_;
    writing_ = true;
    lock.unlock();
    std::exception_ptr failure;
    try {
        for (WorkFile* const file : data) file->sync();
        file_.write(start, batch);
        if (!data.empty()) file_.sync();
    } catch (...) {
        failure = std::current_exception();
    }
    lock.lock();
    writing_ = false;
    failure_ = failure;
    if (!failure) end_ = start + batch.size();
    batchDone_.notify_all();
}

}  // namespace terray
