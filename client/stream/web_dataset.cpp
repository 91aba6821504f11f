#include "client/stream/web_dataset.h"

#include <array>
#include <optional>
#include <unordered_map>
#include <utility>

#include "client/stream/archived_dataset.h"
#include "client/stream/tile_reads.h"
#include "client/stream/web_address.h"
#include "client/stream/web_archive.h"
#include "common/check.h"
#include "common/error.h"

namespace terray {
namespace {

/// An archive as the IO thread reads it.
struct RemoteLayer {
    const PmtilesReader* directories = nullptr;  ///< nullptr: the dataset does not have this layer
    const WebArchive* file = nullptr;            ///< whose bytes they are
};
using RemoteLayers = std::array<RemoteLayer, 2>;  ///< by TileLayer

/// Tiles by range requests: for each the way through the directories, then the tile. Requests for the same leaf
/// directory are joined.
class WebReads final : public TileReads {
  public:
    WebReads(const RemoteLayers& layers, const HttpOptions& options, std::shared_ptr<DiskCache> cache)
        : layers_(layers),
          connections_(static_cast<size_t>(options.connections)),
          http_(options),
          cache_(std::move(cache)) {}

    size_t atATime() const override { return connections_; }
    bool mayHeal() const override { return true; }

    void begin(uint64_t ticket, TileLayer layer, const TileId& id, bool again) override {
        const RemoteLayer& archive = layers_[static_cast<size_t>(layer)];
        if (archive.directories == nullptr) {
            done_.push_back({ticket, Failure{"the dataset has no imagery"}});
            return;
        }
        // The tile may have been looked for in the wrong place: leaf directories have no checksum of their own.
        if (again) archive.directories->forgetLeaves();
        auto lookup = archive.directories->lookUp(id);
        if (!lookup) {
            done_.push_back({ticket, lookup.failure()});
            return;
        }
        const auto placed = reads_.emplace(ticket, Read{layer, id, again, *std::move(lookup)});
        TERRAY_CHECK(placed.second);
        goOn(ticket, placed.first->second);
    }

    bool cancel(uint64_t ticket) override {
        const auto read = reads_.find(ticket);
        if (read == reads_.end()) return false;
        Fetch& fetch = fetches_.at(read->second.fetch);
        if (fetch.readers.size() > 1) {
            std::erase(fetch.readers, ticket);
        } else {
            if (!http_.cancel(read->second.fetch)) return false;
            fetches_.erase(read->second.fetch);
        }
        reads_.erase(read);
        return true;
    }

    std::vector<TileRead> wait(bool block) override {
        for (HttpEnd& end : http_.wait(block && done_.empty())) settle(std::move(end));
        return std::exchange(done_, {});
    }
    void wake() override { http_.wake(); }
    TileReadStatistics statistics() const override {
        const HttpStatistics http = http_.statistics();
        return {.receivedBytes = http.receivedBytes,
                .retries = http.retries,
                .diskCache = cache_ ? cache_->statistics() : DiskCacheStatistics()};
    }

  private:
    struct Read {
        TileLayer layer;
        TileId id;
        bool again;
        PmtilesReader::Lookup lookup;
        uint64_t fetch = 0;  ///< that it waits for
    };
    struct Fetch {
        TileLayer layer;
        ByteRange range;
        std::vector<uint64_t> readers;  ///< one, unless it is a leaf directory
    };

    /// Asks for what a read needs next, or ends it when the archive has no such tile.
    void goOn(uint64_t ticket, Read& read) {
        const RemoteLayer& archive = layers_[static_cast<size_t>(read.layer)];
        if (!read.lookup.range()) {
            end(ticket, ArchivedDataset::missing(*archive.directories, read.id), true);
            return;
        }
        const ByteRange range = *read.lookup.range();
        if (!read.again) {
            if (auto held = archive.file->cached(range)) {
                arrive(ticket, *std::move(held), true);
                return;
            }
        }
        for (auto& [number, fetch] : fetches_) {
            if (!read.lookup.isLeaf() || fetch.layer != read.layer || fetch.range != range) continue;
            fetch.readers.push_back(ticket);
            read.fetch = number;
            return;
        }
        read.fetch = ++fetchesBegun_;
        fetches_.emplace(read.fetch, Fetch{read.layer, range, {ticket}});
        http_.begin(read.fetch, archive.file->request(range, read.again));
    }

    void settle(HttpEnd ended) {
        const auto found = fetches_.find(ended.ticket);
        TERRAY_CHECK(found != fetches_.end());
        const Fetch fetch = std::move(found->second);
        fetches_.erase(found);
        const WebArchive& file = *layers_[static_cast<size_t>(fetch.layer)].file;
        Result<Bytes> bytes = file.accept(std::move(ended.answer), fetch.range);
        if (fetch.readers.size() == 1) {
            arrive(fetch.readers.front(), std::move(bytes), ended.reachable);
        } else {
            for (const uint64_t ticket : fetch.readers) arrive(ticket, bytes, ended.reachable);
        }
    }

