// The reading half of pmtiles.h.
#include <algorithm>
#include <limits>
#include <mutex>
#include <unordered_map>

#include "common/check.h"
#include "common/pmtiles.h"
#include "common/pmtiles_gzip.h"

namespace terray {
namespace {

using Directory = std::vector<PmtilesEntry>;

constexpr int kMaxLeafLevels = 3;                       // below the root, as the reference readers allow
constexpr size_t kMaxInternalBytes = size_t{64} << 20;  // of a directory or the metadata, packed or not
constexpr size_t kMaxCachedEntries = size_t{1} << 20;   // 24 MiB

/// The entry whose run holds the tile or whose leaf may, else nullptr.
const PmtilesEntry* findEntry(const Directory& directory, uint64_t tile) {
    const auto after = std::upper_bound(directory.begin(), directory.end(), tile,
                                        [](uint64_t id, const PmtilesEntry& entry) { return id < entry.tileId; });
    if (after == directory.begin()) return nullptr;
    const PmtilesEntry& entry = *(after - 1);
    return entry.runLength == 0 || tile - entry.tileId < entry.runLength ? &entry : nullptr;
}

/// Leaf directories by their offset; drops what was used longest ago when the entries in all exceed a bound.
class LeafCache {
  public:
    std::shared_ptr<const Directory> find(uint64_t offset) {
        const std::lock_guard lock(mutex_);
        const auto found = leaves_.find(offset);
        if (found == leaves_.end()) return nullptr;
        found->second.lastUse = ++uses_;
        return found->second.directory;
    }
    void insert(uint64_t offset, std::shared_ptr<const Directory> directory) {
        const std::lock_guard lock(mutex_);
        const size_t size = directory->size();
        if (!leaves_.try_emplace(offset, Leaf{std::move(directory), ++uses_}).second) return;
        entries_ += size;
        while (entries_ > kMaxCachedEntries && leaves_.size() > 1) {
            const auto oldest = std::min_element(leaves_.begin(), leaves_.end(), [](const auto& a, const auto& b) {
                return a.second.lastUse < b.second.lastUse;
            });
            entries_ -= oldest->second.directory->size();
            leaves_.erase(oldest);
        }
    }

    void clear() {
        const std::lock_guard lock(mutex_);
        leaves_.clear();
        entries_ = 0;
    }

  private:
    struct Leaf {
        std::shared_ptr<const Directory> directory;
        uint64_t lastUse = 0;
    };
    std::mutex mutex_;
    std::unordered_map<uint64_t, Leaf> leaves_;
    uint64_t uses_ = 0;
    size_t entries_ = 0;
};

}  // namespace

struct PmtilesReader::State {
    std::unique_ptr<ByteSource> source;
    PmtilesHeader header;
    Directory root;
    mutable LeafCache leaves;

    using Visit = std::function<void(const TileId&, uint64_t, uint32_t)>;
    /// How far forEach() has come: the ids that may follow, and the tiles visited.
    struct Progress {
        uint64_t nextId = 0;
        uint64_t visited = 0;
    };

    [[nodiscard]] Failure damaged(const std::string& what) const { return {source->name() + ": " + what}; }

    [[nodiscard]] Result<void> checkSections() const {
        const struct {
            const char* name;
            uint64_t offset, length;
        } sections[] = {{"root directory", header.rootOffset, header.rootLength},
                        {"metadata", header.metadataOffset, header.metadataLength},
                        {"leaf directories", header.leavesOffset, header.leavesLength},
                        {"tiles", header.tilesOffset, header.tilesLength}};
        for (const auto& section : sections)
            if (section.offset > source->size() || section.length > source->size() - section.offset)
                return damaged("cut short: its " + std::string(section.name) + " should end at byte " +
                               std::to_string(section.offset + section.length) + ", the file has " +
                               std::to_string(source->size()));
        return {};
    }

    [[nodiscard]] Result<void> checkInternalSize(uint64_t length) const {
        if (length > kMaxInternalBytes)
            return damaged("a directory or the metadata has " + std::to_string(length) + " bytes, more than the " +
                           std::to_string(kMaxInternalBytes) + " that this build reads");
        return {};
    }

