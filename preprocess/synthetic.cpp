#include <algorithm>
#include <cmath>

#include "common/check.h"
#include "preprocess/raster_files.h"
#include "preprocess/synthetic_terrain.h"

namespace terray {

namespace {

GridRect wholeOf(GridSize size) {
    return {0, 0, size.width, size.height};
}

/// The part of an array for `window` that stands for `inside`.
template <class T>
GridView<T> partOf(GridView<T> out, const GridRect& window, const GridRect& inside) {
    return out.window({inside.x - window.x, inside.y - window.y, inside.width, inside.height});
}

class SyntheticHeightReader final : public HeightReader {
  public:
    SyntheticHeightReader(const TerrainFunction& terrain, GridSize size) : terrain_(terrain), size_(size) {}

    void read(const GridRect& window, GridView<float> out) override {
        TERRAY_CHECK(out.size() == (GridSize{window.width, window.height}));
        for (int64_t row = 0; row < out.height(); ++row) std::ranges::fill(out.row(row), kNoHeight);
        const GridRect inside = intersection(window, wholeOf(size_));
        if (inside.empty()) return;
        const GridView<float> target = partOf(out, window, inside);
        for (int64_t row = 0; row < target.height(); ++row)
            terrain_.heights(4 * inside.x + 2, 4 * (inside.y + row) + 2, 4, target.row(row));
    }

  private:
    const TerrainFunction& terrain_;
    GridSize size_;
};

class SyntheticHeights final : public HeightSource {
  public:
    explicit SyntheticHeights(const SyntheticTerrain& terrain) : terrain_(terrain) {
        info_.size = {terrain.size, terrain.size};
        info_.spacing = terrain.spacing;
    }
    [[nodiscard]] const HeightGridInfo& info() const override { return info_; }
    [[nodiscard]] std::unique_ptr<HeightReader> openReader() const override {
        return std::make_unique<SyntheticHeightReader>(terrain_, info_.size);
    }

  private:
    HeightGridInfo info_;
    TerrainFunction terrain_;
};

struct Colour {
    float red;
    float green;
    float blue;
};

constexpr Colour kWater{38, 70, 92};
constexpr Colour kForest{52, 74, 40};
constexpr Colour kMeadow{104, 118, 62};
constexpr Colour kRock{118, 108, 98};
constexpr Colour kSnow{238, 240, 244};
constexpr std::array<Colour, 6> kFields{
    {{122, 138, 66}, {164, 150, 84}, {92, 116, 54}, {186, 172, 104}, {128, 104, 72}, {108, 132, 80}}};

Colour mix(const Colour& a, const Colour& b, float share) {
    const float t = std::clamp(share, 0.0f, 1.0f);
    return {a.red + t * (b.red - a.red), a.green + t * (b.green - a.green), a.blue + t * (b.blue - a.blue)};
}

/// What a texel of ground looks like; (x, y) in texels.
class Painter {
  public:
    Painter(const TerrainFunction& terrain, double texelMetres)
        : terrain_(terrain), rise_(static_cast<float>(1 / (2 * texelMetres))) {}

    /// @param east, south  height differences across two texels, metres
    [[nodiscard]] Rgba texel(int64_t x, int64_t y, float height, float east, float south) const {
        const float steepness = (east * east + south * south) * rise_ * rise_;  // square of the slope
        const uint64_t grain = hashPlace(x, y, 200, terrain_.seed());
        const float brightness = 1 + (static_cast<float>(grain & 255) - 127.5f) * (0.12f / 255);
        return lit(ground(x, y, height, steepness), brightness);
    }

