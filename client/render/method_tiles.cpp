#include "client/render/method_tiles.h"

#include "client/render/hull_tiles.h"

namespace terray {

std::unique_ptr<MethodTiles> makeMethodTiles(const MethodOptions& options, uint32_t slots,
                                             const ShaderLibrary& shaders) {
    if (options.method == Method::hull)
        return std::make_unique<HullTiles>(static_cast<int>(options.quads), slots, shaders);
    return nullptr;
}

}  // namespace terray
