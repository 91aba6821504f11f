#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/bench/formula_dataset.h"
#include "client/bench/stability_bound.h"
#include "client/engine/engine.h"

namespace terray {

/// Pictures of one ground, made to be hard on the arithmetic of a ray.
struct StabilityScene {
    std::shared_ptr<const FormulaDataset> ground;
    std::vector<View> views;
    double relief = 0;  ///< metres by which drawn levels may differ from the finest one, by the ground's formula
    /// Not null: ground and views as seen in a mirror; pictures must be these with their columns exchanged, bit by bit.
    std::shared_ptr<const FormulaDataset> mirroredGround;
    std::vector<View> mirroredViews;
};

/// A scene by its name, "group/what"; made when it is asked for.
struct StabilityCase {
    std::string name;
    std::function<StabilityScene()> scene;
};
/// All cases of the suite.
[[nodiscard]] std::vector<StabilityCase> stabilityCases();

/// Who casts the rays.
enum class StabilityCaster : uint8_t { gpuRaster, gpuCompute, cpuFloat, cpuDouble };
[[nodiscard]] const char* name(StabilityCaster caster);

/// What a caster made of a case.
struct StabilityRow {
    std::string name;
    StabilityCaster caster = StabilityCaster::gpuRaster;
    bool columns = false;  ///< the surface; else bilinear
    uint64_t rays = 0;
    uint64_t wrong = 0;       ///< right neither as ground nor as sky: all that follow
    uint64_t seeThrough = 0;  ///< see RayVerdict
    uint64_t coversSky = 0;
    uint64_t misplaced = 0;
    uint64_t unmirrored = 0;  ///< differ in a last place from the mirrored picture
    uint64_t notANumber = 0;
    uint64_t outOfSteps = 0;
    uint32_t worstSteps = 0;
    double worstTexels = 0;  ///< from a hit to the true surface, as PixelError::pixels, in finest samples
    double worstPixels = 0;

    [[nodiscard]] bool met() const { return wrong + outOfSteps == 0; }
};

/// Draws a case with each caster that a method has, on both surfaces. GL thread only; a context must be current.
/// Throws as Engine does.
/// @param method  others than pyramid are drawn by the GPU alone
[[nodiscard]] std::vector<StabilityRow> runStabilityCase(const StabilityCase& of, const ShaderLibrary& shaders,
                                                         const MethodOptions& method);

}  // namespace terray