    /// The stored bytes of a directory or the metadata, unpacked.
    [[nodiscard]] Result<Bytes> unpack(Bytes stored) const {
        if (header.internalCompression == PmtilesCompression::none) return stored;
        if (header.internalCompression != PmtilesCompression::gzip)
            return damaged(
                "its directories are compressed by a method that this build does not read (only gzip or none)");
        auto unpacked = gzipDecompress(stored, kMaxInternalBytes);
        return unpacked.ok() ? std::move(unpacked) : damaged(unpacked.failure().message);
    }

    /// Bytes of a directory or the metadata, unpacked.
    [[nodiscard]] Result<Bytes> readInternal(uint64_t offset, uint64_t length) const {
        if (auto result = checkInternalSize(length); !result.ok()) return result.failure();
        auto bytes = source->read(offset, length);
        return bytes.ok() ? unpack(*std::move(bytes)) : std::move(bytes);
    }

    [[nodiscard]] Result<Directory> parseDirectory(const Result<Bytes>& bytes) const {
        if (!bytes.ok()) return bytes.failure();
        auto directory = decodePmtilesDirectory(*bytes);
        return directory.ok() ? std::move(directory) : damaged(directory.failure().message);
    }

    /// Where a leaf directory lies in the archive.
    [[nodiscard]] Result<ByteRange> leafRange(const PmtilesEntry& entry) const {
        if (entry.offset > header.leavesLength || entry.length > header.leavesLength - entry.offset)
            return damaged("a leaf directory lies outside its section");
        if (auto result = checkInternalSize(entry.length); !result.ok()) return result.failure();
        return ByteRange{header.leavesOffset + entry.offset, entry.length};
    }

    /// Parses a leaf directory that lies at `offset` of the archive, and keeps it.
    [[nodiscard]] Result<std::shared_ptr<const Directory>> keepLeaf(uint64_t offset, Bytes stored) const {
        auto directory = parseDirectory(unpack(std::move(stored)));
        if (!directory.ok()) return directory.failure();
        auto shared = std::make_shared<const Directory>(*std::move(directory));
        leaves.insert(offset, shared);
        return shared;
    }

    [[nodiscard]] Result<std::shared_ptr<const Directory>> readLeaf(const PmtilesEntry& entry) const {
        const auto range = leafRange(entry);
        if (!range.ok()) return range.failure();
        if (auto cached = leaves.find(range->offset)) return cached;
        auto stored = source->read(range->offset, range->length);
        return stored.ok() ? keepLeaf(range->offset, *std::move(stored)) : stored.failure();
    }

    [[nodiscard]] Result<void> checkTile(const PmtilesEntry& entry) const {
        if (entry.offset > header.tilesLength || entry.length > header.tilesLength - entry.offset)
            return damaged("tile " + std::to_string(entry.tileId) + " lies outside the section of tiles");
        return {};
    }

    Result<void> visitDirectory(const Directory& directory, int leafLevel, Progress& progress,
                                const Visit& visit) const {
        for (const PmtilesEntry& entry : directory) {
            if (entry.tileId < progress.nextId) return damaged("tile ids do not ascend");
            if (entry.runLength > 0) {
                if (auto result = visitRun(entry, progress, visit); !result.ok()) return result;
                continue;
            }
            if (leafLevel == kMaxLeafLevels) return damaged("leaf directories are nested too deeply");
            progress.nextId = entry.tileId;
            const auto leaf = readLeaf(entry);
            if (!leaf.ok()) return leaf.failure();
            if (auto result = visitDirectory(**leaf, leafLevel + 1, progress, visit); !result.ok()) return result;
        }
        return {};
    }

