#include <set>

#include <gtest/gtest.h>

#include "common/pmtiles.h"
#include "tests/common/temporary_directory.h"

namespace terray {
namespace {

constexpr uint64_t kIds = 1365;  // all tiles of levels 0 to 5; every third is left out

bool hasTile(uint64_t id) {
    return id % 3 != 1;
}
Bytes payloadOf(uint64_t id) {
    return Bytes(1 + id % 70, static_cast<std::byte>(id));
}

/// An archive with leaf directories of 16 entries.
class PmtilesLookup : public testing::Test {
  protected:
    void SetUp() override {
        PmtilesWriter writer(folder_ / "a.pmtiles", {.maxRootBytes = 200, .leafEntries = 16});
        for (uint64_t id = 0; id < kIds; ++id)
            if (hasTile(id)) writer.add(*tileFromHilbert(id), payloadOf(id));
        writer.finish("{}", {.maxZoom = 5});
        file_ = *openFileSource(folder_ / "a.pmtiles");
        reader_.emplace(*PmtilesReader::open(*openFileSource(folder_ / "a.pmtiles")));
    }
    Bytes bytesOf(const ByteRange& range) const { return *file_->read(range.offset, range.length); }

    test::TemporaryDirectory folder_;
    std::unique_ptr<ByteSource> file_;
    std::optional<PmtilesReader> reader_;
};

TEST_F(PmtilesLookup, AsksForEachLeafOnceAndThenForTheTile) {
    std::set<uint64_t> leaves;
    for (uint64_t id = 0; id < kIds; ++id) {
        auto lookup = reader_->lookUp(*tileFromHilbert(id));
        ASSERT_TRUE(lookup.ok());
        while (lookup->range() && lookup->isLeaf()) {
            EXPECT_TRUE(leaves.insert(lookup->range()->offset).second) << "a leaf that is held was asked for again";
            ASSERT_TRUE(lookup->takeLeaf(bytesOf(*lookup->range())).ok());
        }
        ASSERT_EQ(lookup->range().has_value(), hasTile(id)) << id;
        if (!hasTile(id)) continue;
        EXPECT_EQ(bytesOf(*lookup->range()), payloadOf(id)) << id;
        EXPECT_EQ(**reader_->read(*tileFromHilbert(id)), payloadOf(id)) << id;
    }
    EXPECT_GT(leaves.size(), 4U);
}

TEST_F(PmtilesLookup, RefusesALeafThatIsNoDirectory) {
    auto lookup = reader_->lookUp(*tileFromHilbert(700));
    ASSERT_TRUE(lookup.ok() && lookup->isLeaf());
    EXPECT_FALSE(lookup->takeLeaf(Bytes(lookup->range()->length, std::byte{0xff})).ok());
    EXPECT_FALSE(lookup->takeLeaf({}).ok());
    EXPECT_EQ(**reader_->read(*tileFromHilbert(700 / 3 * 3)), payloadOf(700 / 3 * 3)) << "and goes on after that";
}

}  // namespace
}  // namespace terray
