#include "preprocess/surface_deviation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "common/surface_range.h"

namespace terray {
namespace {

using Row = std::vector<float>;

// ---- Away from holes: row by row ----

// Loops are short and over few rows, so that compilers make vector code of them.

/// Along a line of fixed y: what it takes to tell the difference at quarter places. Index 0 is the cell on the western
/// side of those asked for.
struct Line {
    Row west;  ///< the coarse surface at the cell's middle less the fine one at 1/4
    Row east;  ///< the same at 3/4
    Row rise;  ///< of the coarse surface, from the cell's middle to that of the cell to the west; none of index 0

    explicit Line(size_t cells) : west(cells), east(cells), rise(cells) {}
};

/// What a row of fine samples makes.
struct FineRow {
    Line line;  ///< through the samples
    Row west;   ///< coarse sample less fine one
    Row east;
    Row hole;  ///< NaN where a sample that was read is missing

    explicit FineRow(size_t cells) : line(cells), west(cells), east(cells), hole(cells) {}
};

/// Greatest differences within the two halves of each cell.
struct Halves {
    Row west;
    Row east;

    explicit Halves(size_t cells) : west(cells), east(cells) {}
    void clear() {
        std::ranges::fill(west, 0.0F);
        std::ranges::fill(east, 0.0F);
    }
    void raise(const Line& line) {
        const float *lineWest = line.west.data(), *lineEast = line.east.data(), *rise = line.rise.data();
        for (size_t i = 1; i + 1 < west.size(); ++i) {
            const float atStart = std::abs(0.5F * (lineEast[i - 1] + lineWest[i]));
            const float atQuarter = std::abs(lineWest[i] + 0.25F * rise[i]);
            const float atMiddle = std::abs(0.5F * (lineWest[i] + lineEast[i]));
            const float atLastQuarter = std::abs(lineEast[i] - 0.25F * rise[i + 1]);
            const float atEnd = std::abs(0.5F * (lineEast[i] + lineWest[i + 1]));
            west[i] = greater(west[i], greater(greater(atStart, atQuarter), atMiddle));
            east[i] = greater(east[i], greater(greater(atMiddle, atLastQuarter), atEnd));
        }
    }
};

void takeMean(const Row& a, const Row& b, Row& mean) {
    for (size_t i = 0; i < mean.size(); ++i) mean[i] = 0.5F * (a[i] + b[i]);
}

class RowDeviations {
  public:
    RowDeviations(const DeviationInput& input, GridView<float> deviation)
        : input_(input),
          deviation_(deviation),
          cells_(static_cast<size_t>(input.coarse.mean.width())),
          above_(cells_),
          upper_(cells_),
          lower_(cells_),
          below_(cells_),
          line_(cells_),
          inNorth_(cells_),
          onMiddle_(cells_),
          inSouth_(cells_),
          onBorder_(cells_),
          hole_(cells_),
          nothing_(2 * cells_) {}

    void run() {
        readRow(1, above_);
        readRow(2, upper_);
        takeBorder(above_, upper_, inNorth_);
        for (int64_t y = 0; y < deviation_.height(); ++y) {
            const int64_t row = 2 * (y + 1);
            readRow(row + 1, lower_);
            readRow(row + 2, below_);
            takeBorder(lower_, below_, onBorder_);
            takeMiddle(y + 1);
            inNorth_.raise(upper_.line);
            inSouth_.clear();
            inSouth_.raise(lower_.line);
            combine(y);
            markHoles(y);
            std::swap(above_, lower_);
            std::swap(upper_, below_);
            std::swap(inNorth_, onBorder_);
        }
    }

  private:
    /// The line through the fine samples of a row: a quarter of the way from one row of coarse samples to another.
    void readRow(int64_t fineRow, FineRow& out) const {
        const int64_t coarseRow = fineRow / 2;
        const float* fine = input_.fine.row(fineRow).data();
        const float* own = input_.coarse.mean.row(coarseRow).data();
        const float* next = input_.coarse.mean.row(coarseRow + (fineRow % 2 == 0 ? -1 : 1)).data();
        for (size_t i = 0; i < out.west.size(); ++i) {
            out.west[i] = own[i] - fine[2 * i];
            out.east[i] = own[i] - fine[2 * i + 1];
        }
        for (size_t i = 0; i < out.west.size(); ++i) {
            const float step = 0.25F * (next[i] - own[i]);
            out.line.west[i] = out.west[i] + step;
            out.line.east[i] = out.east[i] + step;
        }
        for (size_t i = 0; i < out.west.size(); ++i) out.hole[i] = out.line.west[i] + out.line.east[i];
        for (size_t i = 1; i < out.west.size(); ++i) {
            const float rise = own[i - 1] - own[i];
            out.line.rise[i] = rise + 0.25F * ((next[i - 1] - next[i]) - rise);
        }
    }

