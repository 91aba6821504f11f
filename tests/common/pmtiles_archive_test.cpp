#include <cstring>
#include <map>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/pmtiles.h"
#include "common/pmtiles_gzip.h"
#include "tests/common/payload_faults.h"
#include "tests/common/random.h"
#include "tests/common/temporary_directory.h"

namespace terray {
namespace {

using test::Random;
using test::TemporaryDirectory;
using Tiles = std::map<uint64_t, Bytes>;  // by Hilbert id

/// An archive in memory; refuses what lies outside, as every source must.
class MemorySource final : public ByteSource {
  public:
    explicit MemorySource(Bytes bytes) : bytes_(std::move(bytes)) {}
    Result<Bytes> read(uint64_t offset, uint64_t length) const override {
        if (offset > bytes_.size() || length > bytes_.size() - offset) return Failure{"outside"};
        const auto first = bytes_.begin() + static_cast<ptrdiff_t>(offset);
        return Bytes(first, first + static_cast<ptrdiff_t>(length));
    }
    uint64_t size() const override { return bytes_.size(); }
    std::string name() const override { return "memory"; }

  private:
    Bytes bytes_;
};

Result<PmtilesReader> openBytes(Bytes bytes) {
    return PmtilesReader::open(std::make_unique<MemorySource>(std::move(bytes)));
}

Bytes randomPayload(Random& random) {
    Bytes payload(1 + random.below(300));
    for (std::byte& byte : payload) byte = static_cast<std::byte>(random.bits());
    return payload;
}

/// About every second tile of levels 0 to 5, many with the contents of the one before.
Tiles sampleTiles() {
    Random random(1);
    Tiles tiles;
    Bytes payload = randomPayload(random);
    for (uint64_t id = 0; id < 1365; ++id) {
        if (random.below(2) == 0) payload = randomPayload(random);
        if (random.below(3) != 0) tiles[id] = payload;
    }
    return tiles;
}

constexpr const char* kMetadata = R"({"name": "sample"})";

/// A header, zooms and bounds only, as a caller hands it to finish().
PmtilesHeader askedHeader() {
    PmtilesHeader header;
    header.maxZoom = 5;
    header.minLon = -10;
    header.maxLat = 20.5;
    return header;
}

void write(const std::filesystem::path& path, const Tiles& tiles, PmtilesWriter::Options options) {
    PmtilesWriter writer(path, options);
    for (const auto& [id, payload] : tiles) writer.add(*tileFromHilbert(id), payload);
    writer.finish(kMetadata, askedHeader());
}

Bytes archiveOf(const Tiles& tiles, PmtilesWriter::Options options = {}) {
    const TemporaryDirectory folder;
    write(folder / "a.pmtiles", tiles, options);
    return test::readFile(folder / "a.pmtiles");
}

/// Everything that a reader says of an archive equals the tiles that went in.
void expectHolds(const PmtilesReader& reader, const Tiles& tiles) {
    EXPECT_EQ(reader.metadata().value(), kMetadata);
    for (uint64_t id = 0; id < 1500; ++id) {
        const auto payload = reader.read(*tileFromHilbert(id));
        ASSERT_TRUE(payload.ok()) << payload.failure().message;
        const auto expected = tiles.find(id);
        ASSERT_EQ(payload->has_value(), expected != tiles.end()) << id;
        if (expected == tiles.end()) continue;
        ASSERT_EQ(payload->value(), expected->second) << id;
    }
    auto next = tiles.begin();
    const auto visited = reader.forEach([&](const TileId& id, uint64_t offset, uint32_t length) {
        ASSERT_NE(next, tiles.end());
        EXPECT_EQ(hilbertId(id), next->first);
        EXPECT_EQ(reader.source().read(offset, length).value(), next->second);
        ++next;
    });
    EXPECT_TRUE(visited.ok());
    EXPECT_EQ(next, tiles.end());
    EXPECT_EQ(reader.header().addressedTiles, tiles.size());
}

std::vector<PmtilesWriter::Options> everyKindOfArchive() {
    std::vector<PmtilesWriter::Options> kinds = {{}, {.maxRootBytes = 200, .leafEntries = 16}};
#if TERRAY_WITH_ZLIB
    kinds.push_back({.internalCompression = PmtilesCompression::gzip});
    kinds.push_back({.internalCompression = PmtilesCompression::gzip, .maxRootBytes = 200, .leafEntries = 16});
#endif
    return kinds;
}

TEST(PmtilesArchive, GivesBackWhatWentIn) {
    const Tiles tiles = sampleTiles();
    const TemporaryDirectory folder;
    for (const auto& options : everyKindOfArchive()) {
        write(folder / "a.pmtiles", tiles, options);
        EXPECT_EQ(folder.entries(), 1U);
        auto source = openFileSource(folder / "a.pmtiles");
        ASSERT_TRUE(source.ok());
        const auto reader = PmtilesReader::open(*std::move(source));
        ASSERT_TRUE(reader.ok()) << reader.failure().message;
        expectHolds(*reader, tiles);
        EXPECT_EQ(reader->header().internalCompression, options.internalCompression);
        EXPECT_EQ(reader->header().maxZoom, 5);
        EXPECT_EQ(reader->header().minLon, -10);
        EXPECT_EQ(reader->header().maxLat, 20.5);
    }
}

TEST(PmtilesArchive, SplitsItsDirectoryWhenTheRootWouldBeTooLarge) {
    const Tiles tiles = sampleTiles();
    const auto whole = openBytes(archiveOf(tiles));
    EXPECT_EQ(whole->header().leavesLength, 0U);
    const auto split = openBytes(archiveOf(tiles, {.maxRootBytes = 200, .leafEntries = 16}));
    EXPECT_GT(split->header().leavesLength, 0U);
    EXPECT_LE(split->header().rootLength, 200U);
    const auto one = openBytes(archiveOf(tiles, {.maxRootBytes = 10, .leafEntries = 1}));
    expectHolds(*one, tiles);
}

TEST(PmtilesArchive, KeepsTheRootWithinTheSpecificationsBound) {
    Tiles tiles;
    for (uint64_t id = 0; id < 30000; ++id) tiles[2 * id] = Bytes(1 + id % 3, static_cast<std::byte>(id));
    const auto reader = openBytes(archiveOf(tiles));
    ASSERT_TRUE(reader.ok());
    EXPECT_LE(reader->header().rootOffset + reader->header().rootLength, 16384U);
    EXPECT_GT(reader->header().leavesLength, 0U);
    uint64_t visited = 0;
    EXPECT_TRUE(reader->forEach([&](const TileId&, uint64_t, uint32_t) { ++visited; }).ok());
    EXPECT_EQ(visited, tiles.size());
}

TEST(PmtilesArchive, StoresEqualNeighboursOnce) {
    const Bytes a(100, std::byte{1}), b(100, std::byte{2});
    const auto reader = openBytes(archiveOf({{0, a}, {1, a}, {2, a}, {5, a}, {6, b}, {7, a}}));
    EXPECT_EQ(reader->header().tilesLength, 300U);
    EXPECT_EQ(reader->header().tileContents, 3U);
    EXPECT_EQ(reader->header().tileEntries, 4U);
    EXPECT_EQ(reader->header().addressedTiles, 6U);
    EXPECT_EQ(reader->read(*tileFromHilbert(5)).value(), a);
}

TEST(PmtilesArchive, IsTheSameForTheSameTiles) {
    for (const auto& options : everyKindOfArchive())
        EXPECT_EQ(archiveOf(sampleTiles(), options), archiveOf(sampleTiles(), options));
}

TEST(PmtilesArchive, OrdersItsSectionsAsTheSpecificationRecommends) {
    const Bytes bytes = archiveOf(sampleTiles(), {.maxRootBytes = 200, .leafEntries = 16});
    const auto header = decodePmtilesHeader(ByteView(bytes).first(kPmtilesHeaderBytes));
    EXPECT_EQ(header->rootOffset, kPmtilesHeaderBytes);
    EXPECT_EQ(header->metadataOffset, header->rootOffset + header->rootLength);
    EXPECT_EQ(header->leavesOffset, header->metadataOffset + header->metadataLength);
    EXPECT_EQ(header->tilesOffset, header->leavesOffset + header->leavesLength);
    EXPECT_EQ(bytes.size(), header->tilesOffset + header->tilesLength);
}

TEST(PmtilesArchive, RefusesEveryTruncation) {
    for (const auto& options : everyKindOfArchive())
        test::expectRefusesTruncations(
            archiveOf(sampleTiles(), options),
            [](ByteView bytes) { return openBytes(Bytes(bytes.begin(), bytes.end())).ok(); }, 300);
}

TEST(PmtilesArchive, NeverReadsOutsideItsSectionsWhateverIsDamaged) {
    Random random(4);
    const Tiles tiles = sampleTiles();
    for (const auto& options : everyKindOfArchive()) {
        const Bytes whole = archiveOf(tiles, options);
        const auto header = decodePmtilesHeader(ByteView(whole).first(kPmtilesHeaderBytes));
        for (int i = 0; i < 1500; ++i) {
            Bytes damaged = whole;
            for (uint64_t n = 1 + random.below(3); n > 0; --n)
                damaged[random.below(header->tilesOffset)] = static_cast<std::byte>(random.bits());
            const auto reader = openBytes(damaged);
            if (!reader.ok()) continue;
            for (int j = 0; j < 20; ++j) (void)reader->read(*tileFromHilbert(random.below(1500))).ok();
            (void)reader->metadata().ok();
            uint64_t visited = 0;
            (void)reader
                ->forEach([&](const TileId&, uint64_t offset, uint32_t length) {
                    ++visited;
                    EXPECT_LE(offset + length, damaged.size());
                })
                .ok();
            EXPECT_TRUE(reader->header().addressedTiles == 0 || visited <= reader->header().addressedTiles);
        }
    }
}

/// An archive of hand-made directories: `root` points into `leaves`, tiles are 100 bytes.
Bytes handMade(const std::vector<PmtilesEntry>& root, const Bytes& leaves) {
    const Bytes rootBytes = encodePmtilesDirectory(root);
    PmtilesHeader header;
    header.rootOffset = kPmtilesHeaderBytes;
    header.rootLength = rootBytes.size();
    header.leavesOffset = header.metadataOffset = header.rootOffset + header.rootLength;
    header.leavesLength = leaves.size();
    header.tilesOffset = header.leavesOffset + header.leavesLength;
    header.tilesLength = 100;
    ByteWriter out;
    out.writeBytes(encodePmtilesHeader(header));
    out.writeBytes(rootBytes);
    out.writeBytes(leaves);
    out.writeBytes(Bytes(100));
    return out.release();
}

TEST(PmtilesReader, FollowsThreeLeafLevelsAndNoMore) {
    for (int levels = 1; levels <= 5; ++levels) {
        // The innermost leaf holds the tile, each leaf before it points to the one inside.
        Bytes leaves = encodePmtilesDirectory({{7, 0, 100, 1}});
        PmtilesEntry pointer{.tileId = 7, .offset = 0, .length = static_cast<uint32_t>(leaves.size()), .runLength = 0};
        for (int level = 1; level < levels; ++level) {
            const Bytes outer = encodePmtilesDirectory({pointer});
            pointer = {
                .tileId = 7, .offset = leaves.size(), .length = static_cast<uint32_t>(outer.size()), .runLength = 0};
            leaves.insert(leaves.end(), outer.begin(), outer.end());
        }
        const auto reader = openBytes(handMade({pointer}, leaves));
        ASSERT_TRUE(reader.ok());
        const auto ignore = [](const TileId&, uint64_t, uint32_t) {};
        EXPECT_EQ(reader->read(*tileFromHilbert(7)).ok(), levels <= 3) << levels;
        EXPECT_EQ(reader->forEach(ignore).ok(), levels <= 3) << levels;
    }
}

TEST(PmtilesReader, RefusesALeafThatPointsToItself) {
    const Bytes leaf = encodePmtilesDirectory({{7, 0, 5, 0}});
    ASSERT_EQ(leaf.size(), 5U);
    const auto reader = openBytes(handMade({{7, 0, 5, 0}}, leaf));
    ASSERT_TRUE(reader.ok());
    EXPECT_FALSE(reader->read(*tileFromHilbert(7)).ok());
    EXPECT_FALSE(reader->forEach([](const TileId&, uint64_t, uint32_t) {}).ok());
}

TEST(PmtilesReader, RefusesTilesAndLeavesOutsideTheirSections) {
    const auto failsToRead = [](const std::vector<PmtilesEntry>& root) {
        const auto reader = openBytes(handMade(root, Bytes(10)));
        return reader.ok() && !reader->read(*tileFromHilbert(7)).ok() &&
               !reader->forEach([](const TileId&, uint64_t, uint32_t) {}).ok();
    };
    EXPECT_TRUE(failsToRead({{7, 1, 100, 1}}));
    EXPECT_TRUE(failsToRead({{7, 101, 1, 1}}));
    EXPECT_TRUE(failsToRead({{7, 0, 0xFFFFFFFF, 1}}));
    EXPECT_TRUE(failsToRead({{7, 5, 6, 0}}));
    EXPECT_TRUE(failsToRead({{7, uint64_t{1} << 60, 6, 0}}));
    EXPECT_FALSE(failsToRead({{7, 0, 100, 1}}));
}

TEST(PmtilesReader, RefusesTilesBeyondTheLastLevel) {
    const auto reader = openBytes(handMade({{6148914691236517200, 0, 100, 10}}, {}));
    ASSERT_TRUE(reader.ok());
    EXPECT_FALSE(reader->forEach([](const TileId&, uint64_t, uint32_t) {}).ok());
}

/// A web server that claims to hold a terabyte; what is asked of it must stay small.
class VastSource final : public ByteSource {
  public:
    explicit VastSource(Bytes start) : start_(std::move(start)) {}
    Result<Bytes> read(uint64_t offset, uint64_t length) const override {
        EXPECT_LE(length, uint64_t{64} << 20);
        if (offset + length <= start_.size())
            return Bytes(start_.begin(), start_.begin() + static_cast<ptrdiff_t>(length));
        return Failure{"nothing there"};
    }
    uint64_t size() const override { return uint64_t{1} << 40; }
    std::string name() const override { return "vast"; }

