// shadow.glsl: how much of the sun a hit sees: rays to the sun through every tile of the scene, not through the hit's alone.
//
// Scene frame: x east, y south, in sides of the finest cell, from the corner of the cell that the eye is in; whole cells
// (ivec2) count from the root's corner. A ray walks the tree of cells as it walks a maximum mipmap, mirrored so that it never
// runs towards smaller x or y: a cell whose ground it clears is left as a whole, whatever its size.
// The surface is bilinear everywhere: on columns below a pixel a shadow ray would see stairs.
//
// Nothing is offset by a constant. A ray starts at the height of the surface itself where it was hit, raised by the rounding
// error of that height. Where it enters the next node below its surface by no more than the two nodes' geometric errors add
// up to, that is no ground in the way but two levels of detail that disagree, and the ray is raised to the surface.
#ifndef TERRAY_SHADOW
#define TERRAY_SHADOW
#include "march.glsl"
#include "nodes.glsl"
#include "surface.glsl"

layout(std430, binding = TERRAY_BUFFER_SHADOW_CELLS) readonly buffer ShadowCellBuffer { ShadowCell shadowCells[]; };
layout(std140, binding = TERRAY_BUFFER_SHADOW) uniform ShadowBuffer { ShadowParameters shadow; };

// A ray enters at most as many cells as lie along two sides of the tree's finest grid; more are reported as a defect.
const int kMaxShadowCells = 4096;

struct ShadowRay {
    vec3 from;       // metres east, north, up from the eye
    vec3 direction;  // unit, world
    float bend;      // metres that it gains per squared metre
};

struct SunLight {
    float part;  // of the sun that is seen: 0 .. 1
    uint steps;
};

// Height in codes of the bilinear surface as patches.glsl has it, or -1 where the patch has no sample.
float patchSurface(uint slot, vec2 position) {
    vec2 at = clamp(position, vec2(0.0), vec2(float(kCore))) - 0.5;
    ivec2 corner = ivec2(floor(at));
    vec4 codes = vec4(texelFetch(heightCodes, ivec3(corner + kApron, slot), 0).r,
                      texelFetch(heightCodes, ivec3(corner + kApron + ivec2(1, 0), slot), 0).r,
                      texelFetch(heightCodes, ivec3(corner + kApron + ivec2(0, 1), slot), 0).r,
                      texelFetch(heightCodes, ivec3(corner + kApron + ivec2(1, 1), slot), 0).r);
    vec4 solid = vec4(greaterThan(codes, vec4(0.0)));
    float count = dot(solid, vec4(1.0));
    if (count == 0.0) return -1.0;
    codes = mix(vec4(dot(codes, vec4(1.0)) / count), codes, solid);
    return patchHeight(Corners(codes.x, codes.y, codes.z, codes.w), at.x - float(corner.x), at.y - float(corner.y));
}

// What rounding may take from the height of a ray that starts on the surface: a few last places of the height, and of the
// place (2^-15 texels at 512) times the slope.
float startError(float code, vec2 slope) { return abs(code) * exp2(-20.0) + (abs(slope.x) + abs(slope.y)) * exp2(-13.0); }

// The scene's tree below the cell that holds a place: the largest part of it that the ray clears, or a leaf.
struct Descent {
    int level;  // of the cell reached, counted up from the finest
    uint node;  // draw node of a leaf, TERRAY_NO_NODE where the ray clears the cell or nothing is there
};

// lowest: metres above the eye, of the ray within the cell; the sun is above the horizon, so it is where the ray enters.
Descent descend(ivec2 cell, float lowest) {
    int level = int(shadow.grid.z);
    uint index = 0u;
    for (;;) {
        ShadowCell at = shadowCells[index];
        if (lowest > at.bounds.x) return Descent(level, TERRAY_NO_NODE);
        if (at.source.x != TERRAY_NO_NODE) return Descent(level, at.source.x);
        --level;
        uint quadrant = uint((cell.x >> level) & 1) | uint((cell.y >> level) & 1) << 1;
        index = at.children[quadrant];
        if (index == 0u) return Descent(level, TERRAY_NO_NODE);
    }
}

// From the eye to the tile frame of a node.
vec3 tilePlace(NodeParameters node, vec3 fromEye) {
    return node.eye.xyz + vec3(fromEye.x, -fromEye.y, 0.0) / node.eye.w + vec3(0.0, 0.0, fromEye.z / node.right.w);
}
vec3 tileDirection(NodeParameters node, vec3 world) {
    return vec3(world.x / node.eye.w, -world.y / node.eye.w, world.z / node.right.w);
}

