#include "preprocess/height_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "common/error.h"
#include "common/parallel.h"
#include "preprocess/height_samples.h"
#include "preprocess/level_store.h"
#include "preprocess/surface_deviation.h"

namespace terray {
namespace {

/// Fine rows that a later stage reads from the store at a time; even.
constexpr int64_t kBandRows = 64;

/// The level between two stages: its samples and its tiles' records.
struct StoredLevel {
    static constexpr int kPlanes = 4;  ///< mean, lowest, highest, deviation

    LevelStore samples;
    Grid<HeightRecord> records;

    StoredLevel(const std::filesystem::path& path, GridSize tiles)
        : samples(path, {0, 0, tiles.width, tiles.height}, kPlanes, kNoHeight), records(tiles) {}
};

/// A block in work.
struct Block {
    BlockStage stage;
    BlockRecord& record;                      ///< what it leaves
    Grid<float> finest;                       ///< the source's samples, first stage only
    std::vector<HeightSamples> levels;        ///< [i] lies i + 1 levels above the bottom
    std::vector<Grid<HeightRecord>> records;  ///< [i] lies i levels above the bottom, by tile within the block

    [[nodiscard]] GridRect window() const { return blockWindow(stage, record.top, kHeightApron); }
    /// Samples of the level `above` the bottom. Finest samples are their own bounds.
    [[nodiscard]] HeightViews views(uint32_t above) const {
        if (above == 0) return {finest.view(), finest.view(), finest.view()};
        return levels[above - 1].views();
    }
    /// Where the block's own cells lie in these samples: those of all of its tiles.
    [[nodiscard]] GridRect core(uint32_t above) const {
        const int64_t margin = int64_t{kHeightApron} << (stage.depth - above);
        return {margin, margin, kTileCore * tilesAcross(above), kTileCore * tilesAcross(above)};
    }
    [[nodiscard]] int64_t tilesAcross(uint32_t above) const { return int64_t{1} << (stage.depth - above); }
    [[nodiscard]] TileId tile(uint32_t above, int64_t column, int64_t row) const {
        const int64_t across = tilesAcross(above);
        return {stage.bottom - above, static_cast<uint32_t>(record.top.x * across + column),
                static_cast<uint32_t>(record.top.y * across + row)};
    }
};

class HeightPyramid {
  public:
    HeightPyramid(const HeightSource& source, const HeightPrecision& precision, PyramidBlocks& blocks,
                  BuildContext& context)
        : source_(source),
          precision_(precision),
          blocks_(blocks),
          context_(context),
          extent_(heightExtent(source.info())),
          readers_(static_cast<size_t>(context.jobs)) {
        totals_.levelErrors.resize(extent_.finestLevel + 1, 0);
        totals_.minHeight = std::numeric_limits<double>::infinity();
        totals_.maxHeight = -std::numeric_limits<double>::infinity();
    }

    HeightTotals build(uint32_t depth) {
        for (const BlockStage& stage : planStages(extent_.finestLevel, depth)) {
            above_.reset();
            if (stage.top() > 0)
                above_ = std::make_unique<StoredLevel>(
                    context_.workDirectory / ("heights-" + std::to_string(stage.top())), extent_.tilesAt(stage.top()));
            std::function<void()> begin;
            if (stage.first) begin = [&] { prepareSource(); };
            blocks_.runStage(stage,
                             {.begin = begin,
                              .build = [&](BlockRecord& record, int worker) { buildBlock(stage, record, worker); },
                              .take = [&](const BlockRecord& record) { take(record); },
                              .level = above_ ? &above_->samples.file() : nullptr});
            if (stage.first) releaseSource();
            if (below_) blocks_.discard(below_->samples.file());
            std::swap(below_, above_);
        }
        if (totals_.tiles == 0)
            throw Error(ExitCode::input, "the source holds no valid height: all of its samples are nodata");
        return totals_;
    }

  private:
    void prepareSource() {
        const StepTimer timer(context_.times, BuildStep::read);
        blocks_.prepare(source_);
    }
    void releaseSource() {
        for (auto& reader : readers_) reader.reset();
        blocks_.release();
    }