    /// The line between two rows of cells: nothing bends there, so it is the mean of the lines on both sides.
    void takeBorder(const FineRow& north, const FineRow& south, Halves& out) {
        takeMean(north.line.west, south.line.west, line_.west);
        takeMean(north.line.east, south.line.east, line_.east);
        takeMean(north.line.rise, south.line.rise, line_.rise);
        out.clear();
        out.raise(line_);
    }

    /// The line through coarse samples.
    void takeMiddle(int64_t coarseRow) {
        const float* own = input_.coarse.mean.row(coarseRow).data();
        takeMean(upper_.west, lower_.west, line_.west);
        takeMean(upper_.east, lower_.east, line_.east);
        for (size_t i = 1; i < line_.rise.size(); ++i) line_.rise[i] = own[i - 1] - own[i];
        onMiddle_.clear();
        onMiddle_.raise(line_);
    }

    /// The greatest of all lines within each fine cell, and what lies below it.
    void combine(int64_t y) {
        const bool finest = input_.fineDeviation.size().count() == 0;
        const float* north = finest ? nothing_.data() : input_.fineDeviation.row(2 * y).data();
        const float* south = finest ? nothing_.data() : input_.fineDeviation.row(2 * y + 1).data();
        const float *northWest = &inNorth_.west[1], *northEast = &inNorth_.east[1];
        const float *southWest = &inSouth_.west[1], *southEast = &inSouth_.east[1];
        const float *middleWest = &onMiddle_.west[1], *middleEast = &onMiddle_.east[1];
        const float *borderWest = &onBorder_.west[1], *borderEast = &onBorder_.east[1];
        const std::span<float> out = deviation_.row(y);
        for (size_t i = 0; i < out.size(); ++i) {
            const float inNorthWest = greater(northWest[i], middleWest[i]) + north[2 * i];
            const float inNorthEast = greater(northEast[i], middleEast[i]) + north[2 * i + 1];
            const float inSouthWest = greater(greater(southWest[i], middleWest[i]), borderWest[i]) + south[2 * i];
            const float inSouthEast = greater(greater(southEast[i], middleEast[i]), borderEast[i]) + south[2 * i + 1];
            out[i] = greater(greater(inNorthWest, inNorthEast), greater(inSouthWest, inSouthEast));
        }
    }

    /// 0 times a NaN is one: cells near holes are left to be looked at alone.
    void markHoles(int64_t y) {
        for (size_t i = 0; i < hole_.size(); ++i)
            hole_[i] = 0.0F * ((above_.hole[i] + upper_.hole[i]) + (lower_.hole[i] + below_.hole[i]));
        const std::span<float> out = deviation_.row(y);
        for (size_t i = 0; i < out.size(); ++i) out[i] += hole_[i] + hole_[i + 1] + hole_[i + 2];
    }

    const DeviationInput& input_;
    GridView<float> deviation_;
    size_t cells_;
    FineRow above_, upper_, lower_, below_;  ///< around and in the row of cells, from the north
    Line line_;
    Halves inNorth_, onMiddle_, inSouth_, onBorder_;
    Row hole_;
    Row nothing_;  ///< zeros, in place of the finest level's deviations
};

// ---- Near holes: point by point ----

/// A quarter of a patch, seen from the sample that owns it.
struct Quarter {
    double own = 0;
    double beside = 0;
    double beyond = 0;  ///< along y
    double across = 0;

