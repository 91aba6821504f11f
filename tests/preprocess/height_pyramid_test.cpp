// The height pyramid against a naive one: all samples in memory, all means in double, all errors by brute force.

#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "preprocess/block_plan.h"
#include "preprocess/verify_dataset.h"
#include "tests/common/random.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Every level of some heights in double, without blocks, margins or files.
class NaivePyramid {
  public:
    explicit NaivePyramid(const Grid<float>& heights)
        : finest_(Tiling::levelFor(std::max(heights.width(), heights.size().height))), source_(heights) {
        levels_.resize(finest_ + 1);
        Grid<double> level(heights.size());
        for (size_t i = 0; i < heights.cells().size(); ++i) level.cells()[i] = static_cast<double>(heights.cells()[i]);
        levels_[finest_] = level;
        for (uint32_t l = finest_; l-- > 0;) levels_[l] = halved(levels_[l + 1]);
    }
    [[nodiscard]] uint32_t finest() const { return finest_; }
    [[nodiscard]] GridSize size(uint32_t level) const { return levels_[level].size(); }
    /// Height of a sample; NaN for holes and beyond the edge.
    [[nodiscard]] double at(uint32_t level, int64_t x, int64_t y) const { return valueAt(levels_[level], x, y); }
    /// Greatest distance of `height` from the source samples beneath a sample of a level.
    [[nodiscard]] double deviation(uint32_t level, int64_t x, int64_t y, double height) const {
        const int64_t side = int64_t{1} << (finest_ - level);
        double greatest = 0;
        for (int64_t row = y * side; row < std::min((y + 1) * side, source_.size().height); ++row)
            for (int64_t column = x * side; column < std::min((x + 1) * side, source_.width()); ++column)
                if (const double sample = static_cast<double>(source_.at(column, row)); !std::isnan(sample))
                    greatest = std::max(greatest, std::abs(sample - height));
        return greatest;
    }

  private:
    static double valueAt(const Grid<double>& level, int64_t x, int64_t y) {
        const bool inside = x >= 0 && y >= 0 && x < level.width() && y < level.size().height;
        return inside ? level.at(x, y) : kNone;
    }
    static Grid<double> halved(const Grid<double>& fine) {
        Grid<double> coarse({(fine.width() + 1) / 2, (fine.size().height + 1) / 2}, kNone);
        for (int64_t y = 0; y < coarse.size().height; ++y)
            for (int64_t x = 0; x < coarse.width(); ++x) {
                double sum = 0;
                int count = 0;
                for (int64_t quadrant = 0; quadrant < 4; ++quadrant) {
                    const double value = valueAt(fine, 2 * x + (quadrant & 1), 2 * y + (quadrant >> 1));
                    if (std::isnan(value)) continue;
                    sum += value;
                    ++count;
                }
                if (count > 0) coarse.at(x, y) = sum / count;
            }
        return coarse;
    }

    uint32_t finest_;
    const Grid<float>& source_;
    std::vector<Grid<double>> levels_;
};

/// Checks one tile, or the absence of one, against the naive pyramid.
class TileCheck {
  public:
    TileCheck(const NaivePyramid& naive, const std::map<TileId, HeightTile>& tiles) : naive_(naive), tiles_(tiles) {}

    void check(const TileId& id) const {
        SCOPED_TRACE(toString(id));
        const auto found = tiles_.find(id);
        ASSERT_EQ(found != tiles_.end(), hasSurface(id));
        if (found == tiles_.end()) return;
        checkCells(found->second);
        checkRecords(found->second);
    }

  private:
    [[nodiscard]] bool hasSurface(const TileId& id) const {
        const GridRect core = Tiling::coreSamples(id);
        for (int64_t y = 0; y < kTileCore; ++y)
            for (int64_t x = 0; x < kTileCore; ++x)
                if (!std::isnan(naive_.at(id.level, core.x + x, core.y + y))) return true;
        return false;
    }

