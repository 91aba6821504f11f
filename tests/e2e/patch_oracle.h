#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "client/render/terrain_renderer.h"
#include "common/draw_node.h"
#include "common/grid.h"
#include "common/view.h"
#include "tests/e2e/column_oracle.h"

namespace terray {

/// Says what a ray meets on the ground of a draw list when it is bilinear between sample centres, quarter of a patch by
/// quarter, by plain stepping in double on the CPU, 16 x 16 samples at a time where the ray is above them all: no
/// pyramid, no mirrored frame, no root of a quadratic, no code in common with the shaders.
///
/// A sample covers a square around it; where four samples meet, each has a quarter of the patch between their centres.
/// The quarter of a sample without surface is open; in the others the missing corner stands at the mean of those that
/// exist. The ground is solid: it is also met through the side of a quarter or of a node's cell.
class PatchOracle {
  public:
    /// @param columns  decodes the tiles; answers for nodes that `surface` draws as columns. Outlives this object.
    PatchOracle(ColumnOracle& columns, Surface surface) : columns_(columns), surface_(surface) {}

    /// View depth at which a ray first meets the ground, as ColumnOracle::meet. With b = 1 cm + 2^-20 of the distance,
    /// shrunk ground is lower by b * (1 + the patch's steepest slope), and ends b before every open side; grown ground
    /// is higher by as much, and each quarter reaches b beyond its sides.
    [[nodiscard]] std::optional<double> meet(const std::vector<DrawNode>& nodes, const View& view,
                                             const glm::dvec3& direction, ColumnOracle::Columns ground, double floor);

    [[nodiscard]] const TileSource& source() const { return columns_.source(); }
    [[nodiscard]] ColumnOracle& columns() { return columns_; }

  private:
    struct Ray;
    /// A span of times; empty unless from <= to.
    struct Times {
        double from = 0;
        double to = 0;
        [[nodiscard]] bool empty() const { return !(from <= to); }
    };
    /// Samples along the side of a block that rays may pass over at once.
    static constexpr int kBlock = 16;
    /// Highest codes of a tile.
    struct Tops {
        Grid<uint16_t> samples;  ///< of each core sample, of it and the eight around it
        Grid<uint16_t> blocks;   ///< of each block, of the samples in it and within 2 around it
    };
    /// What is looked up once for a node.
    struct NodeGround {
        const HeightTile* tile = nullptr;
        const Tops* tops = nullptr;
        glm::dvec3 origin{0};  ///< metres: north-western corner of the tile's core, at height 0
        double spacing = 1;    ///< metres between samples
        glm::dvec2 low{0};     ///< of the cell, in samples from the origin, y to the south
        glm::dvec2 high{0};
        double top = 0;     ///< metres: the highest sample in the cell and around it
        double relief = 0;  ///< metres from the lowest to the highest
    };
    struct Quarter;
    const NodeGround& groundOf(const DrawNode& node);
    const Tops& topsOf(const HeightTile& tile);
    static bool clears(const Ray& ray, const Times& span, const NodeGround& node, uint16_t top);
    static std::optional<double> pastBlock(const NodeGround& node, const Ray& ray, const Times& times);
    /// @param first  when the ray met other ground; what it meets later is of no interest
    /// @return the earlier of that and when it meets this node
    static std::optional<double> meetNode(const NodeGround& node, const Ray& ray, std::optional<double> first);
    static Times between(double start, double speed, double low, double high);
    static Times both(const Times& a, const Times& b);

    ColumnOracle& columns_;
    Surface surface_;
    std::map<TileId, Tops> tops_;
    std::map<std::pair<TileId, TileId>, NodeGround> grounds_;  ///< by cell and height tile
};

}  // namespace terray
