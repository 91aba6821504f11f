#include "preprocess/imagery_pyramid.h"

#include <algorithm>
#include <memory>

#include "common/error.h"
#include "common/imagery_tile.h"
#include "common/parallel.h"
#include "preprocess/bc1.h"
#include "preprocess/colour_samples.h"
#include "preprocess/level_store.h"
#include "preprocess/raster_layout.h"

namespace terray {
namespace {

/// Fine rows that a later stage reads from the store at a time; even.
constexpr int64_t kBandRows = 64;

/// A block in work.
struct Block {
    BlockStage stage;
    BlockRecord& record;                ///< what it leaves
    Grid<Rgba> finest;                  ///< the source's texels, first stage only
    std::vector<ColourSamples> levels;  ///< [i] lies i + 1 levels above the bottom
    std::vector<Grid<uint8_t>> exists;  ///< [i] lies i levels above the bottom: which tiles have photo

    [[nodiscard]] GridRect window() const { return blockWindow(stage, record.top, kImageryGutter); }
    [[nodiscard]] int64_t tilesAcross(uint32_t above) const { return int64_t{1} << (stage.depth - above); }
    [[nodiscard]] TileId tile(uint32_t above, int64_t column, int64_t row) const {
        const int64_t across = tilesAcross(above);
        return {stage.bottom - above, static_cast<uint32_t>(record.top.x * across + column),
                static_cast<uint32_t>(record.top.y * across + row)};
    }
    [[nodiscard]] bool photoIn(uint32_t above, const GridRect& rect) const {
        return above == 0 ? anyPhoto(finest.view().window(rect)) : anyPhoto(levels[above - 1].views().window(rect));
    }
    [[nodiscard]] Grid<Rgba> shown(uint32_t above, const GridRect& rect) const {
        return above == 0 ? shownColours(finest.view().window(rect))
                          : shownColours(levels[above - 1].views().window(rect));
    }
};

/// The coarser mips of the root, as blocks one after the other: its core halved again and again, in a gutter of neutral
/// ground, since nothing lies beyond the root.
class RootMips {
  public:
    explicit RootMips(ColourSamples half) : level_(std::move(half)) {}

    Bytes encode() {
        Bytes blocks;
        for (int mip = 1; mip < kImageryMips; ++mip) {
            if (mip > 1) halve();
            const Bytes encoded = encodeBc1(framed(mip).view());
            blocks.insert(blocks.end(), encoded.begin(), encoded.end());
        }
        return blocks;
    }

  private:
    void halve() {
        const GridSize size = level_.views().size();
        ColourSamples coarse(GridSize{size.width / 2, size.height / 2});
        halveColours(level_.views(), coarse);
        level_ = std::move(coarse);
    }

    [[nodiscard]] Grid<Rgba> framed(int mip) const {
        const Grid<Rgba> core = shownColours(level_.views());
        const int64_t gutter = kImageryGutter >> mip;
        Grid<Rgba> image({imageryMipSide(mip), imageryMipSide(mip)},
                         {kNeutralGround[0], kNeutralGround[1], kNeutralGround[2], 255});
        for (int64_t y = 0; y < core.height(); ++y)
            std::ranges::copy(core.view().row(y), image.view().row(y + gutter).begin() + gutter);
        return image;
    }

    ColourSamples level_;
};

class ImageryPyramid {
  public:
    ImageryPyramid(const ColourSource& source, const PyramidExtent& extent, PyramidBlocks& blocks,
                   BuildContext& context)
        : source_(source),
          extent_(extent),
          photo_(*extent.covered),
          blocks_(blocks),
          context_(context),
          readers_(static_cast<size_t>(context.jobs)) {}