    void buildBlock(const BlockStage& stage, BlockRecord& record, int worker) {
        Block block{.stage = stage, .record = record, .finest = {}, .levels = {}, .records = {}};
        record.levelErrors.resize(stage.depth + 1, 0);
        const bool hasSurface = stage.first ? readSource(block, worker) : readBelow(block);
        if (!hasSurface) return;
        if (!stage.first) boundFirstDeviations(block);
        halveUpwards(block);
        for (uint32_t above = 0; above <= stage.depth; ++above) {
            block.records.emplace_back(GridSize{block.tilesAcross(above), block.tilesAcross(above)});
            if (above == 0 && !stage.first)
                copyRecords(block);
            else
                makeTiles(block, above);
        }
        handOver(block);
    }

    /// @return whether the block's core has any surface
    bool readSource(Block& block, int worker) {
        const GridRect window = block.window();
        block.finest = Grid<float>({window.width, window.height});
        {
            std::unique_ptr<HeightReader>& reader = readers_[static_cast<size_t>(worker)];
            if (!reader) reader = source_.openReader();
            const StepTimer timer(context_.times, reader->resamples() ? BuildStep::warp : BuildStep::read);
            reader->read(window, block.finest.view());
        }
        const StepTimer timer(context_.times, BuildStep::reduce);
        clean(block.finest, window);
        return countHoles(block);
    }

    /// Turns what is no number into holes, and refuses what cannot be ground.
    static void clean(Grid<float>& heights, const GridRect& window) {
        for (int64_t y = 0; y < heights.height(); ++y) {
            const std::span<float> row = heights.view().row(y);
            for (size_t x = 0; x < row.size(); ++x) {
                if (!std::isfinite(row[x])) row[x] = kNoHeight;
                if (std::abs(row[x]) > kGreatestHeight)
                    throw Error(ExitCode::input, "height " + std::to_string(static_cast<double>(row[x])) +
                                                     " m at column " +
                                                     std::to_string(window.x + static_cast<int64_t>(x)) + ", row " +
                                                     std::to_string(window.y + y) +
                                                     " is no ground on any planet; if it stands for missing data, "
                                                     "name it with --nodata");
            }
        }
    }

    bool countHoles(const Block& block) {
        const GridRect window = block.window();
        const GridRect core = intersection(grown(window, -(int64_t{kHeightApron} << block.stage.depth)),
                                           {0, 0, extent_.samples.width, extent_.samples.height});
        const GridRect inside = {core.x - window.x, core.y - window.y, core.width, core.height};
        const GridView<const float> heights = block.finest.view().window(inside);
        int64_t holes = 0;
        for (int64_t y = 0; y < heights.height(); ++y)
            holes += std::ranges::count_if(heights.row(y), [](float height) { return std::isnan(height); });
        block.record.holeSamples = static_cast<uint64_t>(holes);
        return holes < core.width * core.height;
    }

    /// Halves the stored level in bands, so that it never lies in memory as a whole.
    bool readBelow(Block& block) {
        if (!anyTileBelow(block)) return false;
        const GridRect window = block.window();
        HeightSamples& coarse = block.levels.emplace_back(GridSize{window.width / 2, window.height / 2});
        HeightSamples band(GridSize{window.width, kBandRows});
        for (int64_t row = 0; row < window.height; row += kBandRows) {
            const int64_t rows = std::min(kBandRows, window.height - row);
            const GridRect part = {0, 0, window.width, rows};
            const GridRect from = {window.x, window.y + row, window.width, rows};
            {
                const StepTimer timer(context_.times, BuildStep::read);
                below_->samples.read(from, 0, band.mean.view().window(part));
                below_->samples.read(from, 1, band.lowest.view().window(part));
                below_->samples.read(from, 2, band.highest.view().window(part));
            }
            const StepTimer timer(context_.times, BuildStep::reduce);
            halveHeights(band.views().window(part), coarse, row / 2);
        }
        return true;
    }

    [[nodiscard]] bool anyTileBelow(const Block& block) const {
        for (int64_t row = 0; row < block.tilesAcross(0); ++row)
            for (int64_t column = 0; column < block.tilesAcross(0); ++column)
                if (recordBelow(block.tile(0, column, row)).exists) return true;
        return false;
    }

