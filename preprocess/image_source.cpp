#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>

#include "common/check.h"
#include "common/error.h"
#include "preprocess/plain_image.h"
#include "preprocess/raster_files.h"
#include "preprocess/raster_layout.h"

namespace terray {

namespace {

/// Types that OpenImageIO's cache keeps as they are stored; it would round others on the way.
bool isKeptExactly(OIIO::TypeDesc type) {
    return type == OIIO::TypeUInt8 || type == OIIO::TypeUInt16 || type == OIIO::TypeHalf || type == OIIO::TypeFloat;
}

OIIO::TypeDesc channelType(const OIIO::ImageSpec& spec) {
    return spec.channelformat(0);
}

/// A cache of its own, so that its size and its end are known. Thread-safe.
struct DestroyCache {
    void operator()(OIIO::ImageCache* cache) const { OIIO::ImageCache::destroy(cache, true); }
};
using Cache = std::shared_ptr<OIIO::ImageCache>;

Cache makeCache(uint64_t bytes) {
    Cache cache(OIIO::ImageCache::create(false), DestroyCache());
    const int tileSide = 512;  // of the tiles into which images stored by rows are cut
    cache->attribute("max_memory_MB", static_cast<float>(bytes) / (1 << 20));
    cache->attribute("autotile", tileSide);
    cache->attribute("autoscanline", 1);  // whole rows at once: such files are read from the top
    cache->attribute("automip", 0);
    cache->attribute("accept_untiled", 1);
    cache->attribute("trust_file_extensions", 0);
    return cache;
}

/// What all readers share.
struct OpenImage {
    Cache cache;
    OIIO::ustring file;
    GridSize size;
    OIIO::TypeDesc type;
    HeightSourceOptions options;
};

class ImageHeightReader final : public HeightReader {
  public:
    explicit ImageHeightReader(std::shared_ptr<const OpenImage> image) : image_(std::move(image)) {}

    void read(const GridRect& window, GridView<float> out) override {
        TERRAY_CHECK(out.size() == (GridSize{window.width, window.height}));
        for (int64_t row = 0; row < out.height(); ++row) std::ranges::fill(out.row(row), kNoHeight);
        const GridRect inside = intersection(window, {0, 0, image_->size.width, image_->size.height});
        if (inside.empty()) return;
        const GridView<float> target =
            out.window({inside.x - window.x, inside.y - window.y, inside.width, inside.height});
        if (image_->type == OIIO::TypeUInt8)
            readAs<uint8_t>(inside, target);
        else if (image_->type == OIIO::TypeUInt16)
            readAs<uint16_t>(inside, target);
        else
            readAs<float>(inside, target);  // halves are floats exactly
    }

  private:
    template <class Sample>
    void readAs(const GridRect& window, GridView<float> out) {
        Grid<Sample> samples(out.size());
        const auto x = static_cast<int>(window.x);
        const auto y = static_cast<int>(window.y);
        const auto type = OIIO::BaseTypeFromC<Sample>::value;
        if (!image_->cache->get_pixels(image_->file, 0, 0, x, x + static_cast<int>(window.width), y,
                                       y + static_cast<int>(window.height), 0, 1, 0, 1, type, samples.view().data()))
            throw Error(ExitCode::input,
                        "cannot read \"" + image_->file.string() + "\" at row " + std::to_string(y) +
                            "; the file is cut short or damaged (OpenImageIO says: " + image_->cache->geterror() + ")");
        for (int64_t row = 0; row < out.height(); ++row)
            std::ranges::transform(samples.view().row(row), out.row(row).begin(),
                                   [&](Sample sample) { return metres(static_cast<double>(sample)); });
    }

    [[nodiscard]] float metres(double sample) const {
        const HeightSourceOptions& options = image_->options;
        if (options.nodata && sample == *options.nodata) return kNoHeight;
        const auto height = static_cast<float>(sample * options.heightScale.value_or(1) + options.heightOffset);
        return std::isfinite(height) ? height : kNoHeight;
    }

    std::shared_ptr<const OpenImage> image_;
};

class ImageHeights final : public HeightSource {
  public:
    ImageHeights(HeightGridInfo info, std::shared_ptr<const OpenImage> image)
        : info_(std::move(info)), image_(std::move(image)) {}
    [[nodiscard]] const HeightGridInfo& info() const override { return info_; }
    [[nodiscard]] std::unique_ptr<HeightReader> openReader() const override {
        return std::make_unique<ImageHeightReader>(image_);
    }

  private:
    HeightGridInfo info_;
    std::shared_ptr<const OpenImage> image_;
};

/// The file as it lies on disk; throws when it is missing or empty, which OpenImageIO does not tell apart.
SourceFile requiredFile(const std::string& file) {
    const std::optional<SourceFile> onDisk = fileOnDisk(file);
    if (!onDisk) throw Error(ExitCode::input, "cannot read \"" + file + "\": there is no such file");
    if (onDisk->bytes == 0) throw Error(ExitCode::input, "cannot read \"" + file + "\": the file is empty (0 bytes)");
    return *onDisk;
}

std::optional<OIIO::ImageSpec> specOf(const std::string& file, std::string& reason) {
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(file);
    if (input && input->spec().width > 0 && input->spec().height > 0) return input->spec();
    reason = OIIO::geterror();
    return {};
}

}  // namespace

bool isReadableImage(const std::string& file) {
    std::string reason;
    const std::optional<OIIO::ImageSpec> spec = specOf(file, reason);
    return spec && isKeptExactly(channelType(*spec));
}

std::unique_ptr<HeightSource> openImageHeights(const HeightSourceOptions& options) {
    TERRAY_CHECK(!options.files.empty());
    const std::string& file = options.files.front();
    const SourceFile onDisk = requiredFile(file);
    if (options.files.size() > 1)
        throw Error(ExitCode::georeference,
                    "cannot mosaic \"" + file + "\" with other files: a plain image does not say where it lies");
    if (!options.spacing)
        throw Error(ExitCode::georeference, "cannot place \"" + file +
                                                "\": a plain image does not say where it lies. Give the metres between "
                                                "its samples: --spacing METRES");
    std::string reason;
    const std::optional<OIIO::ImageSpec> spec = specOf(file, reason);
    if (!spec)
        throw Error(ExitCode::input, "cannot read \"" + file + "\": it is no image (OpenImageIO says: " + reason + ")");
    if (!isKeptExactly(channelType(*spec)))
        throw Error(ExitCode::input, "cannot read heights from \"" + file + "\": its samples are " +
                                         channelType(*spec).c_str() + ", expected uint8, uint16, half or float");
    auto image = std::make_shared<OpenImage>(OpenImage{.cache = makeCache(options.cacheBytes),
                                                       .file = OIIO::ustring(file),
                                                       .size = {spec->width, spec->height},
                                                       .type = channelType(*spec),
                                                       .options = options});
    HeightGridInfo info{.size = image->size, .spacing = *options.spacing, .files = {onDisk}};
    const bool isInteger = image->type == OIIO::TypeUInt8 || image->type == OIIO::TypeUInt16;
    info.sourceStep = isInteger ? std::abs(options.heightScale.value_or(1)) : 0;
    return std::make_unique<ImageHeights>(std::move(info), std::move(image));
}

}  // namespace terray
