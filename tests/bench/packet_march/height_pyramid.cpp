#include "tests/bench/packet_march/height_pyramid.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <new>
#include <vector>

#include <sys/mman.h>

#include "common/check.h"

namespace terray {
namespace {

constexpr int kMostLevels = 15;  // indices into the maxima stay within 31 bits
constexpr size_t kHugePage = size_t{2} << 20;

/// Values in the levels that are coarser than `level`.
size_t levelStart(int coarsest, int level) {
    return 0x55555555U & ((1U << (2 * (coarsest - level))) - 1);
}

/// Values in all levels from 1.
size_t blockCount(int coarsest) {
    return levelStart(coarsest, 0);
}

/// Level 1: a block's patches interpolate 3 x 3 samples.
void reduceSamples(GridView<const uint16_t> codes, GridView<uint16_t> blocks) {
    std::vector<uint16_t> column(static_cast<size_t>(codes.width()) + 2, 0);  // 0 beyond the map
    for (int64_t y = 0; 2 * y + 1 < codes.height(); ++y) {
        const auto first = codes.row(2 * y);
        const auto second = codes.row(2 * y + 1);
        const auto third = codes.row(std::min(2 * y + 2, codes.height() - 1));
        for (size_t x = 0; x < first.size(); ++x) column[x] = std::max({first[x], second[x], third[x]});
        const auto out = blocks.row(y);
        for (size_t x = 0; 2 * x + 1 < first.size(); ++x)
            out[x] = std::max({column[2 * x], column[2 * x + 1], column[2 * x + 2]});
    }
}

void reduceBlocks(GridView<const uint16_t> fine, GridView<uint16_t> coarse) {
    for (int64_t y = 0; y < coarse.height(); ++y) {
        const auto upper = fine.row(2 * y);
        const auto lower = fine.row(2 * y + 1);
        const auto out = coarse.row(y);
        for (size_t x = 0; x < out.size(); ++x)
            out[x] = std::max({upper[2 * x], upper[2 * x + 1], lower[2 * x], lower[2 * x + 1]});
    }
}

/// Greatest of the 3 x 3 blocks around each.
void spread(GridView<const uint16_t> blocks, GridView<uint16_t> around) {
    const auto count = static_cast<size_t>(blocks.width());
    std::vector<uint16_t> column(count + 2, 0);
    for (int64_t y = 0; y < blocks.height(); ++y) {
        const auto above = blocks.row(std::max<int64_t>(y - 1, 0));
        const auto here = blocks.row(y);
        const auto below = blocks.row(std::min(y + 1, blocks.height() - 1));
        for (size_t x = 0; x < count; ++x) column[x + 1] = std::max({above[x], here[x], below[x]});
        const auto out = around.row(y);
        for (size_t x = 0; x < count; ++x) out[x] = std::max({column[x], column[x + 1], column[x + 2]});
    }
}

}  // namespace

void HeightPyramid::Release::operator()(uint16_t* values) const {
    std::free(values);
}

/// Zeros, on huge pages where the system has them: rays jump between rows, each of which is on pages of its own.
HeightPyramid::Values HeightPyramid::allocate(size_t count) {
    const size_t bytes = (count * sizeof(uint16_t) + kHugePage - 1) / kHugePage * kHugePage;
    auto* const values = static_cast<uint16_t*>(std::aligned_alloc(kHugePage, bytes));
    if (values == nullptr) throw std::bad_alloc();
    madvise(values, bytes, MADV_HUGEPAGE);  // a wish; refused, pages are small
    std::fill_n(values, bytes / sizeof(uint16_t), uint16_t{0});
    return Values(values);
}

HeightPyramid::HeightPyramid(GridView<const uint16_t> codes) {
    const int64_t shorter = std::min(codes.width(), codes.height());
    const int64_t longer = std::max(codes.width(), codes.height());
    TERRAY_CHECK_OP(shorter, >=, 2);
    const auto cells = static_cast<uint64_t>(std::max<int64_t>(longer - 1, 2));
    const auto coarsest = static_cast<int>(std::bit_width(cells - 1));
    TERRAY_CHECK_OP(coarsest, <=, kMostLevels);

    // One value more each, for reads in pairs.
    codes_ = allocate(static_cast<size_t>(codes.size().count()) + 1);
    maxima_ = allocate(blockCount(coarsest) + 1);
    around_ = allocate(blockCount(coarsest) + 1);
    view_ = {.codes = codes_.get(),
             .width = static_cast<int32_t>(codes.width()),
             .height = static_cast<int32_t>(codes.height()),
             .coarsest = coarsest,
             .start = std::max(coarsest - 1, 1),
             .maxima = maxima_.get(),
             .around = around_.get()};

    const GridView<uint16_t> own(codes_.get(), codes.size());
    for (int64_t y = 0; y < codes.height(); ++y) std::ranges::copy(codes.row(y), own.row(y).begin());
    reduceSamples(own, level(maxima_, 1));
    for (int l = 2; l <= coarsest; ++l) reduceBlocks(level(maxima_, l - 1), level(maxima_, l));
    for (int l = 1; l <= coarsest; ++l) spread(level(maxima_, l), level(around_, l));
}

GridView<uint16_t> HeightPyramid::level(const Values& values, int level) const {
    const int64_t side = int64_t{1} << (view_.coarsest - level);
    return {values.get() + levelStart(view_.coarsest, level), GridSize{side, side}};
}

GridView<const uint16_t> HeightPyramid::maxima(int level) const {
    return this->level(maxima_, level);
}

GridView<const uint16_t> HeightPyramid::around(int level) const {
    return this->level(around_, level);
}

size_t HeightPyramid::sampleBytes() const {
    return sizeof(uint16_t) * static_cast<size_t>(view_.width) * static_cast<size_t>(view_.height);
}

size_t HeightPyramid::maximaBytes() const {
    return 2 * sizeof(uint16_t) * blockCount(view_.coarsest);
}

}  // namespace terray
