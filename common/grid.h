#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "common/check.h"

namespace terray {

/// Columns and rows of a two-dimensional array.
struct GridSize {
    int64_t width = 0;
    int64_t height = 0;

    [[nodiscard]] constexpr int64_t count() const { return width * height; }
    constexpr bool operator==(const GridSize&) const = default;
};

/// A rectangle of cells: columns [x, x + width), rows [y, y + height).
struct GridRect {
    int64_t x = 0;
    int64_t y = 0;
    int64_t width = 0;
    int64_t height = 0;

    [[nodiscard]] constexpr bool empty() const { return width <= 0 || height <= 0; }
    constexpr bool operator==(const GridRect&) const = default;
};

/// The cells that two rectangles share; empty() when there are none.
[[nodiscard]] constexpr GridRect intersection(const GridRect& a, const GridRect& b) {
    const int64_t x0 = std::max(a.x, b.x);
    const int64_t y0 = std::max(a.y, b.y);
    const int64_t x1 = std::min(a.x + a.width, b.x + b.width);
    const int64_t y1 = std::min(a.y + a.height, b.y + b.height);
    return {x0, y0, std::max<int64_t>(x1 - x0, 0), std::max<int64_t>(y1 - y0, 0)};
}

/// A rectangular look at somebody else's row-major array. This file is the only place that turns (column, row) into an
/// index.
///
/// Columns grow to the east, rows to the south, as rasters are stored. Copying a view copies no cells. Access outside
/// the view is misuse: at() checks always, row() checks the row.
template <class T>
class GridView {
  public:
    GridView() = default;
    /// @param stride  cells from one row's start to the next, >= size.width
    GridView(T* data, GridSize size, int64_t stride) : data_(data), size_(size), stride_(stride) {
        TERRAY_CHECK_OP(stride, >=, size.width);
    }
    GridView(T* data, GridSize size) : GridView(data, size, size.width) {}
    /// A read-only view of a writable one.
    template <class U>
    requires(std::is_same_v<const U, T>) GridView(const GridView<U>& other)  // NOLINT(google-explicit-constructor)
        : data_(other.data()), size_(other.size()), stride_(other.stride()) {}

    [[nodiscard]] GridSize size() const { return size_; }
    [[nodiscard]] int64_t width() const { return size_.width; }
    [[nodiscard]] int64_t height() const { return size_.height; }
    [[nodiscard]] int64_t stride() const { return stride_; }
    [[nodiscard]] T* data() const { return data_; }

    [[nodiscard]] T& at(int64_t x, int64_t y) const {
        if (x < 0 || x >= size_.width || y < 0 || y >= size_.height) outside(x, y);
        return data_[y * stride_ + x];
    }
    /// The cell, or the nearest one of the border when (x, y) lies outside. The view must not be empty.
    [[nodiscard]] T& clamped(int64_t x, int64_t y) const {
        return at(std::clamp<int64_t>(x, 0, size_.width - 1), std::clamp<int64_t>(y, 0, size_.height - 1));
    }
    [[nodiscard]] std::span<T> row(int64_t y) const {
        if (y < 0 || y >= size_.height) outside(0, y);
        return {data_ + y * stride_, static_cast<size_t>(size_.width)};
    }
    /// The part of this view inside rect, which must lie within it.
    [[nodiscard]] GridView window(const GridRect& rect) const {
        TERRAY_CHECK_OP(rect.x, >=, 0);
        TERRAY_CHECK_OP(rect.y, >=, 0);
        TERRAY_CHECK_OP(rect.x + rect.width, <=, size_.width);
        TERRAY_CHECK_OP(rect.y + rect.height, <=, size_.height);
        return GridView(data_ + rect.y * stride_ + rect.x, {rect.width, rect.height}, stride_);
    }

  private:
    [[noreturn]] void outside(int64_t x, int64_t y) const {
        std::ostringstream text;
        text << " (cell " << x << ", " << y << " of " << size_.width << " x " << size_.height << ")";
        detail::checkFailed(__FILE__, __LINE__, "cell inside the grid", text.str());
    }

    T* data_ = nullptr;
    GridSize size_;
    int64_t stride_ = 0;
};

/// An array that owns its cells, row-major without gaps.
template <class T>
class Grid {
  public:
    Grid() = default;
    explicit Grid(GridSize size, T fill = T()) : size_(size), cells_(static_cast<size_t>(size.count()), fill) {}

    [[nodiscard]] GridSize size() const { return size_; }
    [[nodiscard]] int64_t width() const { return size_.width; }
    [[nodiscard]] int64_t height() const { return size_.height; }
    [[nodiscard]] T& at(int64_t x, int64_t y) { return view().at(x, y); }
    [[nodiscard]] const T& at(int64_t x, int64_t y) const { return view().at(x, y); }
    [[nodiscard]] GridView<T> view() { return {cells_.data(), size_}; }
    [[nodiscard]] GridView<const T> view() const { return {cells_.data(), size_}; }
    [[nodiscard]] std::span<T> cells() & { return cells_; }
    [[nodiscard]] std::span<const T> cells() const& { return cells_; }
    /// A span over a temporary would outlive its cells, as in a range-based for over the result of a function.
    std::span<const T> cells() const&& = delete;
    bool operator==(const Grid&) const = default;

  private:
    GridSize size_;
    std::vector<T> cells_;
};

}  // namespace terray
