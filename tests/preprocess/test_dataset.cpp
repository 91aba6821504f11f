#include "tests/preprocess/test_dataset.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "common/parallel.h"
#include "common/pmtiles.h"

namespace terray {
namespace {

template <class T>
void copyWindow(const Grid<T>& cells, const GridRect& window, T outside, GridView<T> out) {
    for (int64_t y = 0; y < window.height; ++y)
        for (int64_t x = 0; x < window.width; ++x) {
            const int64_t column = window.x + x;
            const int64_t row = window.y + y;
            const bool inside = column >= 0 && row >= 0 && column < cells.width() && row < cells.size().height;
            out.at(x, y) = inside ? cells.at(column, row) : outside;
        }
}

class GridHeightReader final : public HeightReader {
  public:
    explicit GridHeightReader(const GridHeights& source) : source_(source) {}
    void read(const GridRect& window, GridView<float> out) override {
        if (source_.onRead_) source_.onRead_();
        copyWindow(source_.heights_, window, kNoHeight, out);
    }

  private:
    const GridHeights& source_;
};

class GridPhotoReader final : public ColourReader {
  public:
    explicit GridPhotoReader(const GridPhoto& source) : source_(source) {}
    void read(const GridRect& window, GridView<Rgba> out) override { copyWindow(source_.texels_, window, Rgba{}, out); }

  private:
    const GridPhoto& source_;
};

PmtilesReader openArchive(const std::filesystem::path& path) {
    return PmtilesReader::open(openFileSource(path).value()).value();
}

Payloads readPayloads(const PmtilesReader& reader) {
    Payloads payloads;
    const auto listed =
        reader.forEach([&](const TileId& id, uint64_t, uint32_t) { payloads[id] = reader.read(id).value().value(); });
    EXPECT_TRUE(listed.ok());
    return payloads;
}

}  // namespace

TemporaryDirectory::TemporaryDirectory() {
    std::string pattern = testing::TempDir() + "/terray_XXXXXX";
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
    path_ = pattern;
}

TemporaryDirectory::~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> TemporaryDirectory::names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) names.push_back(entry.path().filename());
    std::ranges::sort(names);
    return names;
}

GridHeights::GridHeights(Grid<float> heights, double spacing) : heights_(std::move(heights)) {
    info_.size = heights_.size();
    info_.west = 1000;
    info_.north = 5000;
    info_.spacing = spacing;
}

std::unique_ptr<HeightReader> GridHeights::openReader() const {
    return std::make_unique<GridHeightReader>(*this);
}

GridPhoto::GridPhoto(Grid<Rgba> texels, uint32_t level, const Tiling& tiling)
    : texels_(std::move(texels)), level_(level) {
    const double spacing = tiling.spacing(level);
    bounds_ = {tiling.west, tiling.north - static_cast<double>(texels_.size().height) * spacing,
               tiling.west + static_cast<double>(texels_.width()) * spacing, tiling.north};
}

std::unique_ptr<ColourReader> GridPhoto::openReader() const {
    return std::make_unique<GridPhotoReader>(*this);
}

Grid<float> makeHeights(GridSize size, const std::function<double(int64_t x, int64_t y)>& height) {
    Grid<float> heights(size);
    for (int64_t y = 0; y < size.height; ++y)
        for (int64_t x = 0; x < size.width; ++x) heights.at(x, y) = static_cast<float>(height(x, y));
    return heights;
}

Grid<float> makeHills(GridSize size, uint64_t seed, int holes) {
    std::mt19937_64 random(seed);
    return makeHeights(size, [&](int64_t x, int64_t y) {
        const double hill = 300 * std::sin(static_cast<double>(x) * 0.011) * std::cos(static_cast<double>(y) * 0.017);
        const double noise = static_cast<double>(random() % 4096) / 512;
        return static_cast<int>(random() % 1000) < holes ? std::nan("") : 500 + hill + noise;
    });
}

BuildSummary buildTestDataset(const HeightSource& heights, const std::filesystem::path& out, const TestBuild& build,
                              const OpenPhoto& openPhoto) {
    BuildRequest request;
    request.out = out;
    request.jobs = build.jobs;
    request.quantum = build.quantum;
    request.optionsText = "test";
    if (Tiling::levelFor(std::max(heights.info().size.width, heights.info().size.height)) > 0 || openPhoto)
        request.blockDepth = build.depth;
    return buildDataset(heights, openPhoto, request);
}

OpenPhoto gridPhoto(Grid<Rgba> texels, uint32_t level) {
    return [texels = std::move(texels), level](const Tiling& tiling, const HeightGridInfo&) {
        return std::make_unique<GridPhoto>(texels, level, tiling);
    };
}

std::map<TileId, HeightTile> readHeightTiles(const std::filesystem::path& dataset) {
    std::map<TileId, HeightTile> tiles;
    for (const auto& [id, payload] : readPayloads(openArchive(dataset / kHeightsFile)))
        tiles[id] = decodeHeightTile(payload, id).value();
    return tiles;
}

std::map<TileId, ImageryTile> readImageryTiles(const std::filesystem::path& dataset) {
    std::map<TileId, ImageryTile> tiles;
    for (const auto& [id, payload] : readPayloads(openArchive(dataset / kImageryFile)))
        tiles[id] = decodeImageryTile(payload, id).value();
    return tiles;
}

void rewriteArchive(const std::filesystem::path& archive,
                    const std::function<void(Payloads&, std::string& metadata)>& edit) {
    PmtilesHeader header;
    std::string metadata;
    Payloads payloads;
    {
        const PmtilesReader reader = openArchive(archive);
        header = reader.header();
        metadata = reader.metadata().value();
        payloads = readPayloads(reader);
    }
    edit(payloads, metadata);
    std::map<uint64_t, Bytes> ordered;
    for (const auto& [id, payload] : payloads) ordered[hilbertId(id)] = payload;
    PmtilesWriter writer(archive);
    for (const auto& [hilbert, payload] : ordered) writer.add(tileFromHilbert(hilbert).value(), payload);
    writer.finish(metadata, header);
}

Bytes readFile(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    EXPECT_TRUE(file) << path;
    Bytes bytes(std::filesystem::file_size(path));
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return bytes;
}

void writeFile(const std::filesystem::path& path, ByteView bytes) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    ASSERT_TRUE(file.flush()) << path;
}

}  // namespace terray