// Whether a ray reaches the sun. first: the node that it starts on, at `start` of its tile frame.
bool reachesSun(ShadowRay ray, uint first, vec3 start, inout uint steps) {
    bvec2 mirrored = bvec2(ray.direction.x < 0.0, ray.direction.y > 0.0);
    int across = 1 << int(shadow.grid.z);
    ivec2 eyeCell = ivec2(shadow.grid.xy);
    vec2 place = shadow.place.xy + vec2(ray.from.x, -ray.from.y) / shadow.place.z;
    vec2 origin = mix(place, 1.0 - place, mirrored);
    ivec2 offset = mix(eyeCell, across - 1 - eyeCell, mirrored);
    vec2 direction = abs(ray.direction.xy) / shadow.place.z;
    vec2 inverse = vec2(safeInverse(direction.x), safeInverse(direction.y));

    ivec2 cell = clamp(ivec2(floor(origin)) + offset, ivec2(0), ivec2(across - 1));
    float s = 0.0;                        // metres along the ray
    float raised = 0.0;                   // metres
    float error = nodes[first].forward.w;  // metres, of the node that the ray comes from
    for (int n = 0; n < kMaxShadowCells; ++n) {
        // On to the next leaf whose ground the ray does not clear.
        Descent found = Descent(0, TERRAY_NO_NODE);
        float leave = s;
        ivec2 edge = cell;
        vec2 times = vec2(0.0);
        for (; n < kMaxShadowCells; ++n) {
            float height = ray.from.z + raised + s * (ray.direction.z + s * ray.bend);
            if (height > shadow.place.w) return true;
            found = descend(mix(cell, across - 1 - cell, mirrored), height);
            ++steps;
            edge = blockEdge(cell, found.level) - offset;
            times = edgeTimes(edge, origin, inverse);
            leave = max(s, min(times.x, times.y));
            if (found.node != TERRAY_NO_NODE) break;
            cell = cellAfter(cell - offset, edge, times, origin, direction) + offset;
            if (any(greaterThanEqual(cell, ivec2(across)))) return true;
            s = leave;
        }
        if (found.node == TERRAY_NO_NODE) break;

        NodeParameters node = nodes[found.node];
        vec3 along = tileDirection(node, ray.direction);
        vec3 from = start;
        if (found.node != first) {
            from = tilePlace(node, ray.from + vec3(0.0, 0.0, raised));
            vec3 entry = from + s * along;
            entry.z += s * s * ray.bend / node.right.w;
            float ground = patchSurface(node.source.x, entry.xy);
            float below = ground + abs(ground) * exp2(-20.0) - entry.z;
            if (ground >= 0.0 && below > 0.0 && below * node.right.w <= error + node.forward.w) {
                from.z += below;
                raised += below * node.right.w;
            }
        }
        node.eye.xyz = from;
        node.source.w = max(node.source.w & TERRAY_START_LEVEL_MASK, 1u) | TERRAY_BILINEAR_BIT;
        March march = marchNode(node, along);
        steps += uint(march.steps);
        if (march.hit) return false;
        cell = cellAfter(cell - offset, edge, times, origin, direction) + offset;
        if (any(greaterThanEqual(cell, ivec2(across)))) return true;
        s = leave;
        error = node.forward.w;
    }
    return true;
}

// A direction within the sun's disc; the rays of a pixel lie on a spiral (Vogel 1979, "A better way to construct the
// sunflower head") that turns from pixel to pixel (Jimenez 2014, "Next Generation Post Processing in Call of Duty:
// Advanced Warfare": interleaved gradient noise).
vec3 sunDirection(vec3 sun, int ray, int rays, ivec2 pixel) {
#if TERRAY_SOFT_SUN
    float turn = fract(52.9829189 * fract(dot(vec2(pixel), vec2(0.06711056, 0.00583715))));
    float angle = 6.2831853 * (turn + float(ray) * 0.61803399);
    float radius = shadow.sun.x * sqrt((float(ray) + 0.5) / float(rays));
    vec3 side = normalize(cross(sun, abs(sun.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0)));
    return normalize(sun + radius * (cos(angle) * side + sin(angle) * cross(sun, side)));
#else
    return sun;
#endif
}

// hit: tile frame of nodes[index].
SunLight sunLight(uint index, vec3 hit, ivec2 pixel) {
    SunLight light = SunLight(0.0, 0u);
    NodeParameters node = nodes[index];
    vec3 fromEye = (hit - node.eye.xyz) * vec3(node.eye.w, -node.eye.w, node.right.w);

    // Onto the bilinear surface: a hit on a column's top or side is not on it.
    vec2 slope = smoothGradient(hit.xy, node.source.x, hit.z);
    float ground = patchSurface(node.source.x, hit.xy);
    float code = ground >= 0.0 ? ground : hit.z;
    code += startError(code, slope);
    fromEye.z += (code - hit.z) * node.right.w;

    vec3 sun = frame.sun.xyz;
#if TERRAY_CURVED
    // Over there the ground is tilted against the eye's; heights are over the flat map, as hits are.
    vec2 fall = earthFall(frame.bend.xyz, fromEye.x, fromEye.y);
    sun = normalize(vec3(sun.xy, sun.z + dot(fall, sun.xy)));
#endif
    int rays = int(shadow.sun.y);
    int reached = 0;
    for (int i = 0; i < rays; ++i) {
        ShadowRay ray = ShadowRay(fromEye, sunDirection(sun, i, rays, pixel), 0.0);
        if (ray.direction.z <= 0.0) continue;
#if TERRAY_CURVED
        ray.bend = earthDrop(frame.bend.xyz, ray.direction.x, ray.direction.y);
#endif
        if (reachesSun(ray, index, vec3(hit.xy, code), light.steps)) ++reached;
    }
    light.part = float(reached) / float(rays);
    return light;
}

#endif
