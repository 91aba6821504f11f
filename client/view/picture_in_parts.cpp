#include "client/view/picture_in_parts.h"

#include <algorithm>

#include <glm/common.hpp>

#include "common/check.h"

namespace terray {
namespace {

/// GPUs shade and filter by small squares of pixels: these had better be the picture's, too.
constexpr int kGrid = 16;

/// Size of a picture's parts; those at its right and upper edge may be smaller. They begin at multiples of kGrid from
/// the left and from below.
glm::ivec2 partOf(glm::ivec2 size, const std::optional<glm::ivec2>& told) {
    const bool atOnce = int64_t{size.x} * size.y <= kMostPixelsAtOnce && std::max(size.x, size.y) <= kLongestSideAtOnce;
    const glm::ivec2 most = told ? *told : atOnce ? size : kPartSize;
    const glm::ivec2 step = glm::max(most / kGrid * kGrid, kGrid);
    return {most.x < size.x ? step.x : size.x, most.y < size.y ? step.y : size.y};
}

}  // namespace

PictureInParts::PictureInParts(Engine& engine, const Camera& camera, const std::filesystem::path& path,
                               const Options& options)
    : engine_(engine),
      camera_(camera),
      path_(path),
      size_(options.size),
      part_(partOf(options.size, options.part)),
      grid_((size_ - 1) / part_ + 1),
      options_(engine.options()) {
    begin();
}

void PictureInParts::begin() {
    drawn_ = 0;
    report_ = {};
    file_.reset();  // two of the same name would be one file
    file_.emplace(path_, GridSize{size_.x, size_.y});
}

GridRect PictureInParts::rectOf(int part) const {
    const glm::ivec2 cell(part % grid_.x, grid_.y - 1 - part / grid_.x);  // from the left and from below
    const glm::ivec2 low = cell * part_, high = glm::min(low + part_, size_);
    return {low.x, size_.y - high.y, high.x - low.x, high.y - low.y};
}

void PictureInParts::drawNext() {
    TERRAY_CHECK(!finished());
    const GridRect rect = rectOf(drawn_);
    engine_.resizeToPart(size_.x, size_.y, rect);
    const FrameReport report = engine_.drawFrame(camera_, true);
    requireAllTiles(report, "no picture was written");
    if (parts() > 1 && report.coarsening != options_.selection.leastCoarsening) {
        options_.selection.leastCoarsening = report.coarsening;
        engine_.setOptions(options_);
        begin();
        return;
    }
    report_.nodes = std::max(report_.nodes, report.nodes);
    report_.residentHeights = std::max(report_.residentHeights, report.residentHeights);
    report_.residentImagery = std::max(report_.residentImagery, report.residentImagery);
    report_.wanted = std::max(report_.wanted, report.wanted);
    report_.coarsening = report.coarsening;

    const Grid<Rgba> pixels = engine_.targets().readSrgb();
    if (rect.x == 0) rows_ = Grid<Rgba>({size_.x, rect.height});
    for (int64_t y = 0; y < rect.height; ++y)
        std::ranges::copy(pixels.view().row(y), rows_.view().row(y).begin() + rect.x);
    if (rect.x + rect.width == size_.x) file_->write(rows_.view());
    ++drawn_;
    if (finished()) file_->finish();
}

}  // namespace terray
