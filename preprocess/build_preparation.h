#pragma once

#include <memory>
#include <optional>
#include <string>

#include "preprocess/block_plan.h"
#include "preprocess/build_estimate.h"
#include "preprocess/build_heading.h"
#include "preprocess/dataset_builder.h"

namespace terray {

/// What is known of a dataset before any block of it is made.
struct BuildPreparation {
    DatasetMetadata metadata;  ///< without what only the build itself finds out
    std::unique_ptr<ColourSource> photo;

    /// Opens the photo. Throws Error: input (unusable heights), georeference (no overlap), unsupported (no encoder).
    BuildPreparation(const HeightSource& heights, const OpenPhoto& openPhoto, const BuildRequest& request);

    /// The photo's pyramid; none without photo.
    [[nodiscard]] std::optional<PyramidExtent> imagery() const;
    /// The plan of a build that begins. Throws Error(usage) for too little memory.
    [[nodiscard]] WorkPlan plan(const HeightSource& heights, const BuildRequest& request) const;
    /// The plan of a build whose blocks were chosen by whoever began it.
    [[nodiscard]] WorkPlan planAsBegun(const BuildHeading& begun, const BuildRequest& request) const;
    [[nodiscard]] EstimateInput estimateInput(const HeightSource& heights, const WorkPlan& work,
                                              uint64_t memoryBytes) const;
    /// What differs between this dataset and the one that was begun, for people; empty: nothing.
    [[nodiscard]] std::string changesSince(const BuildHeading& begun) const;

  private:
    void requireOverlap() const;
};

}  // namespace terray