    [[nodiscard]] HeightRecord recordBelow(const TileId& id) const {
        if (id.x >= below_->records.width() || id.y >= below_->records.height()) return {};
        return below_->records.at(id.x, id.y);
    }

    void halveUpwards(Block& block) {
        const StepTimer timer(context_.times, BuildStep::reduce);
        while (block.levels.size() < block.stage.depth) {
            const HeightViews fine = block.views(static_cast<uint32_t>(block.levels.size()));
            HeightSamples coarse(GridSize{fine.mean.width() / 2, fine.mean.height() / 2});
            halveHeights(fine, coarse);
            block.levels.push_back(std::move(coarse));
            boundTopDeviations(block, fine);
        }
    }

    /// Of the level that was made last. @param fine  the one below it
    static void boundTopDeviations(Block& block, const HeightViews& fine) {
        const auto above = static_cast<uint32_t>(block.levels.size());
        const GridRect core = block.core(above), fineCore = block.core(above - 1);
        HeightSamples& coarse = block.levels.back();
        const bool finest = fine.deviation.size().count() == 0;
        boundDeviations({.coarse = coarse.views().window(grown(core, 1)),
                         .fine = fine.mean.window(grown(fineCore, 2)),
                         .fineDeviation = finest ? fine.deviation : fine.deviation.window(fineCore)},
                        coarse.deviation.view().window(core));
    }

    /// The same for the level above the stored one, which is read in bands again: rows around each are needed now.
    void boundFirstDeviations(Block& block) const {
        const GridRect window = block.window(), core = block.core(1);
        HeightSamples& coarse = block.levels.front();
        Grid<float> fine(GridSize{2 * (core.width + 2), kBandRows + 4});
        Grid<float> deviation(GridSize{2 * core.width, kBandRows});
        for (int64_t row = 0; row < core.height; row += kBandRows / 2) {
            const GridRect band = {core.x, core.y + row, core.width, kBandRows / 2};
            const GridRect beneath = {window.x + 2 * band.x, window.y + 2 * band.y, 2 * band.width, 2 * band.height};
            {
                const StepTimer timer(context_.times, BuildStep::read);
                below_->samples.read(grown(beneath, 2), 0, fine.view());
                below_->samples.read(beneath, 3, deviation.view());
            }
            const StepTimer timer(context_.times, BuildStep::reduce);
            boundDeviations({.coarse = coarse.views().window(grown(band, 1)),
                             .fine = fine.view(),
                             .fineDeviation = deviation.view()},
                            coarse.deviation.view().window(band));
        }
    }

    void copyRecords(Block& block) const {
        for (int64_t row = 0; row < block.tilesAcross(0); ++row)
            for (int64_t column = 0; column < block.tilesAcross(0); ++column)
                block.records[0].at(column, row) = recordBelow(block.tile(0, column, row));
    }

    void makeTiles(Block& block, uint32_t above) {
        const GridSize tiles = extent_.tilesAt(block.stage.bottom - above);
        for (int64_t row = 0; row < block.tilesAcross(above); ++row) {
            for (int64_t column = 0; column < block.tilesAcross(above); ++column) {
                const TileId id = block.tile(above, column, row);
                if (id.x >= tiles.width || id.y >= tiles.height) continue;
                throwIfStopped(context_.stop);
                block.records[above].at(column, row) = makeTile(block, above, column, row);
            }
        }
    }

    HeightRecord makeTile(const Block& block, uint32_t above, int64_t column, int64_t row) {
        const GridRect core = coreInBlock(block.stage, above, kHeightApron, column, row);
        const HeightViews level = block.views(above);
        HeightTileInput input{.id = block.tile(above, column, row),
                              .mean = level.mean.window(grown(core, kHeightApron)),
                              .core = level.window(core),
                              .quantum = precision_.quantum};
        if (above > 0)
            for (uint32_t quadrant = 0; quadrant < 4; ++quadrant)
                input.children[quadrant] =
                    block.records[above - 1].at(2 * column + (quadrant & 1), 2 * row + (quadrant >> 1));

        Bytes payload;
        HeightRecord record;
        {
            const StepTimer timer(context_.times, BuildStep::encode);
            const std::optional<HeightTile> tile = makeHeightTile(input);
            if (!tile) return {};
            if (input.id.level == extent_.finestLevel) keepPrecision(*tile, block.record);
            record = tile->record;
            payload = encodeHeightTile(*tile);
        }
        measure(block, record, input.id.level);
        blocks_.store(block.record, input.id, payload);
        return record;
    }

