#include "client/stream/selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "client/stream/selection_geometry.h"
#include "common/check.h"

namespace terray {
namespace {

/// How many levels a stand-in may lie above its cell: a sample of it (its tile's side / 512) then still lies inside the
/// cell, so that the cell's own record bounds it. Deeper, the tile between is loaded first.
constexpr uint32_t kMaxStandInLevels = 9;

/// What one layer (heights or photo) shows in a cell.
struct Choice {
    std::optional<TileId> drawn;  ///< the deepest resident tile that covers the cell, down to what is wanted
    bool settled = false;         ///< nothing finer is wanted beneath this cell
    bool exact = false;           ///< once settled: drawn is what is wanted
    bool finer = false;           ///< once settled: what is wanted is lacking, but all of its children are resident
};

struct Cell {
    TileId id;
    bool seen = true;  ///< it may be in the picture; else only its shadow may
    Neighbourhood ground;
    Choice heights;
    Choice imagery;
    uint32_t heightLevel = 0;  ///< of the tile that heights are drawn from once all is resident
};

/// The finest that a subtree has put on the draw list, as levels + 1; 0: nothing.
struct Shown {
    uint32_t heights = 0;
    uint32_t imagery = 0;
};
/// Shown::imagery where there is known to be no photo, or none is asked for: nothing can be finer.
constexpr uint32_t kNoPhoto = std::numeric_limits<uint32_t>::max();

/// How far above a cell the tile lies that its heights are drawn from, unless a deeper one is found.
uint32_t levelsAbove(const Cell& cell) {
    return cell.id.level - cell.heights.drawn->level;
}

/// What a cell shows when it is drawn whole.
Shown shownBy(const Cell& cell) {
    const Choice& photo = cell.imagery;
    const bool noPhoto = photo.settled && photo.exact && !photo.drawn;
    return {cell.heights.drawn->level + 1, noPhoto ? kNoPhoto : photo.drawn ? photo.drawn->level + 1 : 0};
}

/// One traversal of the tree with tolerances multiplied.
class Traversal {
  public:
    Traversal(const TileTree& tree, const View& view, const SelectionOptions& options, const Coarsening& coarsening)
        : tree_(tree),
          view_(view),
          options_(options),
          coarsening_(coarsening),
          frustum_(view),
          bounds_(tree),
          useImagery_(options.useImagery && tree.hasImagery()),
          lowest_(seenBoxOf(TileId{}, {bounds_.ofRoot()[4].low, bounds_.ofRoot()[4].low}, tree.tiling(), view).min.z) {}

    Selection run();
    /// Whether the traversal was given up because the list had grown far beyond maxNodes.
    [[nodiscard]] bool overflowed() const { return overflowed_; }

  private:
    Shown visit(Cell cell);
    Shown visitChildren(const Cell& cell);
    Shown emit(const Cell& cell, Metres distance);
    /// Whether a cell is worth a visit; `seen` is set when more than its shadow may be in the picture.
    bool concerns(const TileId& cell, const HeightRange& heights, bool& seen) const;
    void request(TileLayer layer, const Cell& cell, Pixels error);
    void chooseHeights(Cell& cell, Metres distance);
    /// Whether a tile's heights are as fine as its distance asks.
    [[nodiscard]] bool heightsSuffice(const TileId& cell, Metres distance) const;
    void chooseImagery(Cell& cell, Metres distance);
    std::optional<Cell> childOf(const Cell& cell, uint32_t quadrant) const;
    /// Whether all children of a tile that have something to show are resident.
    bool childrenDrawable(TileLayer layer, const TileId& tile) const;
    /// Of a height error as it shows in an exaggerated picture.
    [[nodiscard]] Pixels heightError(const HeightRecord& record, Metres distance) const {
        return screenError(Metres(view_.exaggeration * record.error), distance, view_);
    }
    [[nodiscard]] Pixels texelSide(uint32_t level, Metres distance) const {
        return screenError(Metres(tree_.tiling().spacing(level)), distance, view_);
    }

