#include "client/stream/dataset_source.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/stream/fake_dataset.h"

namespace terray::test {
namespace {

const FakeDataset& tinyDataset() {
    static const FakeDataset dataset =
        buildDataset([](int64_t x, int64_t) { return 10.0 + 0.1 * static_cast<double>(x % 9); },
                     {.samples = {600, 40}, .imageryLevel = 1});
    return dataset;
}

template <class Tiles, class Encode>
void writeArchive(const std::filesystem::path& path, const Tiles& tiles, const std::string& metadata, uint8_t finest,
                  Encode encode) {
    std::vector<TileId> ids;
    for (const auto& [id, tile] : tiles) ids.push_back(id);
    std::sort(ids.begin(), ids.end(), [](const TileId& a, const TileId& b) { return hilbertId(a) < hilbertId(b); });
    PmtilesWriter writer(path);
    for (const TileId& id : ids) writer.add(id, encode(tiles.at(id)));
    writer.finish(metadata, {.minZoom = 0, .maxZoom = finest});
}

class LocalDatasetTest : public ::testing::Test {
  protected:
    void SetUp() override {
        directory_ =
            std::filesystem::temp_directory_path() /
            ("terray_dataset_test_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
        std::filesystem::remove_all(directory_);
        std::filesystem::create_directories(directory_);
    }
    void TearDown() override { std::filesystem::remove_all(directory_); }

    void writeHeights(const DatasetMetadata& metadata, uint8_t finest = 1) const {
        writeArchive(directory_ / kHeightsFile, tinyDataset().heights, toJson(metadata).dump(), finest,
                     encodeHeightTile);
    }
    void writeImagery(const DatasetMetadata& metadata) const {
        writeArchive(directory_ / kImageryFile, tinyDataset().imagery, toJson(metadata).dump(), 1, encodeImageryTile);
    }
    /// The message of the Error(dataset) that opening ends with.
    std::string why() const {
        try {
            (void)openLocalDataset(directory_);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::dataset);
            return error.what();
        }
        return "";
    }
    void expectRefused(const std::string& because) const {
        const std::string message = why();
        EXPECT_NE(message.find(because), std::string::npos) << message;
        EXPECT_NE(message.find(';'), std::string::npos) << "and what to do: " << message;
    }

    std::filesystem::path directory_;
};

TEST_F(LocalDatasetTest, ServesWhatWasWritten) {
    const FakeDataset& dataset = tinyDataset();
    writeHeights(dataset.metadata);
    writeImagery(dataset.metadata);
    const auto source = openLocalDataset(directory_);
    EXPECT_EQ(source->metadata(), dataset.metadata);
    for (const auto& [id, tile] : dataset.heights)
        EXPECT_EQ(*source->read(TileLayer::heights, id), encodeHeightTile(tile));
    for (const auto& [id, tile] : dataset.imagery)
        EXPECT_EQ(*source->read(TileLayer::imagery, id), encodeImageryTile(tile));
    const auto missing = source->read(TileLayer::heights, {1, 0, 1});
    ASSERT_FALSE(missing.ok());
    EXPECT_NE(missing.failure().message.find("1/0/1"), std::string::npos);
}

TEST_F(LocalDatasetTest, HashFollowsTheContent) {
    DatasetMetadata metadata = tinyDataset().metadata;
    writeHeights(metadata);
    writeImagery(metadata);
    const std::string first = openLocalDataset(directory_)->contentHash();
    EXPECT_EQ(openLocalDataset(directory_)->contentHash(), first);
    metadata.options = "other";
    writeHeights(metadata);
    writeImagery(metadata);
    EXPECT_NE(openLocalDataset(directory_)->contentHash(), first);
}

TEST_F(LocalDatasetTest, RefusesWhatIsNoDataset) {
    expectRefused("heights.pmtiles");
    std::filesystem::remove_all(directory_);
    expectRefused("no such directory");
}

TEST_F(LocalDatasetTest, RefusesTruncatedAndForeignArchives) {
    std::ofstream(directory_ / kHeightsFile) << "hello";
    expectRefused("cannot open dataset");
    writeArchive(directory_ / kHeightsFile, tinyDataset().heights, "{\"name\":\"somebody's map\"}", 1,
                 encodeHeightTile);
    EXPECT_NE(why(), "");
    writeHeights(tinyDataset().metadata);
    writeImagery(tinyDataset().metadata);
    std::filesystem::resize_file(directory_ / kHeightsFile, std::filesystem::file_size(directory_ / kHeightsFile) - 1);
    expectRefused("cannot open dataset");
}

TEST_F(LocalDatasetTest, RefusesArchivesThatDisagree) {
    DatasetMetadata metadata = tinyDataset().metadata;
    writeHeights(metadata);
    expectRefused("imagery.pmtiles");
    metadata.tool = "another run";
    writeImagery(metadata);
    expectRefused("not built together");
    metadata = tinyDataset().metadata;
    metadata.imageryLevel.reset();
    metadata.imageryTiles = 0;
    writeHeights(metadata);
    expectRefused("knows no imagery");
}

TEST_F(LocalDatasetTest, RefusesAHeaderThatContradictsTheMetadata) {
    DatasetMetadata metadata = tinyDataset().metadata;
    writeHeights(metadata, 2);
    expectRefused("finest level 2");
    ++metadata.heightTiles;
    writeHeights(metadata);
    expectRefused("tile count");
    metadata = tinyDataset().metadata;
    metadata.lonLatBounds = {7, 46, 8, 47};  // the header's are all zero
    writeHeights(metadata);
    expectRefused("bounds");
}

}  // namespace
}  // namespace terray::test
