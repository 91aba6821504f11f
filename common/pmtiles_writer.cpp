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

std::filesystem::path withSuffix(const std::filesystem::path& path, const char* suffix) {
    return path.string() + suffix;
}

}  // namespace

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

    [[nodiscard]] Bytes packed(Bytes bytes) const {
        if (options.internalCompression == PmtilesCompression::none) return bytes;
        auto result = gzipCompress(bytes);
        if (!result.ok()) throw Error(ExitCode::unsupported, path.string() + ": " + result.failure().message);
        return *std::move(result);
    }

    /// The entries in leaves of `leafEntries`, and a root that points to them.
    [[nodiscard]] Directories splitEvery(size_t leafEntries) const {
        Directories directories;
        std::vector<PmtilesEntry> root;
        for (size_t start = 0; start < entries.size(); start += leafEntries) {
            const size_t end = std::min(start + leafEntries, entries.size());
            const Bytes leaf = packed(encodePmtilesDirectory(
                {entries.begin() + static_cast<ptrdiff_t>(start), entries.begin() + static_cast<ptrdiff_t>(end)}));
            root.push_back({.tileId = entries[start].tileId,
                            .offset = directories.leaves.size(),
                            .length = static_cast<uint32_t>(leaf.size()),
                            .runLength = 0});
            directories.leaves.insert(directories.leaves.end(), leaf.begin(), leaf.end());
        }
        directories.root = packed(encodePmtilesDirectory(root));
        return directories;
    }

    /// One directory if it fits the root's bound, else leaves that double until their root does.
    [[nodiscard]] Directories directories() const {
        Directories result{.root = packed(encodePmtilesDirectory(entries)), .leaves = {}};
        size_t leafEntries = options.leafEntries;
        while (result.root.size() > options.maxRootBytes) {
            result = splitEvery(leafEntries);
            TERRAY_CHECK(result.root.size() <= options.maxRootBytes || leafEntries < entries.size());
            leafEntries *= 2;
        }
        return result;
    }
};

PmtilesWriter::PmtilesWriter(std::filesystem::path path) : PmtilesWriter(std::move(path), Options()) {}

PmtilesWriter::PmtilesWriter(std::filesystem::path path, Options options) {
    TERRAY_CHECK_OP(options.leafEntries, >, 0U);
    const bool known = options.internalCompression == PmtilesCompression::none ||
                       options.internalCompression == PmtilesCompression::gzip;
    TERRAY_CHECK(known);
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

    const Directories directories = state.directories();
    const ByteView text = std::as_bytes(std::span(metadata));
    const Bytes packedMetadata = state.packed(Bytes(text.begin(), text.end()));

    PmtilesHeader full = header;
    full.rootOffset = kPmtilesHeaderBytes;
    full.rootLength = directories.root.size();
    full.metadataOffset = full.rootOffset + full.rootLength;
    full.metadataLength = packedMetadata.size();
    full.leavesOffset = full.metadataOffset + full.metadataLength;
    full.leavesLength = directories.leaves.size();
    full.tilesOffset = full.leavesOffset + full.leavesLength;
    full.tilesLength = state.tiles.size();
    full.addressedTiles = state.addressed;
    full.tileEntries = state.entries.size();
    full.tileContents = state.contents;
    full.clustered = true;
    full.internalCompression = state.options.internalCompression;
    full.tileCompression = PmtilesCompression::none;
    full.tileType = 0;

    OutputFile archive(withSuffix(state.path, ".tmp"));
    archive.write(encodePmtilesHeader(full));
    archive.write(directories.root);
    archive.write(packedMetadata);
    archive.write(directories.leaves);
    archive.append(state.tiles);
    archive.publish(state.path);
}

}  // namespace terray
