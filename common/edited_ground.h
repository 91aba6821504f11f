#pragma once

#include <optional>

#include "common/edit_bounds.h"
#include "common/height_tile.h"
#include "common/terrain_edit.h"
#include "common/tiling.h"

namespace terray {

/// What edits make of a height tile, all but its samples.
struct EditedTile {
    EditList edits;  ///< those near its samples, apron included
    /// Of the edited codes: the tile's own where the edited heights fit, else one that they fit with the smallest
    /// exponent, so that nothing is clipped. Samples that no edit touches keep their heights to the last bit unless the
    /// exponent grows: then they are rounded to its step.
    HeightEncoding encoding;
    HeightRecord record;   ///< bounds of the edited samples, see EditedGround::record
    glm::dvec2 corner{0};  ///< metres: the root square's north-western corner
    double spacing = 1;    ///< metres between samples of the tile's level
};

/// A dataset's ground under a list of edits: which tiles they concern, and what they do to encodings and records.
///
/// A tile's samples are edited at their centres, whatever its level: a coarse sample, the mean m of finer ones, becomes
/// T(c, m), where T(p, h) is what the edits make of height h at place p and c the sample's centre. The mean of the
/// edited finer samples differs from it, and so do those themselves; record() says by how much at most. What is
/// narrower than the finest samples is not resolved: it shows where a sample's centre happens to lie in it.
///
/// The arithmetic of a sample depends on its place in the dataset's grid and its stored height alone, not on the tile:
/// the core of one tile and the apron of its neighbour agree to the last bit where their exponents do, and else to half
/// a step of each.
class EditedGround {
  public:
    /// @param quantum  of the dataset, metres  @param edits  valid() (misuse otherwise)
    EditedGround(const Tiling& tiling, double quantum, EditList edits);

    [[nodiscard]] const EditList& edits() const { return edits_; }
    /// Those that may change a sample of a tile, apron included; two lists that agree in this leave the tile alike.
    [[nodiscard]] EditList near(const TileId& id) const;

    /// The record of a tile whose stored record is given; none where no edit is near, or where there is no surface.
    ///
    /// Bounds: of all samples T(c, h) with h in the stored bounds and c in the tile or its apron, widened by half a
    /// step for rounding to codes. A coarser tile's samples with centres there lie within them too, as its means do
    /// within the stored bounds: what selection says of stand-ins and walls holds for edited ground.
    ///
    /// Error: with stored error e, a core sample of height H at c and a finest source sample h at p beneath it, |H - h|
    /// <= e and |c - p| <= (S - s) / sqrt(2) for the spacings S of the tile and s of the finest samples, so
    ///     |T(c, H) - T(p, h)| <= |T(c, H) - T(c, h)| + |T(c, h) - T(p, h)| <= e + variation,
    /// with editBounds' variation over that distance; half a step comes on top. At the finest level only that does. So
    /// a tile is refined until steps of a crater's wall are below the tolerance, or the finest samples are reached.
    /// That is of samples, so of columns. Of bilinear surfaces e is counted, the edits between samples are not: a patch
    /// spans an edit's slope over the spacing S in place of (S - s) / sqrt(2), so it may be off by some more.
    ///
    /// Bounds are taken from squares of the tile, halved until one edit is left, or all reach as far as the square is
    /// wide, or it has 16 samples a side, so that edits far from one another do not add up. That costs time in
    /// proportion to the edits near the tile, a few microseconds for each.
    ///
    /// @param leastStep  metres per code of the tile where that is known
    [[nodiscard]] std::optional<HeightRecord> record(const TileId& id, const HeightRecord& stored,
                                                     double leastStep = 0) const;

    /// Metres per code of a tile that record() describes, at most.
    [[nodiscard]] double stepOf(const HeightRecord& edited, double leastStep) const;

    /// What becomes of a tile; none where no edit is near.
    [[nodiscard]] std::optional<EditedTile> describe(const HeightTile& tile) const;

  private:
    struct Bounds;
    void collect(const GroundRect& square, std::span<const TerrainEdit> edits, Bounds& bounds) const;
    [[nodiscard]] std::optional<Bounds> boundsOf(const TileId& id, const HeightRecord& stored) const;
    [[nodiscard]] HeightRecord recordFrom(const Bounds& bounds, const HeightRecord& stored, double leastStep) const;

    Tiling tiling_;
    double quantum_;
    EditList edits_;
};

}  // namespace terray
