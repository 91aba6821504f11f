#pragma once
// The two entries of a PacketKernel (packet_march.h), for the instruction set that the including .cpp chose (lanes.h).

#include "tests/bench/packet_march/beams.h"
#include "tests/bench/packet_march/packet_march.h"

namespace terray::TERRAY_LANES {

// A packet is 4 x 2 pixels, a square of 8 x 8 is one beam and eight packets, a tile is 4 x 2 squares.
inline constexpr int kSquareSide = 8;
inline constexpr int kPackets = kTileWidth * kTileHeight / kLanes;
inline constexpr Int kLaneX = {0, 1, 2, 3, 0, 1, 2, 3};  // of a packet's pixels, and of a tile's squares
inline constexpr Int kLaneY = {0, 0, 0, 0, 1, 1, 1, 1};
inline constexpr Int kPacketX = {0, 4, 0, 4, 0, 4, 0, 4};  // of a square's packets
inline constexpr Int kPacketY = {0, 0, 2, 2, 4, 4, 6, 6};

/// Upper left pixel of packet 0 .. kPackets - 1 in its tile; packets of a square follow each other.
struct Place {
    int x;
    int y;
};
inline Place packetPlace(int packet) {
    const int square = packet / kLanes;
    return {kLaneX[square] * kSquareSide + kPacketX[packet % kLanes],
            kLaneY[square] * kSquareSide + kPacketY[packet % kLanes]};
}

/// The rays through eight points of a picture, in pixels from the centre of the upper left one.
inline Rays raysThrough(const PictureRays& picture, Float x, Float y) {
    return {.eye = {all(picture.eye.x), all(picture.eye.y)},
            .eyeZ = all(picture.eye.z),
            .direction = {mulAdd(y, all(picture.down.x), mulAdd(x, all(picture.right.x), all(picture.first.x))),
                          mulAdd(y, all(picture.down.y), mulAdd(x, all(picture.right.y), all(picture.first.y)))},
            .rise = mulAdd(y, all(picture.down.z), mulAdd(x, all(picture.right.z), all(picture.first.z)))};
}

/// Packets of a tile by their next step. A packet may have lanes for both; those above level 0 go first.
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

/// Marches the packets of a tile to their ends. They take turns, so that while one waits for memory the steps of others
/// are under way, and so many of them that loops seldom end.
inline void marchTogether(const PyramidView& pyramid, RayPacket* packets, CastWork& work) {
    Queue above;   // with lanes above level 0
    Queue before;  // whose lanes are all before a patch
    for (int i = 0; i < kPackets; ++i) enqueue(packets[i], i, above, before);
    while (above.count + before.count > 0) {
        while (above.count > 0) {
            work.pyramidSteps += above.count;
            const Queue turn = above;
            above.count = 0;
            for (int i = 0; i < turn.count; ++i) {
                pyramidStep(pyramid, packets[turn.items[i]]);
                enqueue(packets[turn.items[i]], turn.items[i], above, before);
            }
        }
        work.patchSteps += before.count;
        const Queue turn = before;
        before.count = 0;
        for (int i = 0; i < turn.count; ++i) {
            patchStep(pyramid, packets[turn.items[i]]);
            enqueue(packets[turn.items[i]], turn.items[i], above, before);
        }
    }
}

/// The beams of a tile's squares.
inline Beams squareBeams(const PictureRays& picture, int left, int top) {
    const float middle = 0.5F * (kSquareSide - 1);
    const Float x = converted(kLaneX * kSquareSide + left) + middle;
    const Float y = converted(kLaneY * kSquareSide + top) + middle;
    // From the centre to the outermost rays, and a little more for rounding.
    const auto reach = [&](float right, float down) {
        return 1.01F * middle * (__builtin_fabsf(right) + __builtin_fabsf(down));
    };
    Beams beams = {.centres = raysThrough(picture, x, y), .spread = {}};
    beams.centres.rise -= reach(picture.right.z, picture.down.z);
    const float spreadX = reach(picture.right.x, picture.down.x);
    const float spreadY = reach(picture.right.y, picture.down.y);
    beams.spread = all(__builtin_fmaxf(__builtin_fmaxf(spreadX, spreadY), 1e-30F));
    return beams;
}

inline void castTile(const PyramidView& pyramid, const PictureRays& picture, int left, int top, bool beams,
                     float* depths, CastWork& work) {
    BeamStarts starts = {Float{}, all(pyramid.start)};
    if (beams) starts = marchBeams(pyramid, squareBeams(picture, left, top), work);

    RayPacket packets[kPackets];
    for (int i = 0; i < kPackets; ++i) {
        const Place place = packetPlace(i);
        const Float x = converted(kLaneX + (left + place.x));
        const Float y = converted(kLaneY + (top + place.y));
        const int square = i / kLanes;
        packets[i] = startPacket(pyramid, raysThrough(picture, x, y), all(starts.t[square]), all(starts.level[square]));
    }
    marchTogether(pyramid, packets, work);
    for (int i = 0; i < kPackets; ++i) {
        const Place place = packetPlace(i);
        for (int lane = 0; lane < kLanes; ++lane)
            depths[(place.y + kLaneY[lane]) * kTileWidth + place.x + kLaneX[lane]] = packets[i].hit[lane];
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
