#include "preprocess/work_file.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/tiling.h"
#include "preprocess/level_store.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

TEST(WorkFile, StaysForAnotherRunUntilItIsDiscarded) {
    const TemporaryDirectory directory;
    const Bytes bytes = {std::byte{1}, std::byte{2}, std::byte{3}};
    WorkFile(directory / "a").write(1000, bytes);
    WorkFile file(directory / "a");
    EXPECT_EQ(file.size(), 1003u);
    Bytes back(3);
    file.read(1000, back);
    EXPECT_EQ(back, bytes);
    EXPECT_THROW(file.read(1001, back), Error);
    file.truncate(1001);
    EXPECT_THROW(file.read(1000, back), Error);
    EXPECT_EQ(directory.names(), std::vector<std::string>{"a"});
    file.discard();
    EXPECT_TRUE(directory.names().empty());
}

TEST(WorkFile, NamesFileAndReasonWhenItCannotBeMade) {
    try {
        const WorkFile file("/nonexistent/directory/file");
        FAIL() << "made a file in a directory that is not there";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::output);
        EXPECT_NE(std::string(error.what()).find("/nonexistent/directory/file: No such file"), std::string::npos);
    }
}

TEST(LevelStore, ReturnsWindowsAcrossTilesAndFillsTheRest) {
    const TemporaryDirectory directory;
    LevelStore store(directory / "level", {0, 0, 3, 2}, 2, -1.0f);
    const auto value = [](int64_t x, int64_t y, int plane) {
        return static_cast<float>(x + 2000 * y + 7000000 * plane);
    };
    for (const auto& [tileX, tileY] : {std::pair<int64_t, int64_t>(0, 0), {1, 0}, {2, 1}}) {
        std::array<Grid<float>, 2> planes = {Grid<float>({kTileCore, kTileCore}), Grid<float>({kTileCore, kTileCore})};
        for (int plane = 0; plane < 2; ++plane)
            for (int64_t y = 0; y < kTileCore; ++y)
                for (int64_t x = 0; x < kTileCore; ++x)
                    planes[static_cast<size_t>(plane)].at(x, y) =
                        value(tileX * kTileCore + x, tileY * kTileCore + y, plane);
        store.write(tileX, tileY, std::array<GridView<const float>, 2>{planes[0].view(), planes[1].view()});
        EXPECT_FALSE(store.has(tileX, tileY));
        store.take(tileX, tileY);
    }
    const auto stored = [](int64_t x, int64_t y) {
        if (x < 0 || y < 0) return false;
        const std::pair tile(x / kTileCore, y / kTileCore);
        return tile == std::pair<int64_t, int64_t>(0, 0) || tile == std::pair<int64_t, int64_t>(1, 0) ||
               tile == std::pair<int64_t, int64_t>(2, 1);
    };
    for (const GridRect window : {GridRect{-5, -5, 1600, 1100}, GridRect{500, 500, 30, 30}, GridRect{1020, 510, 10, 8},
                                  GridRect{5000, 0, 4, 4}, GridRect{-9, -9, 4, 4}, GridRect{1535, 1023, 1, 1}}) {
        for (int plane = 0; plane < 2; ++plane) {
            Grid<float> out({window.width, window.height});
            store.read(window, plane, out.view());
            int64_t wrong = 0;
            for (int64_t y = 0; y < window.height; ++y)
                for (int64_t x = 0; x < window.width; ++x) {
                    const int64_t column = window.x + x;
                    const int64_t row = window.y + y;
                    if (out.at(x, y) != (stored(column, row) ? value(column, row, plane) : -1.0f)) ++wrong;
                }
            EXPECT_EQ(wrong, 0);
        }
    }
    EXPECT_TRUE(store.has(2, 1));
    EXPECT_FALSE(store.has(0, 1));
    EXPECT_FALSE(store.has(3, 0));
}

TEST(LevelStore, ReachesOnlyAsFarAsItsTiles) {
    const TemporaryDirectory directory;
    // A billion tiles before the first: a file of their size could not be made.
    const GridRect tiles = {1000000000, 500000000, 2, 1};
    LevelStore store(directory / "level", tiles, 1, -1.0f);
    const Grid<float> fives({kTileCore, kTileCore}, 5.0f);
    store.write(tiles.x + 1, tiles.y, std::array{fives.view()});
    store.take(tiles.x + 1, tiles.y);
    EXPECT_TRUE(store.has(tiles.x + 1, tiles.y));
    EXPECT_FALSE(store.has(tiles.x, tiles.y));
    EXPECT_FALSE(store.has(0, 0));
    Grid<float> out({3, 1});
    store.read({(tiles.x + 1) * kTileCore - 1, tiles.y * kTileCore, 3, 1}, 0, out.view());
    EXPECT_EQ(out.at(0, 0), -1.0f);
    EXPECT_EQ(out.at(1, 0), 5.0f);
    EXPECT_EQ(out.at(2, 0), 5.0f);
    EXPECT_LE(std::filesystem::file_size(directory / "level"), size_t{2} * kTileCore * kTileCore * sizeof(float));
}

}  // namespace
}  // namespace terray
