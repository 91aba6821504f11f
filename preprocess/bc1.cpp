#include "preprocess/bc1.h"

#include <algorithm>
#include <cstring>

// The door to stb_dxt (Fabian Giesen and Sean Barrett; public domain or MIT, at the user's choice). Compiled into this
// file alone, so that its symbols stay here and every build uses the same encoder.
#define STB_DXT_STATIC
#define STB_DXT_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_dxt.h>
#pragma GCC diagnostic pop

#include "common/check.h"
#include "common/imagery_tile.h"

namespace terray {

Bytes encodeBc1(GridView<const Rgba> image) {
    TERRAY_CHECK_OP(image.width() % 4, ==, 0);
    TERRAY_CHECK_OP(image.height() % 4, ==, 0);
    Bytes blocks(static_cast<size_t>(image.width() / 4 * (image.height() / 4)) * kBc1BlockBytes);
    auto* block = reinterpret_cast<unsigned char*>(blocks.data());
    for (int64_t top = 0; top < image.height(); top += 4)
        for (int64_t left = 0; left < image.width(); left += 4, block += kBc1BlockBytes) {
            Grid<Rgba> texels({4, 4});
            for (int64_t row = 0; row < 4; ++row)
                std::ranges::copy(image.row(top + row).subspan(static_cast<size_t>(left), 4),
                                  texels.view().row(row).begin());
            // Equal alpha everywhere, as the encoder demands also where it stores none.
            for (Rgba& texel : texels.cells()) texel[3] = 255;
            stb_compress_dxt_block(block, texels.cells().front().data(), 0, STB_DXT_HIGHQUAL);
        }
    return blocks;
}

}  // namespace terray
