#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/engine/engine.h"
#include "client/render/gl_context.h"
#include "client/stream/dataset_source.h"
#include "preprocess/dataset_builder.h"
#include "preprocess/raster_source.h"

namespace terray {

/// Height in metres of sample (column, row) of the finest grid, or kNoHeight.
using HeightFunction = std::function<float(int64_t column, int64_t row)>;

/// Colour of the ground at a place (world, metres).
using PhotoFunction = std::function<Rgba(double x, double y)>;

/// A dataset built from a function into a temporary directory that goes with this object.
///
/// The grid's upper-left corner is at (1000, 5000), away from 0 so that a lost offset shows.
class ComputedDataset {
  public:
    /// @param quantum  metres between stored heights; none: as the builder chooses
    ComputedDataset(const HeightFunction& heights, GridSize size, double spacing, std::optional<double> quantum = {});
    /// With a photo, its finest level `photoLevel`, over all of the ground.
    ComputedDataset(const HeightFunction& heights, GridSize size, double spacing, const PhotoFunction& photo,
                    uint32_t photoLevel);
    /// With terray-preprocess's own procedural terrain instead.
    ComputedDataset(int64_t size, double spacing, uint64_t seed);
    ~ComputedDataset();
    ComputedDataset(const ComputedDataset&) = delete;
    ComputedDataset& operator=(const ComputedDataset&) = delete;

    [[nodiscard]] const TileSource& source() const { return *source_; }
    [[nodiscard]] const std::filesystem::path& directory() const { return directory_; }
    [[nodiscard]] GroundRect ground() const { return source_->metadata().groundBounds(); }

  private:
    void build(const HeightSource& heights, const OpenPhoto& openPhoto = nullptr, std::optional<double> quantum = {});

    std::filesystem::path parent_;
    std::filesystem::path directory_;
    std::unique_ptr<TileSource> source_;
};

/// Options for pictures that are looked into: signal sky, steps and normals on; raster launch.
[[nodiscard]] EngineOptions inspectedOptions(Surface surface = Surface::automatic);

/// A camera from degrees.
[[nodiscard]] Camera cameraAt(glm::dvec3 position, double headingDegrees, double pitchDegrees, double fovDegrees = 45);

/// Pixels of two pictures of one size that differ, by one of 255 steps in a channel or by more.
struct ColourDifference {
    int64_t byOneStep = 0;
    int64_t byMore = 0;
};
[[nodiscard]] ColourDifference colourDifference(const Grid<Rgba>& a, const Grid<Rgba>& b);

/// Expects two launches' pictures to be the same. Node and hit of a pixel are, bit by bit; a colour has gone through
/// powers and exponentials in two programs that the driver's compiler need not round alike, and where its last place
/// decides the rounding to 8 bits, the byte is another: a value has about 24 bits, so once in 2^16 values, here
/// granted to one pixel in 1000.
void expectSameColours(const FrameTargets& one, const FrameTargets& other);

/// Pixels of the last frame whose ray ran out of steps.
[[nodiscard]] int64_t raysOutOfSteps(const FrameTargets& targets);

}  // namespace terray
