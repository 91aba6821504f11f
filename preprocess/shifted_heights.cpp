#include "preprocess/shifted_heights.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/error.h"
#include "preprocess/raster_files.h"

namespace terray {
namespace {

constexpr double kNodeMetres = 250;
constexpr int64_t kMostNodeStep = 64;  // samples

int64_t floorTo(int64_t value, int64_t step) {
    return value - ((value % step) + step) % step;
}

class ShiftedReader final : public HeightReader {
  public:
    ShiftedReader(std::unique_ptr<HeightReader> reader, std::unique_ptr<VerticalShift> shift,
                  const HeightGridInfo& info)
        : reader_(std::move(reader)),
          shift_(std::move(shift)),
          info_(info),
          step_(std::clamp(static_cast<int64_t>(kNodeMetres / info.spacing), int64_t{1}, kMostNodeStep)) {}

    void read(const GridRect& window, GridView<float> out) override {
        reader_->read(window, out);
        const GridRect inside = intersection(window, {0, 0, info_.size.width, info_.size.height});
        if (inside.empty()) return;
        for (int64_t y = floorTo(inside.y, step_); y < inside.y + inside.height; y += step_)
            shiftRows(window, intersection(inside, {inside.x, y, inside.width, step_}), y, out);
    }
    [[nodiscard]] bool resamples() const override { return reader_->resamples(); }

  private:
    /// Rows between one row of nodes and the next. Nodes lie at the same samples whatever the window.
    void shiftRows(const GridRect& window, const GridRect& part, int64_t firstRow, GridView<float> out) {
        const int64_t firstColumn = floorTo(part.x, step_);
        const int64_t nodes = (part.x + part.width - firstColumn - 1) / step_ + 2;
        const std::vector<double> upper = shiftsAt(firstColumn, firstRow, nodes);
        const std::vector<double> lower = shiftsAt(firstColumn, firstRow + step_, nodes);
        for (int64_t y = part.y; y < part.y + part.height; ++y) {
            const double down = static_cast<double>(y - firstRow) / static_cast<double>(step_);
            const std::span<float> row =
                out.row(y - window.y).subspan(static_cast<size_t>(part.x - window.x), static_cast<size_t>(part.width));
            for (size_t i = 0; i < row.size(); ++i) {
                const int64_t column = part.x + static_cast<int64_t>(i) - firstColumn;
                const auto node = static_cast<size_t>(column / step_);
                const double right = static_cast<double>(column % step_) / static_cast<double>(step_);
                const double shift = std::lerp(std::lerp(upper[node], upper[node + 1], right),
                                               std::lerp(lower[node], lower[node + 1], right), down);
                row[i] = static_cast<float>(static_cast<double>(row[i]) + shift);
            }
        }
    }

    /// At the centres of `count` samples of a row, one step apart.
    std::vector<double> shiftsAt(int64_t column, int64_t row, int64_t count) {
        std::vector<PixelPlace> places;
        for (int64_t i = 0; i < count; ++i)
            places.push_back({info_.west + (static_cast<double>(column + i * step_) + 0.5) * info_.spacing,
                              info_.north - (static_cast<double>(row) + 0.5) * info_.spacing});
        return shift_->at(places);
    }

    std::unique_ptr<HeightReader> reader_;
    std::unique_ptr<VerticalShift> shift_;
    const HeightGridInfo& info_;
    int64_t step_;
};

class ShiftedHeights final : public HeightSource {
  public:
    ShiftedHeights(std::unique_ptr<HeightSource> heights, std::string verticalCrs)
        : heights_(std::move(heights)), verticalCrs_(std::move(verticalCrs)), info_(heights_->info()) {
        info_.verticalDatum = verticalName(verticalCrs_);
        info_.verticalWkt.clear();
        info_.sourceStep = 0;
    }
    [[nodiscard]] const HeightGridInfo& info() const override { return info_; }
    [[nodiscard]] std::unique_ptr<HeightReader> openReader() const override {
        return std::make_unique<ShiftedReader>(
            heights_->openReader(), openVerticalShift(info_.crsWkt, heights_->info().verticalWkt, verticalCrs_), info_);
    }
    [[nodiscard]] uint64_t preparedBytes() const override { return heights_->preparedBytes(); }
    void prepare(const SourceWorkspace& workspace) const override { heights_->prepare(workspace); }

  private:
    std::unique_ptr<HeightSource> heights_;
    std::string verticalCrs_;
    HeightGridInfo info_;
};

}  // namespace

std::unique_ptr<HeightSource> shiftHeights(std::unique_ptr<HeightSource> heights, const std::string& verticalCrs) {
    const HeightGridInfo& info = heights->info();
    if (info.verticalWkt.empty() || info.crsWkt.empty())
        throw Error(
            ExitCode::georeference,
            "cannot shift heights to \"" + verticalCrs +
                "\": the sources do not all say which one vertical system they are in; give them a compound one, "
                "as with gdal_translate -a_srs EPSG:32632+5773");
    // Fails now rather than at the first block.
    const PixelPlace middle{info.west + static_cast<double>(info.size.width) * info.spacing / 2,
                            info.north - static_cast<double>(info.size.height) * info.spacing / 2};
    (void)openVerticalShift(info.crsWkt, info.verticalWkt, verticalCrs)->at({middle});
    return std::make_unique<ShiftedHeights>(std::move(heights), verticalCrs);
}

}  // namespace terray
