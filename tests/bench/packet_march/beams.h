#pragma once
// Where the rays of a beam may start: eight beams at once, one a lane, each a square of neighbouring pixels.
//
// A beam is marched as its central ray, thickened: at depth t its rays lie within spread * t cells of the centre in x
// and in y, and none lies lower than the ray with the least rise. While that distance is at most a block's side, the
// rays are over the 3 x 3 blocks around the centre's, whose maximum PyramidView::around holds; so a step of the beam is
// a step of a ray that looks up another table. It goes down until blocks become smaller than the beam is wide. What
// lies before is empty for all its rays, and a beam that leaves the map has none that hits. Source: Reshetov, Soupikov,
// Hurley 2005, "Multi-level ray tracing algorithm", doi 10.1145/1073204.1073329 (entry points for groups of rays);
// Amanatides 1984, "Ray tracing with cones", doi 10.1145/800031.808589.

#include "tests/bench/packet_march/packet_march.h"
#include "tests/bench/packet_march/ray_packet.h"

namespace terray::TERRAY_LANES {

/// Eight beams of rays with one eye.
struct Beams {
    Rays centres;  ///< the central rays, but rise: least of each beam's rays
    Float spread;  ///< cells by which a beam's rays lie beside its centre at t = 1, > 0
};

/// How far beams are known to be above the ground.
struct BeamStarts {
    Float t;    ///< no ray of the beam meets the ground before; infinity: none does at all
    Int level;  ///< for its rays to start with: one finer than the block that stopped the beam
};

inline RayPacket startBeams(const PyramidView& pyramid, const Beams& beams) {
    RayPacket packet = startPacket(pyramid, beams.centres, Float{}, all(pyramid.coarsest));

    // The slabs of the map, for the ray of the beam that enters first and the one that leaves last.
    const MapEdges map = mapEdges(pyramid, packet);
    const Pair first = {safeInverse(packet.direction.x + beams.spread), safeInverse(packet.direction.y + beams.spread)};
    const Pair last = {safeInverse(maximum(packet.direction.x - beams.spread, Float{})),
                       safeInverse(maximum(packet.direction.y - beams.spread, Float{}))};
    const Pair enterTimes = edgeTimes(map.low, packet.eye, first);
    const Pair exitTimes = edgeTimes(map.high, packet.eye, last);
    const Float enter = maximum(Float{}, maximum(enterTimes.x, enterTimes.y));
    const Float exit = minimum(exitTimes.x, exitTimes.y);

    const Int falls = beams.centres.rise < 0;
    const Float topTime = (static_cast<float>(pyramid.maxima[0]) - beams.centres.eyeZ) * packet.inverseRise;
    packet.t = select(falls, maximum(enter, topTime), enter);
    packet.exit = select(falls, exit, minimum(exit, topTime));
    packet.marching = packet.t <= packet.exit;
    // A centre beside the map is in a cell that does not exist. advance() may put it one cell too far there; beamStep()
    // takes all of these cells for the map's first.
    packet.cell = {floored(mulAdd(packet.t, packet.direction.x, packet.eye.x)),
                   floored(mulAdd(packet.t, packet.direction.y, packet.eye.y))};
    return packet;
}

/// One step of all beams; fills in the starts of those that stop.
inline void beamStep(const PyramidView& pyramid, RayPacket& beams, Float spread, BeamStarts& starts) {
    // For a cell beside the map stands the nearest one: a ray that is over the map is nearer to it still.
    const Int last = all((1 << pyramid.coarsest) - 1);
    const IntPair nearest = {clamp(beams.cell.x, Int{}, last), clamp(beams.cell.y, Int{}, last)};
    const Int index = blockIndex(pyramid.coarsest, unmirrored(pyramid, beams, nearest), beams.level);
    const Float top = converted(gatherPairs(pyramid.around, index, beams.marching) & 0xffff);
    const IntPair edge = blockEdge(beams.cell, beams.level);
    const Pair times = edgeTimes(edge, beams.eye, beams.inverse);
    const Float beyond = minimum(minimum(times.x, times.y), beams.exit);
    const Float wide = converted(all(1) << beams.level) / spread;  // t at which the beam outgrows the block
    const Int outgrows = wide < beyond;
    const Float leave = maximum(beams.t, minimum(beyond, wide));

    const Int falls = beams.rise < 0;
    const Int meets = mulAdd(select(falls, leave, beams.t), beams.rise, beams.eyeZ) <= top;
    const Float onTop = clamp((top - beams.eyeZ) * beams.inverseRise, beams.t, leave);
    const Float next = select(meets, select(falls, onTop, beams.t), leave);

    const Int canGoDown = (beams.level > 1) & (next < 0.5F * wide);
    const Int coarsest = all(pyramid.coarsest);
    const Int stops = beams.marching & ((meets & ~canGoDown) | (~meets & outgrows & (beams.level == coarsest)));
    starts.t = select(stops, next, starts.t);
    starts.level = select(stops, maximum(beams.level - 1, all(1)), starts.level);

    const Int passes = ~meets & ~outgrows;
    const Crossing crossing = {passes & (times.x <= times.y), passes & (times.x > times.y)};
    const Int above =
        select(outgrows, minimum(beams.level + 1, coarsest), levelAfter(beams.level, coarsest, edge, crossing));
    beams.marching &= ~stops;
    advance(beams, beams.marching, next, edge, crossing, select(meets, beams.level - 1, above));
}

/// Marches beams from the eye until all have stopped or left the map.
inline BeamStarts marchBeams(const PyramidView& pyramid, const Beams& beams, CastWork& work) {
    BeamStarts starts = {all(__builtin_inff()), all(pyramid.start)};
    RayPacket packet = startBeams(pyramid, beams);
    for (; any(packet.marching); ++work.beamSteps) beamStep(pyramid, packet, beams.spread, starts);
    return starts;
}

}  // namespace terray::TERRAY_LANES
