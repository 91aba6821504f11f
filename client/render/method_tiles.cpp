#include "client/render/method_tiles.h"

#include "client/render/cone_tiles.h"
#include "client/render/hull_tiles.h"
#include "client/render/mesh_tiles.h"

namespace terray {

std::unique_ptr<MethodTiles> makeMethodTiles(const MethodScene& scene, uint32_t slots, const ShaderLibrary& shaders) {
    if (scene.method.method == Method::hull)
        return std::make_unique<HullTiles>(static_cast<int>(scene.method.quads), slots, shaders);
    if (scene.method.method == Method::mesh || scene.method.method == Method::hybrid)
        return std::make_unique<MeshTiles>(scene, slots);
    if (scene.method.method == Method::cones)
        return std::make_unique<ConeTiles>(static_cast<int>(scene.method.blocks), static_cast<int>(scene.method.reach),
                                           slots, shaders);
    return nullptr;
}

}  // namespace terray