  private:
    [[nodiscard]] Colour ground(int64_t x, int64_t y, float height, float steepness) const {
        if (height == terrain_.lakeLevel()) return kWater;
        const float level = height / terrain_.relief();
        const Colour low = mix(fields(x, y), kForest, (steepness - 0.01f) * 40);
        const Colour middle = mix(low, kMeadow, (level - 0.35f) * 8);
        const Colour high = mix(middle, kSnow, (level - 0.62f) * 10);
        return mix(high, kRock, (steepness - 0.4f) * 4);
    }
    /// Fields of 64 x 32 texels, each with furrows along or across.
    [[nodiscard]] Colour fields(int64_t x, int64_t y) const {
        const uint64_t kind = hashPlace(x >> 6, y >> 5, 201, terrain_.seed());
        const int64_t furrow = ((kind >> 8) & 1) != 0 ? x : y;
        const Colour& field = kFields[kind % kFields.size()];
        return mix(field, kForest, (furrow & 2) != 0 ? 0.12f : 0.0f);
    }
    static Rgba lit(const Colour& colour, float brightness) {
        const auto byte = [&](float value) {
            return static_cast<uint8_t>(std::clamp(value * brightness + 0.5f, 0.0f, 255.0f));
        };
        return {byte(colour.red), byte(colour.green), byte(colour.blue), 255};
    }

    const TerrainFunction& terrain_;
    float rise_;
};

class SyntheticPhotoReader final : public ColourReader {
  public:
    SyntheticPhotoReader(const TerrainFunction& terrain, GridSize size, double texelMetres)
        : terrain_(terrain), painter_(terrain, texelMetres), size_(size) {}

    void read(const GridRect& window, GridView<Rgba> out) override {
        TERRAY_CHECK(out.size() == (GridSize{window.width, window.height}));
        for (int64_t row = 0; row < out.height(); ++row) std::ranges::fill(out.row(row), Rgba{});
        const GridRect inside = intersection(window, wholeOf(size_));
        if (inside.empty()) return;
        // One texel more on each side, for slopes.
        Grid<float> heights({inside.width + 2, inside.height + 2});
        for (int64_t row = 0; row < heights.height(); ++row)
            terrain_.heights(2 * (inside.x - 1) + 1, 2 * (inside.y + row - 1) + 1, 2, heights.view().row(row));
        paint(inside, heights.view(), partOf(out, window, inside));
    }

  private:
    void paint(const GridRect& inside, GridView<const float> heights, GridView<Rgba> out) const {
        for (int64_t row = 0; row < out.height(); ++row) {
            const auto above = heights.row(row);
            const auto here = heights.row(row + 1);
            const auto below = heights.row(row + 2);
            const auto texels = out.row(row);
            for (size_t i = 0; i < texels.size(); ++i)
                texels[i] = painter_.texel(inside.x + static_cast<int64_t>(i), inside.y + row, here[i + 1],
                                           here[i + 2] - here[i], below[i + 1] - above[i + 1]);
        }
    }

    const TerrainFunction& terrain_;
    Painter painter_;
    GridSize size_;
};

class SyntheticPhoto final : public ColourSource {
  public:
    SyntheticPhoto(const SyntheticTerrain& terrain, const Tiling& tiling)
        : terrain_(terrain), level_(tiling.finestLevel + 1), size_{2 * terrain.size, 2 * terrain.size} {
        TERRAY_CHECK_OP(tiling.finestSpacing, ==, terrain.spacing);
        texelMetres_ = tiling.spacing(level_);
        const double side = static_cast<double>(terrain.size) * terrain.spacing;
        bounds_ = {tiling.west, tiling.north - side, tiling.west + side, tiling.north};
    }
    [[nodiscard]] uint32_t level() const override { return level_; }
    [[nodiscard]] GroundRect bounds() const override { return bounds_; }
    [[nodiscard]] const std::vector<SourceFile>& files() const override { return files_; }
    [[nodiscard]] std::unique_ptr<ColourReader> openReader() const override {
        return std::make_unique<SyntheticPhotoReader>(terrain_, size_, texelMetres_);
    }

  private:
    TerrainFunction terrain_;
    uint32_t level_;
    GridSize size_;
    double texelMetres_ = 1;
    GroundRect bounds_;
    std::vector<SourceFile> files_;
};

}  // namespace

std::unique_ptr<HeightSource> makeSyntheticHeights(const SyntheticTerrain& terrain) {
    return std::make_unique<SyntheticHeights>(terrain);
}

std::unique_ptr<ColourSource> makeSyntheticPhoto(const SyntheticTerrain& terrain, const Tiling& tiling) {
    return std::make_unique<SyntheticPhoto>(terrain, tiling);
}

}  // namespace terray