    uint64_t build(uint32_t depth) {
        for (const BlockStage& stage : planStages(extent_.finestLevel, depth)) {
            above_.reset();
            if (stage.top() > 0)
                above_ =
                    std::make_unique<LevelStore>(context_.workDirectory / ("imagery-" + std::to_string(stage.top())),
                                                 extent_.coveredTilesAt(stage.top()), 4, 0.0f);
            std::function<void()> begin;
            if (stage.first) begin = [&] { prepareSource(); };
            blocks_.runStage(stage,
                             {.begin = begin,
                              .build = [&](BlockRecord& record, int worker) { buildBlock(stage, record, worker); },
                              .take = [&](const BlockRecord& record) { take(record); },
                              .level = above_ ? &above_->file() : nullptr});
            if (stage.first) releaseSource();
            if (below_) blocks_.discard(below_->file());
            std::swap(below_, above_);
        }
        if (blocks_.tiles() == 0)
            throw Error(ExitCode::georeference,
                        "the imagery has no texel over the heights: they overlap in extent at most, and all texels "
                        "there are nodata");
        return blocks_.tiles();
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
        Block block{.stage = stage, .record = record, .finest = {}, .levels = {}, .exists = {}};
        const bool hasPhoto = stage.first ? readSource(block, worker) : readBelow(block);
        if (!hasPhoto) return;
        halveUpwards(block);
        for (uint32_t above = 0; above <= stage.depth; ++above) {
            block.exists.emplace_back(GridSize{block.tilesAcross(above), block.tilesAcross(above)});
            makeTiles(block, above);
        }
        handOver(block);
    }

    /// @return whether the block's core has any photo
    bool readSource(Block& block, int worker) {
        const GridRect window = block.window();
        const int64_t margin = int64_t{kImageryGutter} << block.stage.depth;
        const GridRect inside = intersection(window, photo_);
        if (intersection(grown(window, -margin), photo_).empty()) return false;
        block.finest = Grid<Rgba>({window.width, window.height}, Rgba{});
        std::unique_ptr<ColourReader>& reader = readers_[static_cast<size_t>(worker)];
        if (!reader) reader = source_.openReader();
        const StepTimer timer(context_.times, reader->resamples() ? BuildStep::warp : BuildStep::read);
        reader->read(inside, block.finest.view().window(
                                 {inside.x - window.x, inside.y - window.y, inside.width, inside.height}));
        return anyPhoto(
            block.finest.view().window({margin, margin, window.width - 2 * margin, window.height - 2 * margin}));
    }

    /// Halves the stored level in bands, so that it never lies in memory as a whole.
    bool readBelow(Block& block) {
        bool any = false;
        for (int64_t row = 0; row < block.tilesAcross(0); ++row)
            for (int64_t column = 0; column < block.tilesAcross(0); ++column)
                any = any || existsBelow(block.tile(0, column, row));
        if (!any) return false;

        const GridRect window = block.window();
        ColourSamples& coarse = block.levels.emplace_back(GridSize{window.width / 2, window.height / 2});
        ColourSamples band(GridSize{window.width, kBandRows});
        for (int64_t row = 0; row < window.height; row += kBandRows) {
            const int64_t rows = std::min(kBandRows, window.height - row);
            const GridRect part = {0, 0, window.width, rows};
            {
                const StepTimer timer(context_.times, BuildStep::read);
                for (int plane = 0; plane < 4; ++plane)
                    below_->read({window.x, window.y + row, window.width, rows}, plane,
                                 band.planes[static_cast<size_t>(plane)].view().window(part));
            }
            const StepTimer timer(context_.times, BuildStep::reduce);
            halveColours(band.views().window(part), coarse, row / 2);
        }
        return true;
    }

    [[nodiscard]] bool existsBelow(const TileId& id) const { return below_->has(id.x, id.y); }

    void halveUpwards(Block& block) {
        const StepTimer timer(context_.times, BuildStep::reduce);
        while (block.levels.size() < block.stage.depth) {
            const GridSize fine = block.levels.empty() ? block.finest.size() : block.levels.back().views().size();
            ColourSamples coarse(GridSize{fine.width / 2, fine.height / 2});
            if (block.levels.empty())
                halveColours(block.finest.view(), coarse);
            else
                halveColours(block.levels.back().views(), coarse);
            block.levels.push_back(std::move(coarse));
        }
    }

