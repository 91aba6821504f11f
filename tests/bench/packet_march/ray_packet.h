#pragma once
// Eight rays on their way through a HeightPyramid: the march of shaders/march.glsl on the bilinear surface, one ray a
// lane.
//
// Each lane has its own cell and level. pyramidStep() moves the lanes that are above level 0, patchStep() those that
// stand before a patch; a lane that waits for the other kind of step is left as it is. Watertight as the shader is:
// cells are integers, t never decreases, the sign of the clearance at both ends of a patch decides, and the ground is
// solid. A march ends: each step of a lane raises a cell coordinate or goes one level down, and levels rise only with a
// coordinate.

#include "tests/bench/packet_march/height_pyramid.h"
#include "tests/bench/packet_march/lane_math.h"

namespace terray::TERRAY_LANES {

/// Eight rays, map frame.
struct Rays {
    Pair eye;
    Float eyeZ;
    Pair direction;
    Float rise;  ///< change of z per unit of t
};

struct RayPacket {
    // What stays. Mirrored in x where mirrorX is set, in y where mirrorY is.
    Pair eye;
    Pair direction;
    Pair inverse;
    Float eyeZ;
    Float rise;
    Float inverseRise;
    Float exit;  ///< t at which the ray leaves the map, or rises above all of it
    Int mirrorX;
    Int mirrorY;
    // Where the rays are.
    Float t;
    IntPair cell;
    Int level;
    Int marching;  ///< mask; neither hit nor gone
    Float hit;     ///< t of the hit; infinity while there is none
};

inline Int walking(const RayPacket& packet) {
    return packet.marching & (packet.level > 0);
}

/// Index of the block of a level that holds a cell, given unmirrored.
inline Int blockIndex(int32_t coarsest, IntPair cell, Int level) {
    const Int depth = coarsest - level;
    const Int start = 0x55555555 & ~(all(-1) << (depth << 1));
    return start + ((cell.y >> level) << depth) + (cell.x >> level);
}

/// Where a cell is stored: undoes the mirroring.
inline IntPair unmirrored(const PyramidView& pyramid, const RayPacket& packet, IntPair cell) {
    const int32_t last = (1 << pyramid.coarsest) - 1;
    return {cell.x ^ (packet.mirrorX & last), cell.y ^ (packet.mirrorY & last)};
}

/// The map's cells from the low corner up to, not including, the high one, mirrored with the rays.
struct MapEdges {
    IntPair low;
    IntPair high;
};

inline MapEdges mapEdges(const PyramidView& pyramid, const RayPacket& packet) {
    const int32_t side = 1 << pyramid.coarsest;
    const IntPair low = {packet.mirrorX & (side - pyramid.width + 1), packet.mirrorY & (side - pyramid.height + 1)};
    return {low, {low.x + (pyramid.width - 1), low.y + (pyramid.height - 1)}};
}

/// Rays that are at `start` on their way (t, >= 0), above the ground if they were above it before, at the given level.
inline RayPacket startPacket(const PyramidView& pyramid, const Rays& rays, Float start, Int level) {
    RayPacket packet;
    const float side = static_cast<float>(1 << pyramid.coarsest);
    packet.mirrorX = rays.direction.x < 0;
    packet.mirrorY = rays.direction.y < 0;
    packet.eye = {select(packet.mirrorX, side - rays.eye.x, rays.eye.x),
                  select(packet.mirrorY, side - rays.eye.y, rays.eye.y)};
    packet.direction = {magnitude(rays.direction.x), magnitude(rays.direction.y)};
    packet.inverse = {safeInverse(packet.direction.x), safeInverse(packet.direction.y)};
    packet.eyeZ = rays.eyeZ;
    packet.rise = rays.rise;
    packet.inverseRise = safeInverse(rays.rise);

    const MapEdges map = mapEdges(pyramid, packet);
    const Pair enterTimes = edgeTimes(map.low, packet.eye, packet.inverse);
    const Pair exitTimes = edgeTimes(map.high, packet.eye, packet.inverse);
    const Float enter = maximum(start, maximum(enterTimes.x, enterTimes.y));
    const Float exit = minimum(exitTimes.x, exitTimes.y);

    // A falling ray has nothing to meet before the greatest code, a rising one nothing after it.
    const Int falls = rays.rise < 0;
    const Float topTime = (static_cast<float>(pyramid.maxima[0]) - rays.eyeZ) * packet.inverseRise;
    packet.t = select(falls, maximum(enter, topTime), enter);
    packet.exit = select(falls, exit, minimum(exit, topTime));
    packet.marching = packet.t <= packet.exit;
    packet.cell = {clamp(truncated(mulAdd(packet.t, packet.direction.x, packet.eye.x)), map.low.x, map.high.x - 1),
                   clamp(truncated(mulAdd(packet.t, packet.direction.y, packet.eye.y)), map.low.y, map.high.y - 1)};
    packet.level = level;
    packet.hit = all(__builtin_inff());
    return packet;
}

/// Moves lanes to `t`, in their block or through `crossing` out of it, and to `level`; those that cross where the map
/// ends are gone. Lanes outside `moving` stay.
inline void advance(RayPacket& packet, Int moving, Float t, IntPair edge, Crossing crossing, Int level) {
    const IntPair at = {truncated(mulAdd(t, packet.direction.x, packet.eye.x)),
                        truncated(mulAdd(t, packet.direction.y, packet.eye.y))};
    const IntPair cell = cellFrom(at, packet.cell, edge, crossing);
    const Int gone = moving & (crossing.x | crossing.y) & (t >= packet.exit);
    packet.t = select(moving, t, packet.t);
    packet.cell = {select(moving, cell.x, packet.cell.x), select(moving, cell.y, packet.cell.y)};
    packet.level = select(moving, level, packet.level);
    packet.marching &= ~gone;
}

/// One step of the lanes above level 0: into their block where the ray meets its maximum, past it elsewhere.
inline void pyramidStep(const PyramidView& pyramid, RayPacket& packet) {
    const Int moving = walking(packet);
    const Int index = blockIndex(pyramid.coarsest, unmirrored(pyramid, packet, packet.cell), packet.level);
    const Float top = converted(gatherPairs(pyramid.maxima, index, moving) & 0xffff);
    const IntPair edge = blockEdge(packet.cell, packet.level);
    const Pair times = edgeTimes(edge, packet.eye, packet.inverse);
    const Float leave = maximum(packet.t, minimum(minimum(times.x, times.y), packet.exit));

    // column.glsl: a rising ray is lowest where it enters, a falling one where it leaves.
    const Int falls = packet.rise < 0;
    const Int meets = mulAdd(select(falls, leave, packet.t), packet.rise, packet.eyeZ) <= top;
    const Float onTop = clamp((top - packet.eyeZ) * packet.inverseRise, packet.t, leave);
    const Float next = select(meets, select(falls, onTop, packet.t), leave);

    const Crossing crossing = {~meets & (times.x <= times.y), ~meets & (times.x > times.y)};
    const Int level = select(meets, packet.level - 1, levelAfter(packet.level, all(pyramid.coarsest), edge, crossing));
    advance(packet, moving, next, edge, crossing, level);
}

/// One step of the lanes at level 0: a hit with the patch, or past it.
inline void patchStep(const PyramidView& pyramid, RayPacket& packet) {
    const Int moving = packet.marching & (packet.level == 0);
    const IntPair stored = unmirrored(pyramid, packet, packet.cell);
    const Int index = stored.y * pyramid.width + stored.x;
    const Int north = gatherPairs(pyramid.codes, index, moving);
    const Int south = gatherPairs(pyramid.codes, index + pyramid.width, moving);
    const Corners corners = {converted(north & 0xffff), converted((north >> 16) & 0xffff), converted(south & 0xffff),
                             converted((south >> 16) & 0xffff)};
    const IntPair edge = {packet.cell.x + 1, packet.cell.y + 1};
    const Pair times = edgeTimes(edge, packet.eye, packet.inverse);
    const Float leave = maximum(packet.t, minimum(minimum(times.x, times.y), packet.exit));

    // The patch is as it is stored, so the ray's part over it is mirrored back.
    const Pair walked = {mulAdd(packet.t, packet.direction.x, packet.eye.x) - converted(packet.cell.x),
                         mulAdd(packet.t, packet.direction.y, packet.eye.y) - converted(packet.cell.y)};
    const Pair inCell = {clamp(walked.x, Float{}, all(1.0F)), clamp(walked.y, Float{}, all(1.0F))};
    const Pair at = {select(packet.mirrorX, 1.0F - inCell.x, inCell.x),
                     select(packet.mirrorY, 1.0F - inCell.y, inCell.y)};
    const Pair direction = {negatedWhere(packet.mirrorX, packet.direction.x),
                            negatedWhere(packet.mirrorY, packet.direction.y)};
    const Float height = mulAdd(packet.t, packet.rise, packet.eyeZ);
    const Contact contact = firstContact(patchClearance(corners, at, height, direction, packet.rise), leave - packet.t);

    const Int hits = moving & contact.touches;
    packet.hit = select(hits, packet.t + contact.s, packet.hit);
    packet.marching &= ~hits;
    const Crossing crossing = {times.x <= times.y, times.x > times.y};
    const Int level = levelAfter(Int{}, all(pyramid.coarsest), edge, crossing);
    advance(packet, moving & ~hits, leave, edge, crossing, level);
}

}  // namespace terray::TERRAY_LANES