    const TileTree& tree_;
    const View& view_;
    const SelectionOptions& options_;
    Coarsening coarsening_;
    Frustum frustum_;
    GroundBounds bounds_;
    bool useImagery_;
    double lowest_;  ///< metres: of all ground, as it is seen
    bool overflowed_ = false;
    Selection result_;
};

/// Quadrants of a cell in the order in which rays from the eye meet them. The two lines through the cell's centre part
/// them, and a ray crosses each at most once, away from the eye: the eye's quadrant is first, the opposite one last,
/// and no ray meets both of the others.
std::array<uint32_t, 4> frontToBack(const TileId& cell, const glm::dvec3& eye, const Tiling& tiling) {
    const GroundRect last = tiling.bounds(cell.child(3));
    const uint32_t east = eye.x >= last.west ? 1 : 0;
    const uint32_t south = eye.y < last.north ? 2 : 0;
    const uint32_t nearest = east | south;
    return {nearest, nearest ^ 1, nearest ^ 2, nearest ^ 3};
}

bool moreUrgent(const TileRequest& a, const TileRequest& b) {
    if (a.priority != b.priority) return a.priority > b.priority;
    return std::tuple(a.layer, a.id) < std::tuple(b.layer, b.id);
}

Selection Traversal::run() {
    const TileId root;
    const auto* heights = tree_.heights(root);
    TERRAY_CHECK(heights != nullptr && heights->resident);
    const Neighbourhood ground = bounds_.ofRoot();
    if (!ground[4].surface) return {};
    visit({.id = root,
           .ground = ground,
           .heights = {.drawn = root},
           .imagery = {.settled = !useImagery_, .exact = !useImagery_}});
    std::sort(result_.wanted.begin(), result_.wanted.end(), moreUrgent);
    return std::move(result_);
}

Shown Traversal::visit(Cell cell) {
    if (overflowed_) return {};
    // Not how high a stand-in may reach: what a view needs would else hang on what is resident, and come and go in
    // turn.
    const uint32_t levelsAboveCell = cell.id.level - cell.heightLevel;
    const HeightRange reach{bounds_.wallFoot(cell.ground), bounds_.highest(cell.ground, levelsAboveCell)};
    if (!concerns(cell.id, reach, cell.seen)) return {};
    const HeightRange heights{cell.ground[4].bottom, cell.ground[4].top};
    const Metres distance = distanceTo(seenBoxOf(cell.id, heights, tree_.tiling(), view_), view_.eye);
    chooseHeights(cell, distance);
    chooseImagery(cell, distance);
    const bool finer = cell.heights.finer || cell.imagery.finer;
    if (cell.heights.settled && cell.imagery.settled && !finer) return emit(cell, distance);

    // Split; where that shows nothing finer, draw the one cell instead.
    const size_t nodesBefore = result_.nodes.size(), castersBefore = result_.casters.size();
    const Shown beneath = visitChildren(cell);
    const Shown own = shownBy(cell);
    const bool finerBeneath = beneath.heights > own.heights || beneath.imagery > own.imagery;
    const bool nothing = result_.nodes.size() == nodesBefore && result_.casters.size() == castersBefore;
    if (finerBeneath || nothing) return beneath;
    result_.nodes.resize(nodesBefore);
    result_.casters.resize(castersBefore);
    return emit(cell, distance);
}

bool Traversal::concerns(const TileId& cell, const HeightRange& heights, bool& seen) const {
    const Box box = seenBoxOf(cell, heights, tree_.tiling(), view_);
    seen = frustum_.mayMeet(box);
    if (seen || !options_.shadowsFrom) return seen;
    // A shadow ends at the lowest ground there is.
    const glm::dvec3& sun = *options_.shadowsFrom;
    const double length = std::max(box.max.z - lowest_, 0.0) / sun.z;
    return frustum_.mayMeetShadow(box, -sun, length);
}

void Traversal::request(TileLayer layer, const Cell& cell, Pixels error) {
    result_.wanted.push_back({layer, cell.id, cell.seen ? error.value() : error.value() / 2});
}

Shown Traversal::visitChildren(const Cell& cell) {
    Shown all;
    for (const uint32_t quadrant : frontToBack(cell.id, view_.eye, tree_.tiling())) {
        const auto child = childOf(cell, quadrant);
        if (!child) continue;
        const Shown shown = visit(*child);
        all = {std::max(all.heights, shown.heights), std::max(all.imagery, shown.imagery)};
    }
    return all;
}

std::optional<Cell> Traversal::childOf(const Cell& cell, uint32_t quadrant) const {
    Cell child = cell;
    child.id = cell.id.child(quadrant);
    if (!cell.heights.settled) child.heightLevel = child.id.level;
    const uint32_t deepest = std::min(tree_.finestHeightLevel(), cell.heights.drawn->level + kMaxStandInLevels);
    child.ground = bounds_.ofChild(cell.ground, child.id, deepest);
    if (!child.ground[4].surface) return {};
    if (cell.heights.finer) child.heights = {.drawn = child.id, .settled = true};
    if (cell.imagery.finer) {
        const bool exists = tree_.imagery(child.id)->exists;
        child.imagery = {.drawn = exists ? child.id : cell.imagery.drawn, .settled = true};
    }
    if (!cell.imagery.settled && !tree_.imagery(child.id)->exists) child.imagery = {.settled = true, .exact = true};
    return child;
}

bool Traversal::heightsSuffice(const TileId& cell, Metres distance) const {
    if (!options_.lodDistance)
        return heightError(tree_.heights(cell)->record, distance) <= options_.tolerance * coarsening_.heights;
    const double finer = tree_.tiling().spacing(cell.level + 1);
    constexpr double kLeastDistance = 1e-3;  // as in screenError: some factor must let the root suffice
    return coarsening_.heights * std::max(distance.value(), kLeastDistance) >= *options_.lodDistance * finer;
}

void Traversal::chooseHeights(Cell& cell, Metres distance) {
    Choice& choice = cell.heights;
    if (choice.settled) return;
    const auto& own = *tree_.heights(cell.id);
    const Pixels standInError = heightError(tree_.heights(*choice.drawn)->record, distance);
    // Nothing coarser may stand in for what lies beneath, so it is needed even where finer tiles are drawn.
    const bool bridges = levelsAbove(cell) >= kMaxStandInLevels;
    if (own.resident) choice.drawn = cell.id;
    const bool fineEnough = cell.id.level == tree_.finestHeightLevel() || heightsSuffice(cell.id, distance);
    choice.settled = fineEnough || !own.childrenKnown || (bridges && !own.resident);
    if (!choice.settled && !bridges) return;
    if (cell.id.level > 0) result_.heightTiles.push_back(cell.id);
    if (!choice.settled) return;
    choice.exact = own.resident;
    if (choice.exact) return;
    request(TileLayer::heights, cell, standInError);
    choice.finer = own.childrenKnown && childrenDrawable(TileLayer::heights, cell.id);
}

bool Traversal::childrenDrawable(TileLayer layer, const TileId& tile) const {
    bool any = false;
    for (uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
        const TileId child = tile.child(quadrant);
        const auto drawable = [&any](const auto* known, bool exists) {
            any |= exists;
            return known != nullptr && (known->resident || !exists);
        };
        if (layer == TileLayer::heights) {
            const auto* known = tree_.heights(child);
            if (!drawable(known, known != nullptr && known->record.exists)) return false;
        } else {
            const auto* known = tree_.imagery(child);
            if (!drawable(known, known != nullptr && known->exists)) return false;
        }
    }
    return any;
}

void Traversal::chooseImagery(Cell& cell, Metres distance) {
    Choice& choice = cell.imagery;
    if (choice.settled) return;
    if (!cell.seen) {  // a shadow has no colour
        choice = {.drawn = choice.drawn, .settled = true, .exact = true};
        return;
    }
    const auto* own = tree_.imagery(cell.id);  // null only for a root that has not been learnt
    const Pixels standInTexel = texelSide(choice.drawn ? choice.drawn->level : 0, distance);
    if (own != nullptr && own->resident) choice.drawn = cell.id;
    const bool fineEnough = cell.id.level == *tree_.finestImageryLevel() ||
                            texelSide(cell.id.level, distance) <= options_.imageryTolerance * coarsening_.imagery;
    const bool mustLoadFirst = own == nullptr || !own->childrenKnown;
    if (!fineEnough && !mustLoadFirst) return;
    choice.settled = true;
    choice.exact = own != nullptr && own->resident;
    if (cell.id.level > 0) result_.imageryTiles.push_back(cell.id);
    if (choice.exact) return;
    request(TileLayer::imagery, cell, standInTexel);
    choice.finer = own != nullptr && own->childrenKnown && childrenDrawable(TileLayer::imagery, cell.id);
}

Shown Traversal::emit(const Cell& cell, Metres distance) {
    const HeightRecord& source = tree_.heights(*cell.heights.drawn)->record;
    const DrawNode node{
        .cell = cell.id,
        .heightTile = *cell.heights.drawn,
        .imageryTile = cell.imagery.drawn,
        .minHeight = bounds_.wallFoot(cell.ground),
        .maxHeight = std::min(double{source.maxHeight}, bounds_.top(cell.ground, levelsAbove(cell))),
        .screenError = heightError(source, distance).value(),
        .heightsExact = cell.heights.settled && cell.heights.exact,
        .imageryExact = cell.imagery.settled && cell.imagery.exact,
    };
    bool seen = true;
    if (!concerns(cell.id, {node.minHeight, node.maxHeight}, seen)) return {};
    (seen ? result_.nodes : result_.casters).push_back(node);
    if (!seen) result_.casters.back().imageryTile.reset();
    overflowed_ = result_.nodes.size() + result_.casters.size() >
                  4 * options_.maxNodes + 64;  // some may yet be merged, but not that many
    return shownBy(cell);
}

/// Traversals of one tree for one view, coarser and coarser until the limits are kept.
class Fitting {
  public:
    Fitting(const TileTree& tree, const View& view, const SelectionOptions& options)
        : tree_(tree), view_(view), options_(options) {}

