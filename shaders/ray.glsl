// ray.glsl: a ray through a tile, mirrored so that it never runs towards smaller x or y (paper 001, section 3.1), straight or,
// with TERRAY_CURVED, bent. Frame: tile. t: view depth in metres; P(t) = eye + t * direction, and bend * t * t higher.
#ifndef TERRAY_RAY
#define TERRAY_RAY
#include "heights.glsl"
#include "math/box.glsl"
#include "nodes.glsl"
#if TERRAY_CURVED
#include "math/bend.glsl"
#include "math/contact.glsl"
#else
#include "math/column.glsl"
#endif

// What blockContact and the like answer where the ray stays above.
const float kNoContact = -1.0;

struct Ray {
    vec3 eye;
    vec3 direction;
    vec3 inverse;
    bvec2 mirrored;
#if TERRAY_CURVED
    float bend;
    float lowest;  // t of the ray's lowest point
#endif
};

Ray mirroredRay(NodeParameters node, vec3 direction) {
    Ray ray;
    ray.mirrored = lessThan(direction.xy, vec2(0.0));
    ray.direction = vec3(abs(direction.xy), direction.z);
    ray.eye = vec3(mix(node.eye.xy, vec2(float(kCore)) - node.eye.xy, ray.mirrored), node.eye.z);
    ray.inverse = vec3(safeInverse(ray.direction.x), safeInverse(ray.direction.y), safeInverse(ray.direction.z));
#if TERRAY_CURVED
    ray.bend = rayBend(node, direction);
    ray.lowest = lowestTime(ray.direction.z, ray.bend);
#endif
    return ray;
}

#if TERRAY_CURVED

// t at which the ray is first at or below `top` within [enter, leave], or kNoContact.
float blockContact(Ray ray, float top, float enter, float leave) {
    if (!bentMeetsColumn(top, ray.eye.z, ray.direction.z, ray.bend, ray.lowest, enter, leave)) return kNoContact;
    return bentColumnTime(top, ray.eye.z, ray.direction.z, ray.bend, enter, leave);
}

// The part of a ray over a box and not below it. A ray that sinks through the bottom and rises again within the box keeps
// only the part before: it passed the ground, or a hole in it. It is not cut at the top: the pyramid takes care of that.
Interval clippedRay(Ray ray, vec3 boxMin, vec3 boxMax) {
    float everywhere = 1e30;
    Interval span = boxInterval(vec3(ray.eye.xy, 0.0), vec3(ray.inverse.xy, 1.0), vec3(boxMin.xy, -everywhere),
                                vec3(boxMax.xy, everywhere));
    float above = bentHeight(ray.eye.z, ray.direction.z, ray.bend, span.enter) - boxMin.z;
    if (above < 0.0) {
        span.enter += riseTime(Clearance(ray.bend, bentSlope(ray.direction.z, ray.bend, span.enter), above));
    } else {
        float sinks = blockContact(ray, boxMin.z, span.enter, span.exit);
        if (sinks != kNoContact) span.exit = sinks;
    }
    return span;
}

#else

Interval clippedRay(Ray ray, vec3 boxMin, vec3 boxMax) { return boxInterval(ray.eye, ray.inverse, boxMin, boxMax); }

float blockContact(Ray ray, float top, float enter, float leave) {
    if (!meetsColumn(top, ray.eye.z, ray.direction.z, enter, leave)) return kNoContact;
    return columnTime(top, ray.eye.z, ray.direction.z, ray.inverse.z, enter, leave);
}

#endif

#endif
