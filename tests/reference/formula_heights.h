#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <mutex>

#include "common/reference/reference_heights.h"

namespace terray::test {

inline constexpr double kNoGround = std::numeric_limits<double>::quiet_NaN();

/// Samples whose height is a function of column and row.
class FormulaHeights final : public ReferenceHeights {
  public:
    using Formula = std::function<double(int64_t column, int64_t row)>;
    FormulaHeights(GridSize size, const Formula& formula) : samples_(size) {
        for (int64_t y = 0; y < size.height; ++y)
            for (int64_t x = 0; x < size.width; ++x) samples_.at(x, y) = formula(x, y);
    }

    [[nodiscard]] GridSize size() const override { return samples_.size(); }
    /// The least one that is true, of one of a few rectangles that are asked for again and again.
    [[nodiscard]] double upperBound(const GridRect& rect) const override {
        const std::scoped_lock lock(mutex_);
        const auto [known, isNew] = bounds_.emplace(std::array{rect.x, rect.y, rect.width, rect.height}, 0);
        if (isNew) {
            known->second = -std::numeric_limits<double>::infinity();
            const Grid<double> samples = read(rect);
            for (const double height : samples.cells())
                if (height > known->second) known->second = height;
        }
        return known->second;
    }
    [[nodiscard]] Grid<double> read(const GridRect& rect) const override {
        Grid<double> samples({rect.width, rect.height});
        for (int64_t y = 0; y < rect.height; ++y)
            for (int64_t x = 0; x < rect.width; ++x) samples.at(x, y) = samples_.at(rect.x + x, rect.y + y);
        return samples;
    }

  private:
    Grid<double> samples_;
    mutable std::mutex mutex_;
    mutable std::map<std::array<int64_t, 4>, double> bounds_;
};

}  // namespace terray::test
