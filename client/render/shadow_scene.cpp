#include "client/render/shadow_scene.h"

#include <algorithm>
#include <cmath>

#include "common/check.h"

namespace terray {
namespace {

constexpr float kNothing = -1e30F;

interop::ShadowCell emptyCell() {
    return {.children = glm::uvec4(0), .source = glm::uvec4(TERRAY_NO_NODE, 0, 0, 0), .bounds = {kNothing, 0, 0, 0}};
}

/// Metres above the eye, rounded up: a ray that clears it clears the node.
float topOf(const interop::NodeParameters& node) {
    const double top = (double{node.boxMax.z} - node.eye.z) * node.right.w;
    return std::nextafter(static_cast<float>(top), 1e30F);
}

}  // namespace

ShadowScene shadowScene(std::span<const DrawNode> nodes, std::span<const interop::NodeParameters> parameters,
                        const Tiling& tiling, const View& view) {
    TERRAY_CHECK_OP(nodes.size(), ==, parameters.size());
    ShadowScene scene;
    scene.cells.push_back(emptyCell());
    uint32_t finest = 0;
    for (size_t n = 0; n < nodes.size(); ++n) {
        const TileId& id = nodes[n].cell;
        finest = std::max(finest, id.level);
        const float top = topOf(parameters[n]);
        size_t at = 0;
        scene.cells[0].bounds.x = std::max(scene.cells[0].bounds.x, top);
        for (uint32_t level = id.level; level-- > 0;) {
            const uint32_t quadrant = (id.x >> level & 1) | (id.y >> level & 1) << 1;
            uint32_t child = scene.cells[at].children[static_cast<int>(quadrant)];
            if (child == 0) {
                child = static_cast<uint32_t>(scene.cells.size());
                scene.cells[at].children[static_cast<int>(quadrant)] = child;
                scene.cells.push_back(emptyCell());
            }
            at = child;
            scene.cells[at].bounds.x = std::max(scene.cells[at].bounds.x, top);
        }
        TERRAY_CHECK(scene.cells[at].children == glm::uvec4(0) && scene.cells[at].source.x == TERRAY_NO_NODE);
        scene.cells[at].source.x = static_cast<uint32_t>(n);
    }

    const double side = tiling.spacing(finest) * kTileCore;
    const double x = (view.eye.x - tiling.west) / side, y = (tiling.north - view.eye.y) / side;
    const auto whole = [](double cells) { return static_cast<uint32_t>(static_cast<int64_t>(std::floor(cells))); };
    scene.parameters.grid = {whole(x), whole(y), finest, 0};
    scene.parameters.place = glm::vec4(x - std::floor(x), y - std::floor(y), side, scene.cells[0].bounds.x);
    return scene;
}

}  // namespace terray