    void checkCells(const HeightTile& tile) const {
        const GridRect cells = grown(Tiling::coreSamples(tile.id), kHeightApron);
        int64_t wrong = 0;
        double ofColumns = 0, ofRounding = 0;
        for (int64_t y = 0; y < cells.height; ++y)
            for (int64_t x = 0; x < cells.width; ++x) {
                const double expected = naive_.at(tile.id.level, cells.x + x, cells.y + y);
                const uint16_t code = tile.codes.at(x, y);
                if ((code == kNoSurface) != std::isnan(expected)) ++wrong;
                if (code == kNoSurface || std::isnan(expected)) continue;
                const double height = tile.encoding.height(code);
                if (std::abs(height - expected) > tolerance(tile, expected)) ++wrong;
                const double deviation = naive_.deviation(tile.id.level, cells.x + x, cells.y + y, height);
                constexpr GridRect kCore = {kHeightApron, kHeightApron, kTileCore, kTileCore};
                if (isWithin(kCore, x, y)) ofColumns = std::max(ofColumns, deviation);
                if (isWithin(grown(kCore, 1), x, y)) ofRounding = std::max(ofRounding, deviation);
            }
        EXPECT_EQ(wrong, 0);
        // Of surfaces between samples: SurfaceError. A finest tile's are off by its codes alone.
        if (tile.id.level == naive_.finest())
            EXPECT_EQ(tile.record.error, floatAtLeast(ofRounding));
        else
            EXPECT_GE(tile.record.error, floatAtLeast(ofColumns));
    }

    static bool isWithin(const GridRect& rect, int64_t x, int64_t y) {
        return !intersection(rect, {x, y, 1, 1}).empty();
    }

    /// Half a code step, and half a float step (2^-24 of the height) for each level's rounding of means.
    [[nodiscard]] double tolerance(const HeightTile& tile, double height) const {
        const uint32_t halvings = naive_.finest() - tile.id.level;
        return tile.encoding.metresPerCode() / 2 * (1 + 1e-9) + std::abs(height) * std::ldexp(halvings, -24);
    }

    void checkRecords(const HeightTile& tile) const {
        EXPECT_EQ(tile.record, measureRecord(tile.codes, tile.encoding, tile.record.error));
        for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
            const auto child = tiles_.find(tile.id.child(quadrant));
            EXPECT_EQ(tile.children[quadrant], child == tiles_.end() ? HeightRecord{} : child->second.record);
        }
    }

    const NaivePyramid& naive_;
    const std::map<TileId, HeightTile>& tiles_;
};

/// Where two tiles of a level share samples, each has them to half a step of its own codes, and both or none of them.
void checkAprons(const std::map<TileId, HeightTile>& tiles) {
    const auto compare = [](const HeightTile& a, const HeightTile& b, int64_t right, int64_t down) {
        const double limit = (a.encoding.metresPerCode() + b.encoding.metresPerCode()) / 2 * (1 + 1e-9);
        int64_t wrong = 0;
        for (int64_t y = 0; y < kHeightTileSide - down * kTileCore; ++y)
            for (int64_t x = 0; x < kHeightTileSide - right * kTileCore; ++x) {
                const uint16_t one = a.codes.at(x + right * kTileCore, y + down * kTileCore);
                const uint16_t other = b.codes.at(x, y);
                if ((one == kNoSurface) != (other == kNoSurface))
                    ++wrong;
                else if (one != kNoSurface && std::abs(a.encoding.height(one) - b.encoding.height(other)) > limit)
                    ++wrong;
            }
        EXPECT_EQ(wrong, 0) << a.id << " and " << b.id;
    };
    for (const auto& [id, tile] : tiles)
        for (const auto& [right, down] : {std::pair<uint32_t, uint32_t>(1, 0), {0, 1}, {1, 1}}) {
            const auto neighbour = tiles.find({id.level, id.x + right, id.y + down});
            if (neighbour != tiles.end()) compare(tile, neighbour->second, right, down);
        }
}

struct Case {
    GridSize size;
    int holes;  ///< of 1000 samples
    uint32_t depth;
    int jobs;
};

const std::atomic<bool> kNeverStop = false;