    Selection run() {
        const double both = leastFactor(1, [this](double f) { return nodesFit({f, f}); });
        const Coarsening& least = options_.leastCoarsening;
        const double heights = leastFactor(std::max(both, least.heights), [&](double f) {
            return draw({f, both}).heightTiles.size() <= options_.maxHeightTiles;
        });
        const double imagery = leastFactor(std::max(both, least.imagery), [&](double f) {
            return draw({heights, f}).imageryTiles.size() <= options_.maxImageryTiles;
        });
        (void)draw({heights, imagery});
        return std::move(*last_);
    }

  private:
    const Selection& draw(const Coarsening& coarsening) {
        if (last_ && last_->coarsening == coarsening) return *last_;
        Traversal traversal(tree_, view_, options_, coarsening);
        last_ = traversal.run();
        last_->coarsening = coarsening;
        overflowed_ = traversal.overflowed();
        return *last_;
    }
    bool nodesFit(const Coarsening& coarsening) {
        const Selection& selection = draw(coarsening);
        return !overflowed_ && selection.nodes.size() + selection.casters.size() <= options_.maxNodes;
    }
    /// The least factor, to within 10 %, that is accepted and no less than `least`. The root alone is accepted always.
    template <class Accepts>
    static double leastFactor(double least, const Accepts& accepts) {
        if (accepts(least)) return least;
        double refused = least, accepted = 2 * least;
        for (; !accepts(accepted); accepted *= 4) {
            refused = accepted;
            TERRAY_CHECK_OP(accepted, <, 1e30);
        }
        while (accepted > 1.1 * refused) {
            const double middle = std::sqrt(refused * accepted);
            (accepts(middle) ? accepted : refused) = middle;
        }
        return accepted;
    }