    /// @param columns, rows  1 or -1: to which side of the sample
    static Quarter of(GridView<const float> heights, int64_t x, int64_t y, std::pair<int64_t, int64_t> side) {
        const std::array<float, 4> corners = {heights.at(x, y), heights.at(x + side.first, y),
                                              heights.at(x, y + side.second),
                                              heights.at(x + side.first, y + side.second)};
        double sum = 0;
        int count = 0;
        for (const float corner : corners) {
            if (std::isnan(corner)) continue;
            sum += static_cast<double>(corner);
            ++count;
        }
        const auto height = [&](size_t n) {
            return std::isnan(corners[n]) ? sum / count : static_cast<double>(corners[n]);
        };
        return {height(0), height(1), height(2), height(3)};
    }
    [[nodiscard]] double at(double u, double v) const {
        return own + u * (beside - own) + v * (beyond - own) + u * v * (across - beside - beyond + own);
    }
};

/// Greatest difference over a fine cell that has a surface. @param x, y  of the fine cell
double differenceOver(const DeviationInput& input, int64_t x, int64_t y) {
    const std::pair<int64_t, int64_t> outwards = {x % 2 == 0 ? -1 : 1, y % 2 == 0 ? -1 : 1};
    const Quarter coarse = Quarter::of(input.coarse.mean, x / 2, y / 2, outwards);
    double greatest = 0;
    for (const int64_t columns : {-1, 1})
        for (const int64_t rows : {-1, 1}) {
            const Quarter fine = Quarter::of(input.fine, x, y, {columns, rows});
            const double u = columns == outwards.first ? 0.25 : -0.25, v = rows == outwards.second ? 0.25 : -0.25;
            for (const double across : {0.0, 1.0})
                for (const double down : {0.0, 1.0})
                    greatest = std::max(greatest, std::abs(coarse.at(0.25 + u * across, 0.25 + v * down) -
                                                           fine.at(0.5 * across, 0.5 * down)));
        }
    return greatest;
}

/// @param x, y  of the cell within the coarse view
float deviationNearHoles(const DeviationInput& input, int64_t x, int64_t y) {
    if (std::isnan(input.coarse.mean.at(x, y))) return std::numeric_limits<float>::quiet_NaN();
    double greatest = 0;
    for (const int64_t row : {2 * y, 2 * y + 1})
        for (const int64_t column : {2 * x, 2 * x + 1}) {
            if (std::isnan(input.fine.at(column, row))) continue;
            const bool finest = input.fineDeviation.size().count() == 0;
            const double below = finest ? 0 : static_cast<double>(input.fineDeviation.at(column - 2, row - 2));
            greatest = std::max(greatest, differenceOver(input, column, row) + below);
        }
    return floatAtLeast(greatest);
}

// ---- Over all levels ----

/// Bounds over three rows of cells, column by column.
struct ColumnBounds {
    Row leastMean, greatestMean, lowest, highest;

    explicit ColumnBounds(size_t cells) : leastMean(cells), greatestMean(cells), lowest(cells), highest(cells) {}

    /// @param y  of the first row
    void read(const HeightViews& heights, int64_t y) {
        constexpr float kInfinity = std::numeric_limits<float>::infinity();
        const auto take = [y](GridView<const float> from, auto bound, float start, Row& to) {
            const float *a = from.row(y).data(), *b = from.row(y + 1).data(), *c = from.row(y + 2).data();
            for (size_t i = 0; i < to.size(); ++i) to[i] = bound(bound(bound(start, a[i]), b[i]), c[i]);
        };
        take(heights.mean, lesser, kInfinity, leastMean);
        take(heights.mean, greater, -kInfinity, greatestMean);
        take(heights.lowest, lesser, kInfinity, lowest);
        take(heights.highest, greater, -kInfinity, highest);
    }
};

/// Adds what rounding may have lost to a row of bounds, and takes the range of heights where that is less.
/// @param columns  of the row and the two around it
void capRow(const HeightViews& coarse, int64_t y, const ColumnBounds& columns, std::span<float> deviation) {
    constexpr float kRounding = 0x1p-19F;
    const float* mean = coarse.mean.row(y + 1).data() + 1;
    const float* lowest = coarse.lowest.row(y + 1).data() + 1;
    const float* highest = coarse.highest.row(y + 1).data() + 1;
    for (size_t i = 0; i < deviation.size(); ++i) {
        const auto around = [i](const Row& row, auto bound) { return bound(bound(row[i], row[i + 1]), row[i + 2]); };
        const CellHeights<float> nine = {around(columns.leastMean, lesser), around(columns.greatestMean, greater),
                                         around(columns.lowest, lesser), around(columns.highest, greater)};
        const float range = surfaceRangeBound<float>({mean[i], mean[i], lowest[i], highest[i]}, nine);
        deviation[i] = lesser(deviation[i], range) + kRounding * (nine.highest - nine.lowest);
    }
}

}  // namespace

void boundDeviations(const DeviationInput& input, GridView<float> deviation) {
    TERRAY_CHECK(input.coarse.mean.size() == GridSize(deviation.width() + 2, deviation.height() + 2));
    TERRAY_CHECK(input.fine.size() == GridSize(2 * input.coarse.mean.width(), 2 * input.coarse.mean.height()));
    RowDeviations(input, deviation).run();
    ColumnBounds columns(static_cast<size_t>(input.coarse.mean.width()));
    for (int64_t y = 0; y < deviation.height(); ++y) {
        const std::span<float> row = deviation.row(y);
        for (size_t x = 0; x < row.size(); ++x)
            if (std::isnan(row[x])) row[x] = deviationNearHoles(input, static_cast<int64_t>(x) + 1, y + 1);
        columns.read(input.coarse, y);
        capRow(input.coarse, y, columns, row);
    }
}

}  // namespace terray