void checkHeights(Grid<float> heights, const TestBuild& build) {
    const GridHeights source(std::move(heights));
    const TemporaryDirectory directory;
    const BuildSummary summary = buildTestDataset(source, directory / "out", build);
    const NaivePyramid naive(source.heights_);
    const auto tiles = readHeightTiles(directory / "out");
    ASSERT_EQ(summary.metadata.tiling.finestLevel, naive.finest());
    for (uint32_t level = 0; level <= naive.finest(); ++level) {
        const GridSize count = PyramidExtent{naive.finest(), source.heights_.size()}.tilesAt(level);
        for (int64_t y = 0; y < count.height; ++y)
            for (int64_t x = 0; x < count.width; ++x)
                TileCheck(naive, tiles).check({level, static_cast<uint32_t>(x), static_cast<uint32_t>(y)});
    }
    checkAprons(tiles);
    EXPECT_EQ(summary.metadata.heightTiles, tiles.size());
    const auto isHole = [](float height) { return std::isnan(height); };
    EXPECT_EQ(summary.metadata.holeSamples,
              static_cast<uint64_t>(std::ranges::count_if(source.heights_.cells(), isHole)));
    EXPECT_EQ(verifyDataset(openDataset(directory / "out"), 2, kNeverStop).faults.size(), 0u);
}

void checkCase(const Case& test) {
    SCOPED_TRACE(testing::Message() << test.size.width << " x " << test.size.height << ", depth " << test.depth);
    checkHeights(makeHills(test.size, 7, test.holes), {.jobs = test.jobs, .depth = test.depth});
}

/// Makes holes of rectangles anywhere, also beyond the edge; one sample stays.
void punch(Grid<float>& heights, test::Random& random, uint64_t rectangles) {
    for (uint64_t i = 0; i < rectangles; ++i) {
        const auto anywhere = [&](int64_t cells) { return static_cast<int64_t>(random.below(cells + 200)) - 100; };
        const GridRect hole =
            intersection({anywhere(heights.width()), anywhere(heights.size().height),
                          static_cast<int64_t>(random.below(700)), static_cast<int64_t>(random.below(700))},
                         {0, 0, heights.width(), heights.size().height});
        for (int64_t y = hole.y; y < hole.y + hole.height; ++y)
            for (int64_t x = hole.x; x < hole.x + hole.width; ++x) heights.at(x, y) = kNoHeight;
    }
    heights.at(0, 0) = 7;
}

TEST(HeightPyramid, EqualsTheNaiveOneForAnySizeHolesAndBlocks) {
    test::Random random(2026);
    for (int i = 0; i < 14; ++i) {
        // Half of the sides around the tile's or its double, where one sample more makes a tile more.
        const auto side = [&] {
            const uint64_t edge = 512 * (1 + random.below(2));
            return static_cast<int64_t>(random.below(2) == 0 ? edge - 3 + random.below(7) : 1 + random.below(1400));
        };
        const GridSize size{side(), side()};
        const TestBuild build{.jobs = static_cast<int>(1 + random.below(3)),
                              .depth = static_cast<uint32_t>(1 + random.below(3))};
        SCOPED_TRACE(testing::Message() << "case " << i << ": " << size.width << " x " << size.height << ", depth "
                                        << build.depth);
        Grid<float> heights = makeHills(size, random.below(1000), static_cast<int>(random.below(20)));
        punch(heights, random, random.below(5));
        checkHeights(std::move(heights), build);
    }
}
TEST(HeightPyramid, EqualsTheNaiveOneForOddThousands) {
    test::Random random(3);
    Grid<float> heights = makeHills({3001, 1777}, 9, 2);
    punch(heights, random, 6);
    checkHeights(std::move(heights), {.jobs = 2, .depth = 2});
}
TEST(HeightPyramid, EqualsTheNaiveOneForASingleSample) {
    checkCase({{1, 1}, 0, 1, 1});
}
TEST(HeightPyramid, EqualsTheNaiveOneForARowAndAColumn) {
    checkCase({{1, 700}, 0, 1, 1});
    checkCase({{700, 1}, 0, 1, 2});
}
TEST(HeightPyramid, EqualsTheNaiveOneAroundTheTileSide) {
    for (const int64_t side : {511, 512, 513}) checkCase({{side, side}, 0, 1, 2});
}
TEST(HeightPyramid, EqualsTheNaiveOneForAStrip) {
    checkCase({{1025, 37}, 0, 2, 1});
}
TEST(HeightPyramid, EqualsTheNaiveOneWithHoles) {
    checkCase({{1300, 600}, 1, 2, 2});
    checkCase({{1300, 600}, 500, 1, 2});
    checkCase({{600, 1100}, 998, 2, 1});
}
TEST(HeightPyramid, EqualsTheNaiveOneThroughSeveralStages) {
    for (const uint32_t depth : {1u, 2u, 3u}) checkCase({{4100, 70}, 3, depth, 2});
}

