// What an archive's header says of the ground, and what a reader refuses to believe of its counts.

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "common/error.h"
#include "preprocess/dataset_archives.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

PmtilesHeader headerOf(const std::optional<GroundRect>& lonLatBounds) {
    DatasetMetadata metadata;
    metadata.lonLatBounds = lonLatBounds;
    return archiveHeader(metadata, 4);
}

TEST(ArchiveHeader, IsCentredOnItsBounds) {
    const PmtilesHeader header = headerOf(GroundRect{-106, 37, -105, 38});
    EXPECT_EQ(header.minZoom, 0);
    EXPECT_EQ(header.maxZoom, 4);
    EXPECT_EQ(header.centerLon, -105.5);
    EXPECT_EQ(header.centerLat, 37.5);
    EXPECT_EQ(headerOf({}).centerLon, 0);
}

// The mean of 179 and -179 is 0, on the other side of the earth.
TEST(ArchiveHeader, IsCentredOnItsBoundsAcrossTheAntimeridian) {
    EXPECT_EQ(headerOf(GroundRect{178, -18, -179, -16}).centerLon, 179.5);
    EXPECT_EQ(headerOf(GroundRect{179, -18, -178, -16}).centerLon, -179.5);
    EXPECT_EQ(std::abs(headerOf(GroundRect{179, -18, -179, -16}).centerLon), 180);
}

TEST(OpenDataset, RefusesMoreTilesThanTheBytesCanHold) {
    const TemporaryDirectory directory;
    const std::filesystem::path out = directory / "out";
    (void)buildTestDataset(GridHeights(makeHills({40, 30}, 1, 0)), out);
    for (const uint64_t tiles : {uint64_t{0}, uint64_t{1} << 40}) {
        constexpr std::streamoff kAddressedTiles = 72;  // offset in the header, by the specification
        std::fstream file(out / kHeightsFile, std::ios::binary | std::ios::in | std::ios::out);
        file.seekp(kAddressedTiles);
        file.write(reinterpret_cast<const char*>(&tiles), sizeof tiles);
        file.close();
        try {
            (void)openDataset(out);
            ADD_FAILURE() << "opened with " << tiles << " tiles";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::dataset);
            EXPECT_NE(std::string(error.what()).find("cannot be"), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace terray
