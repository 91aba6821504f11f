#include "tests/bench/embree_rates/rivals.h"

#include <algorithm>
#include <limits>

#include "common/check.h"
#include "tests/bench/packet_march/scalar_march.h"

namespace terray {

std::string EmbreeVariant::name() const {
    return "Embree, " + std::to_string(call.width) + (call.width == 1 ? " ray, " : " rays, ") +
           (call.coherent ? "coherent, " : "incoherent, ") + (mesh->setup().robust ? "robust, " : "") +
           (mesh->setup().isa.empty() ? "best ISA" : mesh->setup().isa);
}

Caster EmbreeVariant::caster() const {
    return {name(), [variant = *this](const View& view) {
                return [variant, rays = pictureRays(view, {})](int tile, GridView<float> depths) {
                    variant.mesh->castTile(variant.call, rays, tile, depths);
                };
            }};
}

std::vector<std::unique_ptr<EmbreeMesh>> embreeMeshes(const Ground& ground, int threads) {
    std::vector<std::unique_ptr<EmbreeMesh>> meshes;
    for (const char* isa : {"", "avx2"})
        for (const bool robust : {false, true})
            meshes.push_back(
                std::make_unique<EmbreeMesh>(ground, EmbreeSetup{.isa = isa, .robust = robust, .threads = threads}));
    return meshes;
}

EmbreeVariant robustEmbree(const std::vector<std::unique_ptr<EmbreeMesh>>& meshes) {
    const auto robust = std::ranges::find_if(meshes, [](const auto& mesh) { return mesh->setup().robust; });
    TERRAY_CHECK(robust != meshes.end());
    return {robust->get(), {.width = 8, .coherent = true}};
}

EmbreeVariant fastestEmbree(const std::vector<std::unique_ptr<EmbreeMesh>>& meshes, const View& view, int width,
                            int threads) {
    Grid<float> depths({view.width, view.height});
    EmbreeVariant fastest{};
    double least = std::numeric_limits<double>::infinity();
    for (const auto& mesh : meshes)
        for (const int rays : {1, 8, 16})
            for (const bool coherent : {true, false}) {
                if (width != 0 && rays != width) continue;
                const EmbreeVariant variant{mesh.get(), {.width = rays, .coherent = coherent}};
                for (int frame = 0; frame < 3; ++frame) {
                    const double cpu = castFrame(variant.caster(), view, threads, depths.view()).cpu;
                    if (cpu >= least) continue;
                    least = cpu;
                    fastest = variant;
                }
            }
    return fastest;
}

Caster marchCaster(const PacketKernel& kernel, const Ground& ground, const HeightPyramid& pyramid, bool beams) {
    const std::string name = std::string("packet march, ") + kernel.name + (beams ? "" : ", no beams");
    return {name, [&kernel, &ground, &pyramid, beams](const View& view) {
                return [&kernel, &pyramid, beams, rays = pictureRays(view, ground.mapFrame())](int tile,
                                                                                               GridView<float> depths) {
                    castPictureTile(kernel, pyramid, rays, tile, beams, depths);
                };
            }};
}

Caster scalarCaster(const Ground& ground, const HeightPyramid& pyramid) {
    return {"scalar march, double", [&ground, &pyramid](const View& view) {
                return [&pyramid, rays = pictureRays(view, ground.mapFrame())](int tile, GridView<float> depths) {
                    const GridRect inside = tileRect(rays, tile);
                    for (int64_t y = inside.y; y < inside.y + inside.height; ++y)
                        for (int64_t x = inside.x; x < inside.x + inside.width; ++x)
                            depths.at(x, y) = static_cast<float>(scalarMarch(pyramid, pixelRay(rays, x, y)).t);
                };
            }};
}

StepCounts countSteps(const PacketKernel& kernel, const Ground& ground, const HeightPyramid& pyramid,
                      const View& view) {
    const PictureRays rays = pictureRays(view, ground.mapFrame());
    Grid<float> depths({view.width, view.height});
    CastWork work;
    for (int tile = 0; tile < tileCount(rays); ++tile)
        work += castPictureTile(kernel, pyramid, rays, tile, true, depths.view());
    int64_t steps = 0;
    int64_t sampled = 0;
    for (int64_t y = 0; y < view.height; y += 4)
        for (int64_t x = 0; x < view.width; x += 4, ++sampled)
            steps += scalarMarch(pyramid, pixelRay(rays, x, y)).steps;
    const auto packets = static_cast<double>(depths.size().count()) / 8;
    return {.scalar = static_cast<double>(steps) / static_cast<double>(sampled),
            .beams = static_cast<double>(work.beamSteps) / packets,
            .pyramid = static_cast<double>(work.pyramidSteps) / packets,
            .patches = static_cast<double>(work.patchSteps) / packets};
}

}  // namespace terray
