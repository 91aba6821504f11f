#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "client/stream/disk_cache.h"
#include "client/stream/http_client.h"
#include "common/pmtiles.h"

namespace terray {

/// Requests that a thread waits for. Shared by the archives of a dataset.
class BlockingHttp {
  public:
    explicit BlockingHttp(const HttpOptions& options) : client_(options) {}
    [[nodiscard]] HttpEnd fetch(HttpRequest request);
    /// Whether the last request found its server able to answer.
    [[nodiscard]] bool reachable() const;

  private:
    mutable std::mutex mutex_;
    HttpClient client_;
    bool reachable_ = true;
};

/// An archive on a web server. Its first bytes, which hold the directories of most archives, are fetched once and kept.
class WebArchive final : public ByteSource {
  public:
    /// @param cache  of ranges, shared with others; null: none
    [[nodiscard]] static Result<std::unique_ptr<WebArchive>> open(std::string url, std::shared_ptr<BlockingHttp> http,
                                                                  std::shared_ptr<DiskCache> cache);

    Result<Bytes> read(uint64_t offset, uint64_t length) const override;
    uint64_t size() const override { return size_; }
    std::string name() const override { return url_; }

    [[nodiscard]] HttpRequest request(const ByteRange& range, bool fresh) const { return {url_, range, fresh}; }
    /// The bytes of an answer to such a request, if they are whole and of the archive that was opened; they go into the
    /// cache.
    [[nodiscard]] Result<Bytes> accept(Result<HttpAnswer> answer, const ByteRange& range) const;
    /// What the cache holds.
    [[nodiscard]] std::optional<Bytes> cached(const ByteRange& range) const;

  private:
    WebArchive(std::string url, std::shared_ptr<BlockingHttp> http, std::shared_ptr<DiskCache> cache, HttpAnswer head);

    std::string url_;
    std::shared_ptr<BlockingHttp> http_;
    uint64_t size_;
    std::string etag_;
    Bytes head_;
    std::shared_ptr<DiskCache> cache_;
    std::string identity_;  ///< of this version of the archive, in the cache
};

}  // namespace terray