    Result<void> visitRun(const PmtilesEntry& entry, Progress& progress, const Visit& visit) const {
        if (auto result = checkTile(entry); !result.ok()) return result;
        progress.visited += entry.runLength;
        if (header.addressedTiles != 0 && progress.visited > header.addressedTiles)
            return damaged("its directories name more tiles than its header");
        for (uint64_t i = 0; i < entry.runLength; ++i) {
            const auto tile = tileFromHilbert(entry.tileId + i);
            if (!tile.ok()) return damaged(tile.failure().message);
            visit(*tile, header.tilesOffset + entry.offset, entry.length);
        }
        progress.nextId = entry.tileId + entry.runLength;
        return {};
    }
};

PmtilesReader::PmtilesReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
PmtilesReader::PmtilesReader(PmtilesReader&&) noexcept = default;
PmtilesReader& PmtilesReader::operator=(PmtilesReader&&) noexcept = default;
PmtilesReader::~PmtilesReader() = default;

Result<PmtilesReader> PmtilesReader::open(std::unique_ptr<ByteSource> source) {
    TERRAY_CHECK(source != nullptr);
    auto state = std::make_unique<State>();
    state->source = std::move(source);
    if (state->source->size() < kPmtilesHeaderBytes)
        return state->damaged("too short for a PMTiles archive, " + std::to_string(state->source->size()) + " bytes");
    const auto bytes = state->source->read(0, kPmtilesHeaderBytes);
    if (!bytes.ok()) return bytes.failure();
    const auto header = decodePmtilesHeader(*bytes);
    if (!header.ok()) return state->damaged(header.failure().message);
    state->header = *header;
    if (auto result = state->checkSections(); !result.ok()) return result.failure();
    auto root = state->parseDirectory(state->readInternal(header->rootOffset, header->rootLength));
    if (!root.ok()) return root.failure();
    state->root = *std::move(root);
    return PmtilesReader(std::move(state));
}

const PmtilesHeader& PmtilesReader::header() const {
    return state_->header;
}
const ByteSource& PmtilesReader::source() const {
    return *state_->source;
}

Result<std::string> PmtilesReader::metadata() const {
    const auto bytes = state_->readInternal(state_->header.metadataOffset, state_->header.metadataLength);
    if (!bytes.ok()) return bytes.failure();
    return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

Result<std::optional<ByteRange>> PmtilesReader::locate(const TileId& id) const {
    auto lookup = lookUp(id);
    while (lookup.ok() && lookup->isLeaf()) {
        const auto bytes = state_->source->read(lookup->range()->offset, lookup->range()->length);
        if (!bytes.ok()) return bytes.failure();
        if (auto result = lookup->takeLeaf(*bytes); !result.ok()) return result.failure();
    }
    if (!lookup.ok()) return lookup.failure();
    return lookup->range();
}

Result<std::optional<Bytes>> PmtilesReader::read(const TileId& id) const {
    const auto range = locate(id);
    if (!range.ok()) return range.failure();
    if (!*range) return std::optional<Bytes>();
    auto bytes = state_->source->read((*range)->offset, (*range)->length);
    if (!bytes.ok()) return bytes.failure();
    return std::optional<Bytes>(*std::move(bytes));
}

Result<PmtilesReader::Lookup> PmtilesReader::lookUp(const TileId& id) const {
    Lookup lookup(*state_, hilbertId(id));
    if (auto result = lookup.descend(state_->root); !result.ok()) return result.failure();
    return lookup;
}

void PmtilesReader::forgetLeaves() const {
    state_->leaves.clear();
}

Result<void> PmtilesReader::Lookup::takeLeaf(ByteView bytes) {
    TERRAY_CHECK(isLeaf_ && range_);
    const auto leaf = state_->keepLeaf(range_->offset, Bytes(bytes.begin(), bytes.end()));
    return leaf.ok() ? descend(**leaf) : leaf.failure();
}

/// As far down from `directory` as cached leaves lead.
Result<void> PmtilesReader::Lookup::descend(const Directory& directory) {
    std::shared_ptr<const Directory> leaf;  // keeps the entry's directory alive
    const PmtilesEntry* entry = findEntry(directory, tile_);
    while (entry != nullptr && entry->runLength == 0) {
        if (leafLevel_ == kMaxLeafLevels) return state_->damaged("leaf directories are nested too deeply");
        ++leafLevel_;
        const auto range = state_->leafRange(*entry);
        if (!range.ok()) return range.failure();
        auto cached = state_->leaves.find(range->offset);
        if (!cached) {
            range_ = *range;
            isLeaf_ = true;
            return {};
        }
        leaf = std::move(cached);
        entry = findEntry(*leaf, tile_);
    }
    range_.reset();
    isLeaf_ = false;
    if (entry == nullptr) return {};
    if (auto result = state_->checkTile(*entry); !result.ok()) return result;
    range_ = ByteRange{state_->header.tilesOffset + entry->offset, entry->length};
    return {};
}

Result<void> PmtilesReader::forEach(const State::Visit& visit) const {
    State::Progress progress;
    return state_->visitDirectory(state_->root, 0, progress, visit);
}

}  // namespace terray
