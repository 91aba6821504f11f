#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/bench/embree_rates/embree_mesh.h"
#include "tests/bench/embree_rates/rates.h"
#include "tests/bench/packet_march/packet_march.h"

namespace terray {

/// Embree set up and called in one way.
struct EmbreeVariant {
    const EmbreeMesh* mesh;
    EmbreeCall call;

    [[nodiscard]] std::string name() const;
    [[nodiscard]] Caster caster() const;
};

/// All meshes that are worth trying: with AVX2 and with the best instruction set of the machine, robust and not.
[[nodiscard]] std::vector<std::unique_ptr<EmbreeMesh>> embreeMeshes(const Ground& ground, int threads);

/// The one that leaves no holes, with 8 rays a call.
[[nodiscard]] EmbreeVariant robustEmbree(const std::vector<std::unique_ptr<EmbreeMesh>>& meshes);

/// The fastest of all meshes and calls for a view (by CPU time, best of three frames each), among calls of `width`
/// rays, or of any width for 0.
[[nodiscard]] EmbreeVariant fastestEmbree(const std::vector<std::unique_ptr<EmbreeMesh>>& meshes, const View& view,
                                          int width, int threads);

/// The packet march. `ground` and `pyramid` must outlive the caster.
[[nodiscard]] Caster marchCaster(const PacketKernel& kernel, const Ground& ground, const HeightPyramid& pyramid,
                                 bool beams);
/// The march of shaders/math in double, ray by ray.
[[nodiscard]] Caster scalarCaster(const Ground& ground, const HeightPyramid& pyramid);

/// What a picture costs.
struct StepCounts {
    double scalar;   ///< a ray: blocks and patches that the scalar march looks up, mean over every 16th pixel
    double beams;    ///< a packet of eight rays: steps of eight beams,
    double pyramid;  ///< of the packet in blocks,
    double patches;  ///< and of the packet before patches
};
[[nodiscard]] StepCounts countSteps(const PacketKernel& kernel, const Ground& ground, const HeightPyramid& pyramid,
                                    const View& view);

}  // namespace terray
