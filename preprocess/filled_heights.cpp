#include "preprocess/filled_heights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "preprocess/raster_files.h"

namespace terray {
namespace {

bool isHole(float height) {
    return !std::isfinite(height);
}

bool hasHole(GridView<const float> heights) {
    for (int64_t y = 0; y < heights.height(); ++y)
        if (std::ranges::any_of(heights.row(y), isHole)) return true;
    return false;
}

class FilledReader final : public HeightReader {
  public:
    FilledReader(std::unique_ptr<HeightReader> reader, GridSize size, NodataPolicy policy)
        : reader_(std::move(reader)), size_(size), policy_(policy) {}

    void read(const GridRect& window, GridView<float> out) override {
        reader_->read(window, out);
        const GridRect inside = intersection(window, {0, 0, size_.width, size_.height});
        if (inside.empty()) return;
        if (policy_ == NodataPolicy::sea)
            flood(partOf(out, window, inside));
        else
            interpolate(window, inside, out);
    }
    [[nodiscard]] bool resamples() const override { return reader_->resamples(); }

  private:
    /// Pieces that are read again with a margin: few enough cells that GDAL's own arrays stay small beside a block.
    static constexpr int64_t kPieceSide = 512;

    static GridView<float> partOf(GridView<float> out, const GridRect& window, const GridRect& part) {
        return out.window({part.x - window.x, part.y - window.y, part.width, part.height});
    }

    static void flood(GridView<float> heights) {
        for (int64_t y = 0; y < heights.height(); ++y) std::ranges::replace_if(heights.row(y), isHole, 0.0f);
    }

    void interpolate(const GridRect& window, const GridRect& inside, GridView<float> out) {
        for (int64_t y = inside.y; y < inside.y + inside.height; y += kPieceSide)
            for (int64_t x = inside.x; x < inside.x + inside.width; x += kPieceSide) {
                const GridRect piece = intersection(inside, {x, y, kPieceSide, kPieceSide});
                const GridView<float> heights = partOf(out, window, piece);
                if (hasHole(heights)) fillPiece(piece, heights);
            }
    }

    void fillPiece(const GridRect& piece, GridView<float> out) {
        const GridRect around = {piece.x - kFillDistance, piece.y - kFillDistance, piece.width + 2 * kFillDistance,
                                 piece.height + 2 * kFillDistance};
        Grid<float> heights({around.width, around.height});
        reader_->read(around, heights.view());
        std::ranges::replace_if(heights.cells(), isHole, kNoHeight);
        interpolateHoles(heights, kFillDistance);
        const GridView<const float> filled =
            std::as_const(heights).view().window({kFillDistance, kFillDistance, piece.width, piece.height});
        for (int64_t row = 0; row < out.height(); ++row) std::ranges::copy(filled.row(row), out.row(row).begin());
    }

    std::unique_ptr<HeightReader> reader_;
    GridSize size_;
    NodataPolicy policy_;
};

class FilledHeights final : public HeightSource {
  public:
    FilledHeights(std::unique_ptr<HeightSource> heights, NodataPolicy policy)
        : heights_(std::move(heights)), policy_(policy) {}
    [[nodiscard]] const HeightGridInfo& info() const override { return heights_->info(); }
    [[nodiscard]] std::unique_ptr<HeightReader> openReader() const override {
        return std::make_unique<FilledReader>(heights_->openReader(), info().size, policy_);
    }
    [[nodiscard]] uint64_t preparedBytes() const override { return heights_->preparedBytes(); }
    void prepare(const SourceWorkspace& workspace) const override { heights_->prepare(workspace); }

  private:
    std::unique_ptr<HeightSource> heights_;
    NodataPolicy policy_;
};

}  // namespace

std::string nameOf(NodataPolicy policy) {
    if (policy == NodataPolicy::sea) return "sea";
    return policy == NodataPolicy::interpolate ? "interpolate" : "holes";
}

std::unique_ptr<HeightSource> fillNodata(std::unique_ptr<HeightSource> heights, NodataPolicy policy) {
    if (policy == NodataPolicy::holes) return heights;
    Grid<float> probe({1, 1}, 0.0f);
    if (policy == NodataPolicy::interpolate) interpolateHoles(probe, 1);  // fails now rather than at the first hole
    return std::make_unique<FilledHeights>(std::move(heights), policy);
}

}  // namespace terray
