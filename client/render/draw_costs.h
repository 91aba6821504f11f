#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/draw_node.h"
#include "common/view.h"
#include "shaders/interop.h"

namespace terray {

/// What drawing a node takes, told before it is drawn.
struct NodeWork {
    double pixels = 0;     ///< that its box covers of the picture, what hides it not counted
    double steps = 0;      ///< of a ray through its box, as expected
    double triangles = 0;  ///< of the part of its tile's triangulation that is drawn
    bool isMade = true;    ///< that triangulation is there, not only estimated
};

/// @param node       as it is drawn by rays. @param triangles, isMade  see MethodTiles
[[nodiscard]] NodeWork workOf(const interop::NodeParameters& node, const View& view, uint64_t triangles,
                              bool isMade = true);

/// What work costs on a machine, in milliseconds: the hybrid's model (paper 001, section 6, leaves it open; this one is
/// ours). Whatever both ways share, such as shading, may be in both.
struct DrawCosts {
    double castNode = 0;   ///< rays: of a node
    double castPixel = 0;  ///< of a pixel
    double castStep = 0;   ///< of a step of a pixel's ray
    double meshNode = 0;   ///< triangles: of a node
    double meshPixel = 0;
    double meshTriangle = 0;
    double meshMake = 0;  ///< of triangulating a tile, once

    [[nodiscard]] double castMs(const NodeWork& work) const {
        return castNode + work.pixels * (castPixel + castStep * work.steps);
    }
    [[nodiscard]] double meshMs(const NodeWork& work) const {
        return meshNode + meshPixel * work.pixels + meshTriangle * work.triangles;
    }
    bool operator==(const DrawCosts&) const = default;
};

/// A node that was drawn alone, both ways.
struct CostSample {
    NodeWork work;
    double castMs = 0;
    double meshMs = 0;
    double emptyMs = 0;  ///< of these, what the frame takes without the node
    double makeMs = 0;   ///< that triangulating its tile took
};

/// The costs that come nearest to samples: least squares of errors relative to the frame's time, among costs that are
/// not negative; meshMake is the mean.
/// @param samples  at least one, times > 0
[[nodiscard]] DrawCosts fittedCosts(std::span<const CostSample> samples);

/// Chooses for each node of a frame whether it is rasterised. A cell begins with rays, and keeps its way until the
/// other one is told to take less than 0.8 of its time, so that nodes do not flip. A tile is triangulated once its
/// triangles, had they been there, would have saved as much time as making them takes: whether it is drawn for a frame
/// or for minutes, at once or now and again, that costs at most twice of what the better way would have (as with skis,
/// to rent or to buy), as far as times are as they were told.
class HybridChoice {
  public:
    /// @return  of each node, 1: rasterised. Cells that are not among the nodes are forgotten.
    [[nodiscard]] std::vector<uint8_t> choose(std::span<const DrawNode> nodes, std::span<const NodeWork> work,
                                              const DrawCosts& costs);

  private:
    static constexpr double kWorthAChange = 0.8;
    static constexpr size_t kMostMissed = 65536;   ///< tiles that are remembered; all are forgotten beyond that
    std::unordered_map<TileId, bool> rasterised_;  ///< by cell, of the last frame
    std::unordered_map<TileId, double> missed_;  ///< by height tile not made: ms that triangles would have saved so far
};

}  // namespace terray
