// patches.glsl: a ray against the bilinear surface over a block of 2 x 2 cells, patch by patch.
// Frame: tile, mirrored with the ray. Patch p lies between the centres of the samples p and p + 1, from p + 0.5 to p + 1.5;
// the block whose far corner is `edge` touches the patches edge - 3 .. edge - 1.
// A sample without surface: its quarter of the patch is open; the others continue at the mean of the patch's samples.
#ifndef TERRAY_PATCHES
#define TERRAY_PATCHES
#include "heights.glsl"
#include "math/patch.glsl"
#include "ray.glsl"

// A straight line crosses at most 5 of 3 x 3 patches.
const int kPatchesOfBlock = 5;

float sampleCode(Ray ray, uint slot, ivec2 cell) {
    ivec2 stored = mix(cell, kCore - 1 - cell, ray.mirrored);
    return float(texelFetch(heightCodes, ivec3(stored + kApron, slot), 0).r);
}

// First contact within a patch of which at least one quarter has no surface: quarter by quarter.
// clearance: of the whole patch. at, direction: as in patchClearance. codes: h00, h10, h01, h11; 0 where there is none.
float quarterContact(Clearance clearance, vec4 codes, vec2 at, vec2 direction, float span) {
    ivec2 quarter = ivec2(greaterThanEqual(at, vec2(0.5)));
    float s = 0.0;
    for (int i = 0; i < 3; ++i) {
        vec2 crossing = (0.5 - at) / max(direction, vec2(1e-30));
        vec2 ends = mix(crossing, vec2(span), equal(quarter, ivec2(1)));
        float end = clamp(min(ends.x, ends.y), s, span);
        if (codes[quarter.x + 2 * quarter.y] > 0.0) {
            Clearance rest;
            rest.bend = clearance.bend;
            rest.slope = clearance.slope + 2.0 * clearance.bend * s;
            rest.start = clearanceAt(clearance, s);
            float contact = firstContact(rest, end - s);
            if (contact >= 0.0) return s + contact;
        }
        if (end >= span) break;
        if (ends.x <= ends.y) {
            quarter.x = 1;
        } else {
            quarter.y = 1;
        }
        s = end;
    }
    return kNoContact;
}

// t of the first contact within [enter, leave], the ray's part over the block, or kNoContact. steps: raised by the number of
// patches tried.
float patchContact(Ray ray, uint slot, ivec2 edge, float enter, float leave, inout int steps) {
    vec2 at = ray.eye.xy + enter * ray.direction.xy - 0.5;
    ivec2 corner = clamp(ivec2(floor(at)), edge - 3, edge - 1);
    for (int i = 0; i < kPatchesOfBlock; ++i, ++steps) {
        vec2 times = (vec2(corner) + 1.5 - ray.eye.xy) * ray.inverse.xy;
        float exit = clamp(min(times.x, times.y), enter, leave);
        vec4 codes = vec4(sampleCode(ray, slot, corner), sampleCode(ray, slot, corner + ivec2(1, 0)),
                          sampleCode(ray, slot, corner + ivec2(0, 1)), sampleCode(ray, slot, corner + ivec2(1, 1)));
        vec4 solid = vec4(greaterThan(codes, vec4(0.0)));
        float count = dot(solid, vec4(1.0));
        if (count > 0.0) {
            vec4 heights = mix(vec4(dot(codes, vec4(1.0)) / count), codes, solid);
            vec3 local = ray.eye + enter * ray.direction;
            local.xy = clamp(local.xy - vec2(corner) - 0.5, vec2(0.0), vec2(1.0));
            float bend = 0.0;
            vec3 direction = ray.direction;
#if TERRAY_CURVED
            bend = ray.bend;
            local.z = bentHeight(ray.eye.z, ray.direction.z, bend, enter);
            direction.z = bentSlope(ray.direction.z, bend, enter);
#endif
            Clearance clearance =
                patchClearance(Corners(heights.x, heights.y, heights.z, heights.w), local, direction, bend);
            float contact = count == 4.0 ? firstContact(clearance, exit - enter)
                                         : quarterContact(clearance, codes, local.xy, direction.xy, exit - enter);
            if (contact >= 0.0) return min(enter + contact, exit);
        }
        if (exit >= leave) break;
        if (times.x <= times.y) {
            ++corner.x;
        } else {
            ++corner.y;
        }
        enter = exit;
    }
    return kNoContact;
}

#endif