  private:
    Bytes start_;
};

TEST(PmtilesReader, RefusesAnAbsurdDirectoryBeforeReadingIt) {
    PmtilesHeader header;
    header.rootOffset = kPmtilesHeaderBytes;
    header.rootLength = uint64_t{1} << 39;
    const auto reader = PmtilesReader::open(std::make_unique<VastSource>(encodePmtilesHeader(header)));
    ASSERT_FALSE(reader.ok());
    EXPECT_NE(reader.failure().message.find("549755813888 bytes"), std::string::npos) << reader.failure().message;
}

TEST(PmtilesReader, ServesSeveralThreads) {
    const Tiles tiles = sampleTiles();
    const TemporaryDirectory folder;
    write(folder / "a.pmtiles", tiles, {.maxRootBytes = 200, .leafEntries = 16});
    const auto reader = PmtilesReader::open(*openFileSource(folder / "a.pmtiles"));
    ASSERT_TRUE(reader.ok());
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i)
        threads.emplace_back([&, i] {
            Random random(static_cast<uint64_t>(i));
            for (int j = 0; j < 2000; ++j) {
                const uint64_t id = random.below(1365);
                const auto payload = reader->read(*tileFromHilbert(id));
                ASSERT_TRUE(payload.ok());
                ASSERT_EQ(payload->has_value(), tiles.contains(id));
            }
        });
    for (std::thread& thread : threads) thread.join();
}

TEST(PmtilesReader, LocatesTheBytesThatItReads) {
    const TemporaryDirectory directory;
    const Tiles tiles = sampleTiles();
    write(directory / "a.pmtiles", tiles, {.maxRootBytes = 200, .leafEntries = 16});
    const auto reader = PmtilesReader::open(openFileSource(directory / "a.pmtiles").value()).value();
    for (uint64_t hilbert = 0; hilbert < 1400; ++hilbert) {
        const auto range = reader.locate(*tileFromHilbert(hilbert)).value();
        const auto tile = tiles.find(hilbert);
        ASSERT_EQ(tile != tiles.end(), range.has_value()) << hilbert;
        if (range) {
            EXPECT_EQ(tile->second, reader.source().read(range->offset, range->length).value()) << hilbert;
        }
    }
}

TEST(FileSource, SaysWhatItCannotOpen) {
    const TemporaryDirectory folder;
    const auto missing = openFileSource(folder / "missing.pmtiles");
    ASSERT_FALSE(missing.ok());
    EXPECT_NE(missing.failure().message.find("missing.pmtiles: No such file"), std::string::npos);
    EXPECT_NE(openFileSource(folder.path()).failure().message.find("Is a directory"), std::string::npos);
    EXPECT_FALSE(openFileSource("/dev/null").ok());
}

TEST(FileSource, RefusesReadsBeyondItsEnd) {
    const TemporaryDirectory folder;
    std::ofstream(folder / "ten") << "0123456789";
    const auto source = openFileSource(folder / "ten");
    ASSERT_TRUE(source.ok());
    EXPECT_EQ((*source)->size(), 10U);
    EXPECT_EQ((*source)->read(3, 7)->size(), 7U);
    EXPECT_TRUE((*source)->read(10, 0).ok());
    EXPECT_FALSE((*source)->read(3, 8).ok());
    EXPECT_FALSE((*source)->read(11, 0).ok());
    EXPECT_FALSE((*source)->read(1, ~uint64_t{0}).ok());
    EXPECT_FALSE((*source)->read(~uint64_t{0}, 2).ok());
}

TEST(PmtilesReader, RefusesWhatIsNoArchive) {
    EXPECT_FALSE(openBytes({}).ok());
    EXPECT_NE(openBytes(Bytes(1000)).failure().message.find("not a PMTiles archive"), std::string::npos);
}

TEST(PmtilesWriter, LeavesNothingBehindWithoutFinish) {
    const TemporaryDirectory folder;
    {
        PmtilesWriter writer(folder / "a.pmtiles");
        writer.add({0, 0, 0}, Bytes(5000000, std::byte{1}));
        EXPECT_TRUE(std::filesystem::exists(folder / "a.pmtiles.tiles.tmp"));
    }
    EXPECT_EQ(folder.entries(), 0U);
}

TEST(PmtilesWriter, ReplacesAnArchiveOnlyWhenFinished) {
    const TemporaryDirectory folder;
    const auto path = folder / "a.pmtiles";
    write(path, {{0, Bytes(10)}}, {});
    const Bytes before = test::readFile(path);
    { PmtilesWriter(path).add({0, 0, 0}, Bytes(20)); }
    EXPECT_EQ(test::readFile(path), before);
    write(path, {{0, Bytes(20)}}, {});
    EXPECT_NE(test::readFile(path), before);
}

TEST(PmtilesWriter, ThrowsWhereItCannotWrite) {
    const TemporaryDirectory folder;
    try {
        PmtilesWriter writer(folder / "missing/a.pmtiles");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::output);
    }
}

