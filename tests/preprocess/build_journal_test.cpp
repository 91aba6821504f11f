#include "preprocess/build_journal.h"

#include <thread>

#include <gtest/gtest.h>

#include "preprocess/block_record.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

Bytes content(size_t length, int seed) {
    Bytes bytes(length);
    for (size_t i = 0; i < length; ++i) bytes[i] = static_cast<std::byte>(i * 7 + static_cast<size_t>(seed));
    return bytes;
}

std::vector<Bytes> entriesOf(const BuildJournal& journal) {
    std::vector<Bytes> entries;
    journal.forEach([&](uint64_t place, ByteView bytes) {
        entries.emplace_back(bytes.begin(), bytes.end());
        EXPECT_EQ(journal.read(place), entries.back());
    });
    return entries;
}

class Journal : public testing::Test {
  protected:
    /// Writes three entries of 5, 100 and 1 bytes.
    void writeThree() const {
        BuildJournal journal(path_);
        EXPECT_TRUE(journal.empty());
        EXPECT_EQ(journal.commit(content(5, 1), {}), 0u);
        EXPECT_EQ(journal.commit(content(100, 2), {}), 13u);
        EXPECT_EQ(journal.commit(content(1, 3), {}), 121u);
    }

    TemporaryDirectory directory_;
    std::filesystem::path path_ = directory_ / "journal";
    std::vector<Bytes> three_ = {content(5, 1), content(100, 2), content(1, 3)};
};

TEST_F(Journal, ReturnsItsEntriesInOrderToTheNextRun) {
    writeThree();
    BuildJournal journal(path_);
    EXPECT_FALSE(journal.empty());
    EXPECT_EQ(entriesOf(journal), three_);
}

TEST_F(Journal, CutsOffAnEntryThatIsNotWholeAndGoesOnThere) {
    writeThree();
    const Bytes whole = readFile(path_);
    for (size_t length = 0; length < whole.size(); ++length) {
        writeFile(path_, ByteView(whole).first(length));
        const size_t kept = length < 13 ? 0 : length < 121 ? 1 : 2;
        BuildJournal journal(path_);
        const std::vector<Bytes> entries = entriesOf(journal);
        ASSERT_EQ(entries.size(), kept) << length;
        EXPECT_TRUE(std::equal(entries.begin(), entries.end(), three_.begin()));
        journal.commit(content(9, 4), {});
        EXPECT_EQ(entriesOf(journal).back(), content(9, 4));
        EXPECT_EQ(entriesOf(BuildJournal(path_)).size(), kept + 1);
    }
}

TEST_F(Journal, NoFlippedBitAndNoZerosBecomeAnEntry) {
    writeThree();
    const Bytes whole = readFile(path_);
    for (size_t bit = 0; bit < 8 * whole.size(); ++bit) {
        Bytes damaged = whole;
        damaged[bit / 8] ^= static_cast<std::byte>(1 << (bit % 8));
        writeFile(path_, damaged);
        const size_t kept = bit < 8 * 13 ? 0 : bit < 8 * 121 ? 1 : 2;
        EXPECT_EQ(entriesOf(BuildJournal(path_)).size(), kept) << bit;
    }
    Bytes padded = whole;
    padded.resize(whole.size() + 4096);
    writeFile(path_, padded);
    EXPECT_EQ(entriesOf(BuildJournal(path_)), three_);
    EXPECT_EQ(readFile(path_), whole);
}

TEST_F(Journal, TakesEntriesFromManyThreads) {
    constexpr int kThreads = 8;
    constexpr int kEach = 20;
    {
        BuildJournal journal(path_);
        WorkFile data(directory_ / "data");
        WorkFile* const files[] = {&data};
        std::vector<std::jthread> threads;
        for (int thread = 0; thread < kThreads; ++thread)
            threads.emplace_back([&, thread] {
                for (int i = 0; i < kEach; ++i) {
                    const Bytes bytes = content(static_cast<size_t>(thread + 1), i);
                    EXPECT_EQ(journal.read(journal.commit(bytes, files)), bytes);
                }
            });
    }
    std::vector<int> next(kThreads, 0);
    for (const Bytes& entry : entriesOf(BuildJournal(path_)))
        EXPECT_EQ(entry, content(entry.size(), next.at(entry.size() - 1)++));
    EXPECT_EQ(next, std::vector<int>(kThreads, kEach));
}

BlockRecord sampleRecord() {
    return {.pyramid = Pyramid::imagery,
            .bottom = 7,
            .top = {4, 3, 11},
            .tiles = {{{7, 30, 90}, uint64_t{5} << 40, 123}, {{4, 3, 11}, 0, 7}},
            .topRecord = {.exists = true, .hasHoles = true, .minHeight = -3.5f, .maxHeight = 8, .error = 0.25f},
            .holeSamples = uint64_t{1} << 50,
            .minHeight = -4,
            .maxHeight = 9,
            .levelErrors = {1, 0.5f, 0.25f, 0.005f},
            .finestStep = 0.01};
}

TEST(BlockRecord, ComesBackAsItWas) {
    const BlockRecord record = sampleRecord();
    EXPECT_EQ(decodeBlockRecord(encodeBlockRecord(record)).value(), record);
    EXPECT_EQ(decodeBlockRecord(encodeBlockRecord({})).value(), BlockRecord{});
    EXPECT_EQ(record.payloadBytes(), 130u);
}

TEST(BlockRecord, SortsItsTilesCoarseLevelsFirst) {
    BlockRecord record = sampleRecord();
    record.sortTiles();
    EXPECT_EQ(record.tiles.front().id, (TileId{4, 3, 11}));
}

TEST(BlockRecord, RefusesEveryTruncationAndExtraBytes) {
    const Bytes whole = encodeBlockRecord(sampleRecord());
    for (size_t length = 0; length < whole.size(); ++length)
        EXPECT_FALSE(decodeBlockRecord(Bytes(whole.begin(), whole.begin() + static_cast<ptrdiff_t>(length))).ok());
    Bytes longer = whole;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(decodeBlockRecord(longer).ok());
    Bytes absurd = whole;
    for (size_t i = 48; i < 52; ++i) absurd[i] = std::byte{0xff};  // the count of errors
    EXPECT_FALSE(decodeBlockRecord(absurd).ok());
}

}  // namespace
}  // namespace terray