    /// Holds a finest tile against the error that was asked for, and notes the width of its steps.
    void keepPrecision(const HeightTile& tile, BlockRecord& record) const {
        const double step = tile.encoding.metresPerCode();
        record.finestStep = std::max(record.finestStep, step);
        constexpr double kRounding = 1 + 1e-9;  // of twice the error, which is the quantum
        if (!precision_.maxError || step / 2 <= *precision_.maxError * kRounding) return;
        throw Error(ExitCode::input, "the heights of tile " + toString(tile.id) + " reach from " +
                                         std::to_string(tile.record.minHeight) + " to " +
                                         std::to_string(tile.record.maxHeight) + " m: its 16-bit codes come within " +
                                         std::to_string(step / 2) + " m of each, not within the " +
                                         std::to_string(*precision_.maxError) +
                                         " m of --max-height-error; allow as much, or leave the option out");
    }

    /// Adds a tile to what its block says of all of its tiles.
    static void measure(const Block& block, const HeightRecord& tile, uint32_t level) {
        BlockRecord& record = block.record;
        const bool isFirst = record.tiles.empty();
        record.minHeight = isFirst ? tile.minHeight : std::min(record.minHeight, tile.minHeight);
        record.maxHeight = isFirst ? tile.maxHeight : std::max(record.maxHeight, tile.maxHeight);
        float& error = record.levelErrors[level - block.stage.top()];
        error = std::max(error, tile.error);
    }

    /// Gives the block's top level to the stage above.
    void handOver(const Block& block) {
        block.record.topRecord = block.records.back().at(0, 0);
        if (!above_ || !block.record.topRecord.exists) return;
        const StepTimer timer(context_.times, BuildStep::write);
        const HeightViews core =
            block.views(block.stage.depth).window(coreInBlock(block.stage, block.stage.depth, kHeightApron, 0, 0));
        above_->samples.write(block.record.top.x, block.record.top.y,
                              std::array{core.mean, core.lowest, core.highest, core.deviation});
    }

    /// Adds a finished block to the totals and to what the stage above may read.
    void take(const BlockRecord& record) {
        totals_.holeSamples += record.holeSamples;
        if (record.tiles.empty()) return;
        totals_.tiles += record.tiles.size();
        totals_.finestStep = std::max(totals_.finestStep, record.finestStep);
        totals_.minHeight = std::min(totals_.minHeight, static_cast<double>(record.minHeight));
        totals_.maxHeight = std::max(totals_.maxHeight, static_cast<double>(record.maxHeight));
        for (size_t i = 0; i < record.levelErrors.size(); ++i) {
            double& error = totals_.levelErrors.at(record.top.level + i);
            error = std::max(error, static_cast<double>(record.levelErrors[i]));
        }
        if (!above_ || !record.topRecord.exists) return;
        above_->samples.take(record.top.x, record.top.y);
        above_->records.at(record.top.x, record.top.y) = record.topRecord;
    }

    const HeightSource& source_;
    HeightPrecision precision_;
    PyramidBlocks& blocks_;
    BuildContext& context_;
    PyramidExtent extent_;
    std::vector<std::unique_ptr<HeightReader>> readers_;  ///< one for each worker, opened at its first block
    std::unique_ptr<StoredLevel> below_;                  ///< read by the running stage
    std::unique_ptr<StoredLevel> above_;                  ///< written by it
    HeightTotals totals_;
};

}  // namespace

PyramidExtent heightExtent(const HeightGridInfo& info) {
    return {Tiling::levelFor(std::max(info.size.width, info.size.height)), info.size};
}

HeightTotals buildHeightPyramid(const HeightSource& source, uint32_t depth, const HeightPrecision& precision,
                                PyramidBlocks& blocks, BuildContext& context) {
    return HeightPyramid(source, precision, blocks, context).build(depth);
}

}  // namespace terray