    /// Takes the bytes that a read waited for: the tile, or a leaf directory on the way to it.
    void arrive(uint64_t ticket, Result<Bytes> bytes, bool reachable) {
        Read& read = reads_.at(ticket);
        if (!bytes || !read.lookup.isLeaf()) {
            end(ticket, std::move(bytes), reachable);
        } else if (auto taken = read.lookup.takeLeaf(*bytes); !taken) {
            end(ticket, taken.failure(), true);
        } else {
            goOn(ticket, read);
        }
    }

    void end(uint64_t ticket, Result<Bytes> payload, bool reachable) {
        reads_.erase(ticket);
        done_.push_back({ticket, std::move(payload), reachable});
    }

    const RemoteLayers layers_;
    const size_t connections_;
    HttpClient http_;
    std::shared_ptr<DiskCache> cache_;
    std::unordered_map<uint64_t, Read> reads_;
    std::unordered_map<uint64_t, Fetch> fetches_;
    uint64_t fetchesBegun_ = 0;
    std::vector<TileRead> done_;
};

class WebDataset final : public TileSource {
  public:
    WebDataset(const std::string& address, const WebOptions& options, const std::shared_ptr<BlockingHttp>& http)
        : options_(options), cache_(cacheOf(options.diskCache)), archives_(placeOf(address, http)) {
        readRoot(TileLayer::heights);
        if (metadata().imageryLevel) readRoot(TileLayer::imagery);
    }

    const DatasetMetadata& metadata() const override { return archives_.metadata(); }
    Result<Bytes> read(TileLayer layer, const TileId& id) const override {
        const auto& root = roots_[static_cast<size_t>(layer)];
        if (id == TileId{} && root) return *root;
        return archives_.read(layer, id);
    }
    std::string contentHash() const override { return archives_.contentHash(); }
    std::unique_ptr<TileReads> startReads() const override {
        RemoteLayers layers;
        for (const TileLayer layer : {TileLayer::heights, TileLayer::imagery})
            layers[static_cast<size_t>(layer)] = {archives_.archive(layer), files_[static_cast<size_t>(layer)]};
        return std::make_unique<WebReads>(layers, options_.http, cache_);
    }

  private:
    static std::shared_ptr<DiskCache> cacheOf(const DiskCacheOptions& options) {
        return options.directory.empty() ? nullptr : std::make_shared<DiskCache>(options);
    }
    ArchivedDataset::Place placeOf(const std::string& address, const std::shared_ptr<BlockingHttp>& http) {
        const auto open = [this, address, http](const char* file) -> Result<std::unique_ptr<ByteSource>> {
            auto archive = WebArchive::open(archiveAddress(address, file), http, cache_);
            if (!archive) return archive.failure();
            files_[std::string_view(file) == kHeightsFile ? 0 : 1] = archive->get();
            return std::unique_ptr<ByteSource>(*std::move(archive));
        };
        return {.name = address,
                .open = open,
                .remedy = "give http(s)://HOST/NAME of a terray-server, or the address of a heights.pmtiles"};
    }
    /// The root stays at hand: whoever needs it cannot wait for a server.
    void readRoot(TileLayer layer) {
        const auto isWhole = [layer](const Bytes& payload) {
            return layer == TileLayer::heights ? decodeHeightTile(payload, TileId{}).ok()
                                               : decodeImageryTile(payload, TileId{}).ok();
        };
        auto payload = archives_.read(layer, {});
        if (payload && !isWhole(*payload)) payload = archives_.read(layer, {});  // its user tells what is damaged
        if (!payload) throw Error(ExitCode::dataset, "cannot open dataset: " + payload.failure().message);
        roots_[static_cast<size_t>(layer)] = *std::move(payload);
    }

    const WebOptions options_;
    const std::shared_ptr<DiskCache> cache_;    ///< null: none
    std::array<const WebArchive*, 2> files_{};  ///< by TileLayer; archives_ owns them
    ArchivedDataset archives_;
    std::array<std::optional<Bytes>, 2> roots_;
};

}  // namespace

std::unique_ptr<TileSource> openWebDataset(const std::string& address, const WebOptions& options) {
    HttpOptions opening = options.http;
    opening.attempts = options.attemptsToOpen;
    const auto http = std::make_shared<BlockingHttp>(opening);
    try {
        return std::make_unique<WebDataset>(address, options, http);
    } catch (const Error& error) {
        if (http->reachable()) throw;
        throw Error(ExitCode::network, error.what());
    }
}

}  // namespace terray