    const TileTree& tree_;
    const View& view_;
    const SelectionOptions& options_;
    std::optional<Selection> last_;
    bool overflowed_ = false;
};

}  // namespace

Pixels screenError(Metres error, Metres distance, const View& view) {
    return Pixels(error.value() / std::max(distance.value(), 1e-3) * view.focalPixels());
}

Selection select(const TileTree& tree, const View& view, const SelectionOptions& options) {
    TERRAY_CHECK_OP(options.maxNodes, >, size_t{0});
    return Fitting(tree, view, options).run();
}

void sortFrontToBack(std::vector<DrawNode>& nodes, const Tiling& tiling, const glm::dvec3& eye) {
    // A path from the root as a number, two bits a level: at each, which of the four the ray meets first.
    const auto rank = [&](const TileId& cell) {
        uint64_t path = 0;
        for (uint32_t level = 0; level < kMaxTileLevel; ++level) {
            uint64_t place = 0;
            if (level < cell.level) {
                const auto order = frontToBack(cell.ancestor(cell.level - level), eye, tiling);
                const uint32_t quadrant = cell.ancestor(cell.level - level - 1).quadrant();
                place = static_cast<uint64_t>(std::find(order.begin(), order.end(), quadrant) - order.begin());
            }
            path = path << 2 | place;
        }
        return path;
    };
    std::vector<std::pair<uint64_t, DrawNode>> ranked;
    for (const DrawNode& node : nodes) ranked.emplace_back(rank(node.cell), node);
    std::sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (size_t n = 0; n < nodes.size(); ++n) nodes[n] = ranked[n].second;
}

}  // namespace terray
