#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "common/grid.h"

namespace terray {

/// What the march reads of a HeightPyramid. Plain pointers: the kernels may call no shared inline function (lanes.h).
struct PyramidView {
    const uint16_t* codes;   ///< height samples, row-major; one more readable value follows the last
    int32_t width;           ///< samples, >= 2
    int32_t height;          ///< samples, >= 2
    int32_t coarsest;        ///< level of the one block that holds the map, 1 .. 15
    int32_t start;           ///< level at which rays start: the coarsest but one, since that is met with the map's box
    const uint16_t* maxima;  ///< levels 1 .. coarsest; one more readable value follows the last
    const uint16_t* around;  ///< likewise, the greatest of 3 x 3 blocks
};

/// A bilinear height map with its maximum mipmap (Dick, Krueger, Westermann 2009, section 3.2).
///
/// Map frame: x along a row and y along a column, in samples from the first one's centre; z in codes. The cells of the
/// march are the patches of the surface: cell (i, j) lies between the samples (i, j) and (i + 1, j + 1). A block of
/// level l is 2^l x 2^l cells; its maximum is taken over the (2^l + 1)^2 samples that its patches interpolate, so it
/// bounds the bilinear surface over the block, edges included. Level 0 is not stored: a patch is looked at itself.
/// Where the map ends, blocks hold 0.
///
/// Layout: a square of 2^coarsest cells; the coarsest level first, each level row-major, so that level l begins at the
/// number of values in the coarser ones, 1 + 4 + 16 + ... = 0x55555555 cut to 2 (coarsest - l) bits.
class HeightPyramid {
  public:
    /// Copies `codes`; 2 x 2 to 32769 x 32769 samples. Cost: 1 to 2 ns a sample (one core of a 2020s server), 8 where
    /// the system must first find and zero the memory.
    explicit HeightPyramid(GridView<const uint16_t> codes);

    [[nodiscard]] const PyramidView& view() const { return view_; }
    /// Bytes of the samples and of all maxima.
    [[nodiscard]] size_t sampleBytes() const;
    [[nodiscard]] size_t maximaBytes() const;

    /// The blocks of one level, 1 .. coarsest.
    [[nodiscard]] GridView<const uint16_t> maxima(int level) const;
    /// The greatest of the 3 x 3 blocks around each.
    [[nodiscard]] GridView<const uint16_t> around(int level) const;

  private:
    struct Release {
        void operator()(uint16_t* values) const;
    };
    using Values = std::unique_ptr<uint16_t[], Release>;
    static Values allocate(size_t count);
    [[nodiscard]] GridView<uint16_t> level(const Values& values, int level) const;

    PyramidView view_{};
    Values codes_;
    Values maxima_;
    Values around_;
};

}  // namespace terray
