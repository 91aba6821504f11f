#include "common/bc1_decode.h"

#include "common/check.h"
#include "common/imagery_tile.h"

namespace terray {

namespace {

/// 5, 6, 5 bits to 8 each, the high bits repeated below, so that 0 and full stay what they are.
Rgba expand565(uint16_t packed) {
    const int red = packed >> 11;
    const int green = (packed >> 5) & 63;
    const int blue = packed & 31;
    return {static_cast<uint8_t>(red << 3 | red >> 2), static_cast<uint8_t>(green << 2 | green >> 4),
            static_cast<uint8_t>(blue << 3 | blue >> 2), 255};
}

/// (a * weightA + b * weightB) / (weightA + weightB), to the nearest.
Rgba blend(const Rgba& a, const Rgba& b, int weightA, int weightB) {
    Rgba mixed{0, 0, 0, 255};
    const int total = weightA + weightB;
    for (size_t i = 0; i < 3; ++i)
        mixed[i] = static_cast<uint8_t>((a[i] * weightA + b[i] * weightB + total / 2) / total);
    return mixed;
}

/// Two colours and two between them; when the first is not the greater, one between and black.
std::array<Rgba, 4> paletteOf(uint16_t first, uint16_t second) {
    const Rgba a = expand565(first);
    const Rgba b = expand565(second);
    if (first > second) return {a, b, blend(a, b, 2, 1), blend(a, b, 1, 2)};
    return {a, b, blend(a, b, 1, 1), Rgba{0, 0, 0, 255}};
}

}  // namespace

Grid<Rgba> decodeBc1(ByteView blocks, GridSize size) {
    TERRAY_CHECK(size.width % 4 == 0 && size.height % 4 == 0);
    TERRAY_CHECK_OP(blocks.size(), ==, static_cast<size_t>(size.count() / 16) * kBc1BlockBytes);
    Grid<Rgba> image(size);
    ByteReader reader(blocks);
    for (int64_t top = 0; top < size.height; top += 4) {
        const std::array<std::span<Rgba>, 4> rows = {image.view().row(top), image.view().row(top + 1),
                                                     image.view().row(top + 2), image.view().row(top + 3)};
        for (size_t left = 0; left < static_cast<size_t>(size.width); left += 4) {
            const auto first = reader.read<uint16_t>();
            const auto second = reader.read<uint16_t>();
            auto choices = reader.read<uint32_t>();  // two bits a texel, the first texel lowest
            const std::array<Rgba, 4> palette = paletteOf(first, second);
            for (const std::span<Rgba>& row : rows)
                for (size_t column = left; column < left + 4; ++column, choices >>= 2)
                    row[column] = palette[choices & 3];
        }
    }
    return image;
}

}  // namespace terray
