#pragma once
// The two entries of a PacketKernel (packet_march.h), for the instruction set that the including .cpp chose (lanes.h).

#include "tests/bench/packet_march/beams.h"
#include "tests/bench/packet_march/packet_march.h"

namespace terray::TERRAY_LANES {

// A packet is 4 x 2 pixels, a square of 8 x 8 is one beam and eight packets, a tile is 4 x 2 squares.
inline constexpr int kPacketWidth = 4;
inline constexpr int kPacketHeight = 2;
inline constexpr int kSquareSide = 8;
inline constexpr int kPackets = kSquareSide * kSquareSide / kLanes;
inline constexpr Int kLaneX = {0, 1, 2, 3, 0, 1, 2, 3};
inline constexpr Int kLaneY = {0, 0, 0, 0, 1, 1, 1, 1};

/// The rays through eight points of a picture, in pixels from the centre of the upper left one.
inline Rays raysThrough(const PictureRays& picture, Float x, Float y) {
    return {.eye = {all(picture.eye.x), all(picture.eye.y)},
            .eyeZ = all(picture.eye.z),
            .direction = {mulAdd(y, all(picture.down.x), mulAdd(x, all(picture.right.x), all(picture.first.x))),
                          mulAdd(y, all(picture.down.y), mulAdd(x, all(picture.right.y), all(picture.first.y)))},
            .rise = mulAdd(y, all(picture.down.z), mulAdd(x, all(picture.right.z), all(picture.first.z)))};
}

/// Packets of a square by their next step. A packet may have lanes for both; those above level 0 go first.
struct Queue {
    int items[kPackets];
    int count = 0;

    void push(int item) { items[count++] = item; }
};

inline void enqueue(const RayPacket& packet, int item, Queue& above, Queue& before) {
    if (any(walking(packet))) {
        above.push(item);
    } else if (any(packet.marching)) {
        before.push(item);
    }
}

/// Marches packets to their ends. They take turns, so that while one waits for memory the others' steps are under way.
inline void marchTogether(const PyramidView& pyramid, RayPacket* packets, CastWork& work) {
    Queue above;   // with lanes above level 0
    Queue before;  // whose lanes are all before a patch
    for (int i = 0; i < kPackets; ++i) enqueue(packets[i], i, above, before);
    while (above.count + before.count > 0) {
        while (above.count > 0) {
            const Queue turn = above;
            above.count = 0;
            work.pyramidSteps += turn.count;
            for (int i = 0; i < turn.count; ++i) {
                pyramidStep(pyramid, packets[turn.items[i]]);
                enqueue(packets[turn.items[i]], turn.items[i], above, before);
            }
        }
        const Queue turn = before;
        before.count = 0;
        work.patchSteps += turn.count;
        for (int i = 0; i < turn.count; ++i) {
            patchStep(pyramid, packets[turn.items[i]]);
            enqueue(packets[turn.items[i]], turn.items[i], above, before);
        }
    }
}

/// A square of 8 x 8 pixels whose rays are still above the ground at `start`. depths: in rows of kTileWidth.
inline void castSquare(const PyramidView& pyramid, const PictureRays& picture, int left, int top, float start,
                       int level, float* depths, CastWork& work) {
    RayPacket packets[kPackets];
    int count = 0;
    for (int y = 0; y < kSquareSide; y += kPacketHeight) {
        for (int x = 0; x < kSquareSide; x += kPacketWidth) {
            const Rays rays = raysThrough(picture, converted(kLaneX + (left + x)), converted(kLaneY + (top + y)));
            packets[count++] = startPacket(pyramid, rays, all(start), all(level));
        }
    }
    marchTogether(pyramid, packets, work);
    const RayPacket* packet = packets;
    for (int y = 0; y < kSquareSide; y += kPacketHeight)
        for (int x = 0; x < kSquareSide; x += kPacketWidth, ++packet)
            for (int lane = 0; lane < kLanes; ++lane)
                depths[(y + kLaneY[lane]) * kTileWidth + x + kLaneX[lane]] = packet->hit[lane];
}

inline void fillSquare(float value, float* depths) {
    for (int y = 0; y < kSquareSide; ++y)
        for (int x = 0; x < kSquareSide; ++x) depths[y * kTileWidth + x] = value;
}

/// Where the rays of the eight squares of a tile may start.
inline BeamStarts findTileStarts(const PyramidView& pyramid, const PictureRays& picture, int left, int top,
                                 CastWork& work) {
    const float middle = 0.5F * (kSquareSide - 1);
    Rays centres = raysThrough(picture, converted(kLaneX * kSquareSide + left) + middle,
                               converted(kLaneY * kSquareSide + top) + middle);
    // From the centre to the outermost rays, and a little more for rounding.
    const float half = 1.01F * middle;
    const float spreadX = half * (__builtin_fabsf(picture.right.x) + __builtin_fabsf(picture.down.x));
    const float spreadY = half * (__builtin_fabsf(picture.right.y) + __builtin_fabsf(picture.down.y));
    const float spreadZ = half * (__builtin_fabsf(picture.right.z) + __builtin_fabsf(picture.down.z));
    centres.rise -= spreadZ;
    int steps = 0;
    const float spread = __builtin_fmaxf(__builtin_fmaxf(spreadX, spreadY), 1e-30F);
    const BeamStarts starts = findStarts(pyramid, centres, all(spread), steps);
    work.beamSteps += steps;
    return starts;
}

inline void castTile(const PyramidView& pyramid, const PictureRays& picture, int left, int top, bool beams,
                     float* depths, CastWork& work) {
    BeamStarts starts = {Float{}, all(pyramid.start)};
    if (beams) starts = findTileStarts(pyramid, picture, left, top, work);
    for (int i = 0; i < kLanes; ++i) {
        const int x = kLaneX[i] * kSquareSide;
        const int y = kLaneY[i] * kSquareSide;
        float* const square = depths + y * kTileWidth + x;
        if (starts.t[i] == __builtin_inff()) {
            fillSquare(starts.t[i], square);
        } else {
            castSquare(pyramid, picture, left + x, top + y, starts.t[i], starts.level[i], square, work);
        }
    }
}

inline void castEight(const PyramidView& pyramid, const MapRay* rays, float* t) {
    Rays lanes;
    for (int i = 0; i < kLanes; ++i) {
        lanes.eye.x[i] = rays[i].eye.x;
        lanes.eye.y[i] = rays[i].eye.y;
        lanes.eyeZ[i] = rays[i].eye.z;
        lanes.direction.x[i] = rays[i].direction.x;
        lanes.direction.y[i] = rays[i].direction.y;
        lanes.rise[i] = rays[i].direction.z;
    }
    RayPacket packet = startPacket(pyramid, lanes, Float{}, all(pyramid.start));
    while (any(packet.marching)) {
        while (any(walking(packet))) pyramidStep(pyramid, packet);
        if (any(packet.marching)) patchStep(pyramid, packet);
    }
    for (int i = 0; i < kLanes; ++i) t[i] = packet.hit[i];
}

}  // namespace terray::TERRAY_LANES
