#include "client/stream/web_archive.h"

#include <utility>

#include "common/checksum.h"

namespace terray {
namespace {

/// Fetched at once when an archive is opened. The specification lets header and root directory fill 16 KiB; ours have
/// the metadata beside them.
constexpr uint64_t kHeadBytes = 32 << 10;

}  // namespace

HttpEnd BlockingHttp::fetch(HttpRequest request) {
    const std::lock_guard lock(mutex_);
    HttpEnd end = client_.fetch(std::move(request));
    reachable_ = end.reachable;
    return end;
}

bool BlockingHttp::reachable() const {
    const std::lock_guard lock(mutex_);
    return reachable_;
}

WebArchive::WebArchive(std::string url, std::shared_ptr<BlockingHttp> http, std::shared_ptr<DiskCache> cache,
                       HttpAnswer head)
    : url_(std::move(url)),
      http_(std::move(http)),
      size_(head.totalBytes),
      etag_(std::move(head.etag)),
      head_(std::move(head.body)),
      cache_(std::move(cache)),
      // The head is in it because a server need not send ETags.
      identity_(url_ + '\n' + std::to_string(size_) + '\n' + etag_ + '\n' + std::to_string(crc32c(head_))) {}

Result<std::unique_ptr<WebArchive>> WebArchive::open(std::string url, std::shared_ptr<BlockingHttp> http,
                                                     std::shared_ptr<DiskCache> cache) {
    HttpEnd end = http->fetch({.url = url, .range = {0, kHeadBytes}});
    if (!end.answer) return end.answer.failure();
    return std::unique_ptr<WebArchive>(
        new WebArchive(std::move(url), std::move(http), std::move(cache), *std::move(end.answer)));
}

Result<Bytes> WebArchive::read(uint64_t offset, uint64_t length) const {
    if (offset > size_ || length > size_ - offset)
        return Failure{url_ + ": bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) +
                       " lie beyond its " + std::to_string(size_) + " bytes"};
    if (length == 0) return Bytes();
    if (offset + length <= head_.size()) {
        const auto first = head_.begin() + static_cast<ptrdiff_t>(offset);
        return Bytes(first, first + static_cast<ptrdiff_t>(length));
    }
    const ByteRange range{offset, length};
    if (auto held = cached(range)) return *std::move(held);
    return accept(http_->fetch(request(range, false)).answer, range);
}

Result<Bytes> WebArchive::accept(Result<HttpAnswer> answer, const ByteRange& range) const {
    if (!answer) return answer.failure();
    if (answer->totalBytes != size_ || answer->etag != etag_)
        return Failure{url_ + ": it was replaced on the server while it was open (found " +
                       std::to_string(answer->totalBytes) + " bytes, ETag " + answer->etag + ", expected " +
                       std::to_string(size_) + ", " + etag_ + "); start anew"};
    if (answer->body.size() != range.length) return Failure{url_ + ": became shorter while it was read"};
    if (cache_) cache_->write(identity_, range, answer->body);
    return std::move(answer->body);
}

std::optional<Bytes> WebArchive::cached(const ByteRange& range) const {
    return cache_ ? cache_->read(identity_, range) : std::nullopt;
}

}  // namespace terray
