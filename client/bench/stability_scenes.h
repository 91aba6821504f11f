#pragma once

#include <memory>
#include <vector>

#include "client/bench/stability.h"

namespace terray {

// What the stability suite's scenes are put together from, and its groups of cases.

using Ground = std::shared_ptr<const FormulaDataset>;

/// Where most grounds lie: away from 0, on a whole number of metres.
inline constexpr FormulaDataset::Shape kShape{.samples = {1024, 1024}, .spacing = 1, .west = 400000, .north = 5200000};

[[nodiscard]] Ground groundOf(const FormulaDataset::Shape& shape, const FormulaDataset::Heights& heights);
/// Hills of 40 m over 200 samples, rough by 1 m from sample to sample.
[[nodiscard]] double hillAt(int64_t column, int64_t row);
[[nodiscard]] Ground hills();

/// A place over a ground, metres. @param column, row  in samples, centres at + 0.5
[[nodiscard]] glm::dvec3 over(const Ground& ground, double column, double row, double height);
/// The stored height of a finest sample.
[[nodiscard]] double storedHeight(const Ground& ground, int64_t column, int64_t row);

/// Small pictures with a pixel in the middle, whose ray is the view axis exactly.
struct Frame {
    double fovDegrees = 45;
    int width = 65;
    int height = 33;
};
/// Heading clockwise from north, pitch above the horizontal.
[[nodiscard]] View looking(const glm::dvec3& eye, double headingDegrees, double pitchDegrees, const Frame& frame = {});
/// Axes as given, without a rounding: forward and up; right is their product.
[[nodiscard]] View along(const glm::dvec3& eye, const glm::dvec3& forward, const glm::dvec3& up,
                         const Frame& frame = {});

void addRayCases(std::vector<StabilityCase>& cases);     // directions, origins
void addShapeCases(std::vector<StabilityCase>& cases);   // grazing, steep and flat grounds
void addScaleCases(std::vector<StabilityCase>& cases);   // spacings, coordinates, pictures, exaggeration, curvature
void addExtentCases(std::vector<StabilityCase>& cases);  // level jumps, mirrors, holes, smallest datasets

}  // namespace terray
