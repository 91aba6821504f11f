// methods/ground.glsl: for methods that sample the ground along a ray: its height at a place, and the part of the ray worth
// sampling. Frame: tile; heights in codes. The surface is the node's own: columns, or with TERRAY_BILINEAR_BIT patches.
#ifndef TERRAY_METHOD_GROUND
#define TERRAY_METHOD_GROUND
#include "heights.glsl"
#include "nodes.glsl"
#include "ray.glsl"

layout(std140, binding = TERRAY_BUFFER_METHOD) uniform MethodBuffer { MethodParameters method; };

// Below every ray: where there is no surface.
const float kNoGround = -1e30;

#if TERRAY_BILINEAR
// As patches.glsl has it: a sample without surface opens its quarter of the patch, the others go on at the patch's mean.
float patchCode(uint slot, vec2 texel) {
    vec2 fromCentre = texel - 0.5;
    ivec2 corner = ivec2(floor(fromCentre));
    vec2 f = fromCentre - vec2(corner);
    vec4 codes;  // h00, h10, h01, h11
    for (int i = 0; i < 4; ++i)
        codes[i] = float(texelFetch(heightCodes, ivec3(corner + ivec2(i & 1, i >> 1) + kApron, slot), 0).r);
    if (any(equal(codes, vec4(0.0)))) {
        ivec2 quarter = ivec2(greaterThanEqual(f, vec2(0.5)));
        if (codes[quarter.x + 2 * quarter.y] == 0.0) return kNoGround;
        vec4 solid = vec4(greaterThan(codes, vec4(0.0)));
        codes = mix(vec4(dot(codes, vec4(1.0)) / dot(solid, vec4(1.0))), codes, solid);
    }
    return mix(mix(codes.x, codes.y, f.x), mix(codes.z, codes.w, f.x), f.y);
}
#endif

// Height of the node's surface, or kNoGround. texel: of the tile; beyond the node's cell that of its edge.
float groundCode(NodeParameters node, vec2 texel) {
    vec2 inside = clamp(texel, node.boxMin.xy, node.boxMax.xy);
#if TERRAY_BILINEAR
    if ((node.source.w & TERRAY_BILINEAR_BIT) != 0u) return patchCode(node.source.x, inside);
#endif
    ivec2 cell = min(ivec2(floor(inside)), ivec2(ceil(node.boxMax.xy)) - 1);
    uint code = blockMaximum(cell, node.source.x, 0);
    return code == 0u ? kNoGround : float(code);
}

// Height of a ray above the node's surface; a ray that is not above it has met it.
float clearanceOf(NodeParameters node, vec3 direction, float t) {
    vec3 point = rayPoint(node, direction, t);
    return point.z - groundCode(node, point.xy);
}

// The part of a ray within the node's box; none when exit < enter.
Interval partInBox(NodeParameters node, vec3 direction) {
    Ray ray = mirroredRay(node, direction);
    vec2 side = vec2(float(kCore));
    vec3 boxMin = vec3(mix(node.boxMin.xy, side - node.boxMax.xy, ray.mirrored), node.boxMin.z);
    vec3 boxMax = vec3(mix(node.boxMax.xy, side - node.boxMin.xy, ray.mirrored), node.boxMax.z);
    Interval part = clippedRay(ray, boxMin, boxMax);
#if TERRAY_CURVED
    // A bent ray is not cut at the top by clippedRay.
    if (part.exit < part.enter) return part;
    float below = blockContact(ray, boxMax.z, part.enter, part.exit);
    if (below == kNoContact) return Interval(0.0, -1.0);
    part.enter = below;
    float depth = bentHeight(ray.eye.z, ray.direction.z, ray.bend, below) - boxMax.z;
    if (bentHeight(ray.eye.z, ray.direction.z, ray.bend, part.exit) > boxMax.z)
        part.exit = min(part.exit, below + riseTime(Clearance(ray.bend, bentSlope(ray.direction.z, ray.bend, below),
                                                              min(depth, 0.0))));
#endif
    return part;
}

// A direction's sine of elevation, metric.
float riseOf(NodeParameters node, vec3 direction) {
    vec3 metric = direction * vec3(node.eye.w, node.eye.w, node.right.w);
    return metric.z / length(metric);
}

// Halves the way between a time above the surface and a later one that is not; the latter's end is kept.
float halved(NodeParameters node, vec3 direction, float above, float below, int times, inout int steps) {
    for (int i = 0; i < times; ++i, ++steps) {
        float middle = 0.5 * (above + below);
        if (clearanceOf(node, direction, middle) > 0.0) {
            above = middle;
        } else {
            below = middle;
        }
    }
    return below;
}

#endif
