// The writing half of pmtiles.h.
#include <algorithm>
#include <limits>

#include "common/check.h"
#include "common/error.h"
#include "common/output_file.h"
#include "common/pmtiles.h"
#include "common/pmtiles_gzip.h"

namespace terray {
namespace {

/// The directories of a finished archive.
struct Directories {
    Bytes root;
    Bytes leaves;
};

/// How many of what an archive holds, for its header.
struct Counts {
    uint64_t addressed = 0;
    uint64_t entries = 0;
    uint64_t contents = 0;
    uint64_t tileBytes = 0;
};

/// Tells all entries of an archive in order; the same ones at each call.
using ListEntries = std::function<void(const std::function<void(const PmtilesEntry&)>& tell)>;

std::filesystem::path withSuffix(const std::filesystem::path& path, const char* suffix) {
    return path.string() + suffix;
}

void requireKnown(const PmtilesWriteOptions& options) {
    TERRAY_CHECK_OP(options.leafEntries, >, 0U);
    const bool known = options.internalCompression == PmtilesCompression::none ||
                       options.internalCompression == PmtilesCompression::gzip;
    TERRAY_CHECK(known);
}

/// Makes the parts of an archive that precede its tiles.
class FrontMatter {
  public:
    FrontMatter(std::filesystem::path path, const PmtilesWriteOptions& options)
        : path_(std::move(path)), options_(options) {}

    /// One directory if it fits the root's bound, else leaves that double until their root does.
    [[nodiscard]] Directories directories(const ListEntries& list, uint64_t count) const {
        // An entry takes some bytes even when packed, so many entries need not be tried as one directory.
        if (count <= options_.maxRootBytes) {
            std::vector<PmtilesEntry> entries;
            list([&](const PmtilesEntry& entry) { entries.push_back(entry); });
            Directories whole{.root = packed(encodePmtilesDirectory(entries)), .leaves = {}};
            if (whole.root.size() <= options_.maxRootBytes) return whole;
        }
        for (size_t leafEntries = options_.leafEntries;; leafEntries *= 2) {
            Directories split = splitEvery(leafEntries, list);
            if (split.root.size() <= options_.maxRootBytes) return split;
            TERRAY_CHECK_OP(leafEntries, <, count);
        }
    }

    /// Header, root directory, metadata and leaves, in this order.
    void write(OutputFile& archive, const Directories& directories, const std::string& metadata,
               const PmtilesHeader& header, const Counts& counts) const {
        const ByteView text = std::as_bytes(std::span(metadata));
        const Bytes packedMetadata = packed(Bytes(text.begin(), text.end()));
        PmtilesHeader full = header;
        full.rootOffset = kPmtilesHeaderBytes;
        full.rootLength = directories.root.size();
        full.metadataOffset = full.rootOffset + full.rootLength;
        full.metadataLength = packedMetadata.size();
        full.leavesOffset = full.metadataOffset + full.metadataLength;
        full.leavesLength = directories.leaves.size();
        full.tilesOffset = full.leavesOffset + full.leavesLength;
        full.tilesLength = counts.tileBytes;
        full.addressedTiles = counts.addressed;
        full.tileEntries = counts.entries;
        full.tileContents = counts.contents;
        full.clustered = true;
        full.internalCompression = options_.internalCompression;
        full.tileCompression = PmtilesCompression::none;
        full.tileType = 0;
        archive.write(encodePmtilesHeader(full));
        archive.write(directories.root);
        archive.write(packedMetadata);
        archive.write(directories.leaves);
    }

  private:
    [[nodiscard]] Bytes packed(Bytes bytes) const {
        if (options_.internalCompression == PmtilesCompression::none) return bytes;
        auto result = gzipCompress(bytes);
        if (!result.ok()) throw Error(ExitCode::unsupported, path_.string() + ": " + result.failure().message);
        return *std::move(result);
    }

    /// The entries in leaves of `leafEntries`, and a root that points to them.
    [[nodiscard]] Directories splitEvery(size_t leafEntries, const ListEntries& list) const {
        Directories directories;
        std::vector<PmtilesEntry> root;
        std::vector<PmtilesEntry> leaf;
        const auto finishLeaf = [&] {
            const Bytes bytes = packed(encodePmtilesDirectory(leaf));
            root.push_back({.tileId = leaf.front().tileId,
                            .offset = directories.leaves.size(),
                            .length = static_cast<uint32_t>(bytes.size()),
                            .runLength = 0});
            directories.leaves.insert(directories.leaves.end(), bytes.begin(), bytes.end());
            leaf.clear();
        };
        list([&](const PmtilesEntry& entry) {
            leaf.push_back(entry);
            if (leaf.size() == leafEntries) finishLeaf();
        });
        if (!leaf.empty()) finishLeaf();
        directories.root = packed(encodePmtilesDirectory(root));
        return directories;
    }