TEST(PmtilesWriter, ThrowsAndCleansUpWhenTheDiskIsFull) {
    const TemporaryDirectory folder;
    std::filesystem::create_symlink("/dev/full", folder / "a.pmtiles.tmp");
    try {
        write(folder / "a.pmtiles", sampleTiles(), {});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::output);
    }
    EXPECT_EQ(folder.entries(), 0U);
}

TEST(WritePmtiles, MakesTheSameArchiveAsTheWriter) {
    Tiles tiles = sampleTiles();
    for (auto& [id, payload] : tiles) {  // no two alike
        payload.resize(payload.size() + 8);
        std::memcpy(payload.data() + payload.size() - 8, &id, 8);
    }
    const TemporaryDirectory folder;
    const PmtilesContents contents = {.list =
                                          [&](const auto& tell) {
                                              for (const auto& [id, payload] : tiles)
                                                  tell(*tileFromHilbert(id), static_cast<uint32_t>(payload.size()));
                                          },
                                      .payloads =
                                          [&](const auto& write) {
                                              for (const auto& [id, payload] : tiles) write(payload);
                                          }};
    for (const PmtilesWriteOptions options :
         {PmtilesWriteOptions{}, {.maxRootBytes = 100, .leafEntries = 4}, {.maxRootBytes = 700, .leafEntries = 32}}) {
        writePmtiles(folder / "b.pmtiles", kMetadata, askedHeader(), contents, options);
        EXPECT_EQ(test::readFile(folder / "b.pmtiles"), archiveOf(tiles, options));
        EXPECT_EQ(folder.entries(), 1u);
    }
    const PmtilesContents broken = {.list = contents.list,
                                    .payloads = [](const auto&) { throw Error(ExitCode::interrupted, "stopped"); }};
    EXPECT_THROW(writePmtiles(folder / "c.pmtiles", kMetadata, askedHeader(), broken), Error);
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(PmtilesWriterDeathTest, StopsOnMisuse) {
    const TemporaryDirectory folder;
    PmtilesWriter writer(folder / "a.pmtiles");
    writer.add({1, 0, 1}, Bytes(1));
    EXPECT_DEATH(writer.add({1, 0, 0}, Bytes(1)), "tile");
    EXPECT_DEATH(writer.add({1, 0, 1}, Bytes(1)), "tile");
    EXPECT_DEATH(writer.add({1, 1, 1}, {}), "payload");
    EXPECT_DEATH(PmtilesWriter(folder / "b").finish("{}", {}), "empty");
}

#if TERRAY_WITH_ZLIB

TEST(Gzip, RoundTripsAndRefusesEveryTruncation) {
    Random random(6);
    for (const size_t size : {0, 1, 5000, 300000}) {
        Bytes bytes(size);
        for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.below(4));
        const Bytes packed = *gzipCompress(bytes);
        EXPECT_EQ(*gzipDecompress(packed, size), bytes);
        const auto accepts = [&](ByteView view) { return gzipDecompress(view, size).ok(); };
        test::expectRefusesTruncations(packed, accepts, 100);
        test::expectRefusesExtraBytes(packed, accepts);
    }
}

TEST(Gzip, StopsABombAtTheLimit) {
    const Bytes packed = *gzipCompress(Bytes(50000000));
    EXPECT_LT(packed.size(), 100000U);
    EXPECT_FALSE(gzipDecompress(packed, 49999999).ok());
    EXPECT_FALSE(gzipDecompress(packed, 0).ok());
    EXPECT_TRUE(gzipDecompress(packed, 50000000).ok());
}

#else

TEST(Gzip, SaysThatThisBuildHasNone) {
    const TemporaryDirectory folder;
    EXPECT_NE(gzipCompress({}).failure().message.find("TERRAY_WITH_ZLIB"), std::string::npos);
    try {
        write(folder / "a.pmtiles", sampleTiles(), {.internalCompression = PmtilesCompression::gzip});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::unsupported);
    }
    EXPECT_EQ(folder.entries(), 0U);
}

#endif

}  // namespace
}  // namespace terray
