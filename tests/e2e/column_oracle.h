#pragma once

#include <optional>
#include <unordered_map>
#include <vector>

#include <glm/vec3.hpp>

#include "client/stream/dataset_source.h"
#include "common/draw_node.h"
#include "common/grid.h"
#include "common/view.h"

namespace terray {

/// Says what a ray meets among the columns of a draw list, by plain cell-to-cell stepping in double on the CPU,
/// 16 x 16 cells at a time where the ray is above them all: no pyramid, no mirrored frame, no code in common with the
/// shaders.
class ColumnOracle {
  public:
    explicit ColumnOracle(const TileSource& source);

    /// How columns are resized before a ray is tried against them, so that an answer is sure in spite of float rounding
    /// on the GPU, which moves a ray by at most a few 2^-23 of the distance.
    enum class Columns {
        shrunk,  ///< a ray that meets one certainly meets the ground
        grown,   ///< a ray that meets none certainly clears it
    };
    /// View depth at which a ray of a picture, straight or bent (View::earth), first meets a column. Each is smaller
    /// (or larger) by 1 cm + 2^-20 of the distance on its top and its four sides, and reaches down to `floor` (metres);
    /// what a bent ray meets when it comes up again from below that does not count. Directions as View::direction gives
    /// them.
    [[nodiscard]] std::optional<double> meet(const std::vector<DrawNode>& nodes, const View& view,
                                             const glm::dvec3& direction, Columns columns, double floor);

    [[nodiscard]] const TileSource& source() const { return source_; }
    /// The tile's samples, decoded once.
    [[nodiscard]] const HeightTile& tile(const TileId& id);

  private:
    struct Ray {
        glm::dvec3 eye;
        glm::dvec3 direction;
        double bend;  ///< metres of height gained per squared unit of t
        double sign;  ///< of the change: -1 shrunk, 1 grown
        double floor;
    };
    /// Samples along the side of a block that rays may pass over at once.
    static constexpr int64_t kBlock = 16;
    /// Of each block of kBlock x kBlock core samples, the highest code in it and next to it.
    const Grid<uint16_t>& blockTops(const HeightTile& tile);
    /// @param first  when the ray met other ground; what it meets later is of no interest
    /// @return the earlier of that and when it meets this node
    std::optional<double> meetNode(const DrawNode& node, const Ray& ray, std::optional<double> first);

    const TileSource& source_;
    std::unordered_map<TileId, HeightTile> tiles_;
    std::unordered_map<TileId, Grid<uint16_t>> blockTops_;
};

}  // namespace terray