    std::filesystem::path path_;
    PmtilesWriteOptions options_;
};

}  // namespace

void writePmtiles(const std::filesystem::path& path, const std::string& metadata, const PmtilesHeader& header,
                  const PmtilesContents& contents, const PmtilesWriteOptions& options) {
    requireKnown(options);
    Counts counts;
    const ListEntries list = [&](const std::function<void(const PmtilesEntry&)>& tell) {
        counts = {};
        uint64_t next = 0;
        contents.list([&](const TileId& id, uint32_t length) {
            const uint64_t tile = hilbertId(id);
            TERRAY_CHECK_OP(length, >, 0U);
            TERRAY_CHECK_OP(tile, >=, next);
            next = tile + 1;
            tell({.tileId = tile, .offset = counts.tileBytes, .length = length, .runLength = 1});
            counts.tileBytes += length;
            ++counts.addressed;
        });
        counts.entries = counts.contents = counts.addressed;
    };
    list([](const PmtilesEntry&) {});
    TERRAY_CHECK_OP(counts.entries, >, 0U);  // the specification knows no empty directory

    const FrontMatter front(path, options);
    const Directories directories = front.directories(list, counts.entries);
    OutputFile archive(withSuffix(path, ".tmp"));
    front.write(archive, directories, metadata, header, counts);
    const uint64_t tilesOffset = archive.size();
    contents.payloads([&](ByteView payload) { archive.write(payload); });
    TERRAY_CHECK_OP(archive.size() - tilesOffset, ==, counts.tileBytes);
    archive.publish(path);
}

struct PmtilesWriter::State {
    State(std::filesystem::path target, Options writerOptions)
        : path(std::move(target)), options(writerOptions), tiles(withSuffix(path, ".tiles.tmp")) {}

    std::filesystem::path path;
    Options options;
    OutputFile tiles;
    std::vector<PmtilesEntry> entries;
    Bytes lastPayload;
    uint64_t addressed = 0;
    uint64_t contents = 0;
    bool finished = false;
};

PmtilesWriter::PmtilesWriter(std::filesystem::path path) : PmtilesWriter(std::move(path), Options()) {}

PmtilesWriter::PmtilesWriter(std::filesystem::path path, Options options) {
    requireKnown(options);
    state_ = std::make_unique<State>(std::move(path), options);
}

PmtilesWriter::~PmtilesWriter() = default;

void PmtilesWriter::add(const TileId& id, ByteView payload) {
    State& state = *state_;
    TERRAY_CHECK(!state.finished);
    TERRAY_CHECK_OP(payload.size(), >, 0U);
    TERRAY_CHECK_OP(payload.size(), <=, std::numeric_limits<uint32_t>::max());
    const uint64_t tile = hilbertId(id);
    PmtilesEntry* const last = state.entries.empty() ? nullptr : &state.entries.back();
    if (last != nullptr) TERRAY_CHECK_OP(tile, >=, last->tileId + last->runLength);

    ++state.addressed;
    const bool repeats = last != nullptr && std::ranges::equal(payload, state.lastPayload);
    if (repeats && tile == last->tileId + last->runLength) {
        ++last->runLength;
        return;
    }
    PmtilesEntry entry{.tileId = tile, .length = static_cast<uint32_t>(payload.size()), .runLength = 1};
    entry.offset = repeats ? last->offset : state.tiles.size();
    state.entries.push_back(entry);
    if (repeats) return;
    state.tiles.write(payload);
    state.lastPayload.assign(payload.begin(), payload.end());
    ++state.contents;
}

void PmtilesWriter::finish(const std::string& metadata, const PmtilesHeader& header) {
    State& state = *state_;
    TERRAY_CHECK(!state.finished);
    TERRAY_CHECK(!state.entries.empty());  // the specification knows no empty directory
    state.finished = true;

    const FrontMatter front(state.path, state.options);
    const ListEntries list = [&](const std::function<void(const PmtilesEntry&)>& tell) {
        for (const PmtilesEntry& entry : state.entries) tell(entry);
    };
    const Directories directories = front.directories(list, state.entries.size());
    OutputFile archive(withSuffix(state.path, ".tmp"));
    front.write(archive, directories, metadata, header,
                {.addressed = state.addressed,
                 .entries = state.entries.size(),
                 .contents = state.contents,
                 .tileBytes = state.tiles.size()});
    archive.append(state.tiles);
    archive.publish(state.path);
}

}  // namespace terray
