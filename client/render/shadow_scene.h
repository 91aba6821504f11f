#pragma once

#include <span>
#include <vector>

#include "common/draw_node.h"
#include "common/tiling.h"
#include "common/view.h"
#include "shaders/interop.h"

namespace terray {

/// What shadow rays walk: the tree of cells whose leaves are a frame's draw nodes, those in the picture and those that
/// only cast shadows into it.
struct ShadowScene {
    std::vector<interop::ShadowCell> cells;
    interop::ShadowParameters parameters{};
};

/// The tree over draw nodes whose cells do not overlap. Places are taken relative to the eye in double and rounded to
/// float; the border of a cell is rounded once, so a ray finds no gap between neighbours.
/// @param nodes       any order; nodes[i] is parameters[i] on the GPU
/// @param parameters  of the nodes, as nodeParameters() made them for `view`
[[nodiscard]] ShadowScene shadowScene(std::span<const DrawNode> nodes,
                                      std::span<const interop::NodeParameters> parameters, const Tiling& tiling,
                                      const View& view);

}  // namespace terray