    void makeTiles(Block& block, uint32_t above) {
        const GridSize tiles = extent_.tilesAt(block.stage.bottom - above);
        const bool madeBelow = above == 0 && !block.stage.first;
        for (int64_t row = 0; row < block.tilesAcross(above); ++row) {
            for (int64_t column = 0; column < block.tilesAcross(above); ++column) {
                const TileId id = block.tile(above, column, row);
                if (id.x >= tiles.width || id.y >= tiles.height) continue;
                throwIfStopped(context_.stop);
                const bool exists = madeBelow ? existsBelow(id) : makeTile(block, above, column, row);
                block.exists[above].at(column, row) = exists ? 1 : 0;
            }
        }
    }

    /// @return whether the tile has photo, and so is stored
    bool makeTile(const Block& block, uint32_t above, int64_t column, int64_t row) {
        const GridRect core = coreInBlock(block.stage, above, kImageryGutter, column, row);
        if (!block.photoIn(above, core)) return false;

        ImageryTile tile;
        tile.id = block.tile(above, column, row);
        if (above > 0)
            for (uint32_t quadrant = 0; quadrant < 4; ++quadrant)
                tile.childExists[quadrant] =
                    block.exists[above - 1].at(2 * column + (quadrant & 1), 2 * row + (quadrant >> 1)) != 0;
        Bytes payload;
        {
            const StepTimer timer(context_.times, BuildStep::encode);
            tile.blocks = encodeBc1(block.shown(above, grown(core, kImageryGutter)).view());
            if (tile.id.level == 0) addRootMips(block, above, core, tile);
            payload = encodeImageryTile(tile);
        }
        blocks_.store(block.record, tile.id, payload);
        return true;
    }

    static void addRootMips(const Block& block, uint32_t above, const GridRect& core, ImageryTile& tile) {
        ColourSamples half(GridSize{kTileCore / 2, kTileCore / 2});
        if (above == 0)
            halveColours(block.finest.view().window(core), half);
        else
            halveColours(block.levels[above - 1].views().window(core), half);
        const Bytes mips = RootMips(std::move(half)).encode();
        tile.mips = kImageryMips;
        tile.blocks.insert(tile.blocks.end(), mips.begin(), mips.end());
    }

    /// Gives the block's top level to the stage above.
    void handOver(const Block& block) {
        block.record.topRecord.exists = block.exists.back().at(0, 0) != 0;
        if (!above_ || !block.record.topRecord.exists) return;
        const StepTimer timer(context_.times, BuildStep::write);
        const GridRect core = coreInBlock(block.stage, block.stage.depth, kImageryGutter, 0, 0);
        above_->write(block.record.top.x, block.record.top.y, block.levels.back().views().window(core).planes);
    }

    /// Adds a finished block to what the stage above may read.
    void take(const BlockRecord& record) {
        if (above_ && record.topRecord.exists) above_->take(record.top.x, record.top.y);
    }

    const ColourSource& source_;
    PyramidExtent extent_;
    GridRect photo_;  ///< finest texels that may hold photo
    PyramidBlocks& blocks_;
    BuildContext& context_;
    std::vector<std::unique_ptr<ColourReader>> readers_;  ///< one for each worker, opened at its first block
    std::unique_ptr<LevelStore> below_;                   ///< read by the running stage
    std::unique_ptr<LevelStore> above_;                   ///< written by it
};

GridSize texelsOver(const Tiling& tiling, GridSize samples, uint32_t level) {
    if (level < tiling.finestLevel) return PyramidExtent{tiling.finestLevel, samples}.samplesAt(level);
    const uint32_t finer = level - tiling.finestLevel;
    return {samples.width << finer, samples.height << finer};
}

}  // namespace

PyramidExtent imageryExtent(const Tiling& tiling, GridSize samples, const ColourSource& photo) {
    PyramidExtent extent{.finestLevel = photo.level(), .samples = texelsOver(tiling, samples, photo.level())};
    // One more texel on each side, for what lies between texels.
    extent.covered = intersection(grown(imageryCells(photo.bounds(), tiling, extent.finestLevel), 1),
                                  {0, 0, extent.samples.width, extent.samples.height});
    return extent;
}

uint64_t buildImageryPyramid(const ColourSource& source, const PyramidExtent& extent, uint32_t depth,
                             PyramidBlocks& blocks, BuildContext& context) {
    return ImageryPyramid(source, extent, blocks, context).build(depth);
}

}  // namespace terray