TEST(HeightPyramid, SkipsTilesWithoutSurface) {
    // Surface in the north-west tile and in one sample of the south-east corner; 3 of the 4 x 4 tiles' worth is
    // nothing.
    Grid<float> heights({2048, 2048}, kNoHeight);
    for (int64_t y = 0; y < 100; ++y)
        for (int64_t x = 0; x < 100; ++x) heights.at(x, y) = 10;
    heights.at(2047, 2047) = 20;
    const GridHeights source(heights);
    for (const uint32_t depth : {1u, 2u}) {
        const TemporaryDirectory directory;
        const BuildSummary summary = buildTestDataset(source, directory / "out", {.depth = depth});
        const auto tiles = readHeightTiles(directory / "out");
        std::vector<TileId> ids;
        for (const auto& [id, tile] : tiles) ids.push_back(id);
        EXPECT_EQ(ids, (std::vector<TileId>{{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {2, 0, 0}, {2, 3, 3}}));
        EXPECT_EQ(summary.metadata.holeSamples, 2048u * 2048u - 100 * 100 - 1);
        EXPECT_EQ(tiles.at({0, 0, 0}).children[1], HeightRecord{});
        EXPECT_EQ(verifyDataset(openDataset(directory / "out"), 1, kNeverStop).faults.size(), 0u);
    }
}

TEST(HeightPyramid, NeighboursAgreeOnSharedSamples) {
    const GridHeights source(makeHills({1500, 1200}, 3, 2));
    const TemporaryDirectory directory;
    (void)buildTestDataset(source, directory / "out", {.depth = 1});
    const auto tiles = readHeightTiles(directory / "out");
    int64_t compared = 0;
    for (const auto& [id, tile] : tiles) {
        const auto east = tiles.find({id.level, id.x + 1, id.y});
        if (east == tiles.end() || east->second.encoding.exponent != tile.encoding.exponent) continue;
        for (int64_t y = 0; y < kHeightTileSide; ++y)
            for (int64_t x = 0; x < 2 * kHeightApron; ++x) {
                const uint16_t here = tile.codes.at(kTileCore + x, y);
                const uint16_t there = east->second.codes.at(x, y);
                ASSERT_EQ(here == kNoSurface, there == kNoSurface);
                if (here == kNoSurface) continue;
                ASSERT_EQ(tile.encoding.height(here), east->second.encoding.height(there));
                ++compared;
            }
    }
    EXPECT_GT(compared, 4 * 1200);
}

TEST(HeightPyramid, IsByteIdenticalForAnyJobsAndBlockDepth) {
    const GridHeights source(makeHills({2100, 1500}, 5, 2));
    const TemporaryDirectory directory;
    (void)buildTestDataset(source, directory / "reference", {.jobs = 1, .depth = 3});
    const Bytes reference = readFile(directory / "reference" / kHeightsFile);
    for (const TestBuild build : {TestBuild{.jobs = 1, .depth = 1}, TestBuild{.jobs = 2, .depth = 1},
                                  TestBuild{.jobs = 7, .depth = 2}, TestBuild{.jobs = 2, .depth = 3}}) {
        const std::string name = std::to_string(build.jobs) + "-" + std::to_string(build.depth);
        (void)buildTestDataset(source, directory / name, build);
        EXPECT_EQ(readFile(directory / name / kHeightsFile), reference) << name;
    }
}

}  // namespace
}  // namespace terray
