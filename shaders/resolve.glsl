// resolve.glsl: from a pixel's hit to its colour: slope, photo or shading mode, light, air, sky. The same for the raster and the compute launch.
#ifndef TERRAY_RESOLVE
#define TERRAY_RESOLVE
#include "air.glsl"
#include "light.glsl"
#include "nodes.glsl"
#include "sky.glsl"
#include "srgb.glsl"
#include "sun_light.glsl"
#include "surface.glsl"
#if TERRAY_SHADING
#include "shading.glsl"
#else
#include "photo.glsl"

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    return photoColour(node, hit, slope, position);
}
#endif

layout(binding = TERRAY_UNIT_HIT) uniform sampler2D hits;
layout(binding = TERRAY_UNIT_NODE) uniform usampler2D hitNodes;

struct Resolved {
    vec3 colour;  // as it is stored: sRGB or linear
    vec3 normal;  // world; 0 for the sky
};

Resolved resolvePixel(ivec2 pixel) {
    vec2 position = picturePosition(vec2(pixel) + 0.5);
    uint found = texelFetch(hitNodes, pixel, 0).r;
    Resolved resolved = Resolved(vec3(0.0), vec3(0.0));
    vec3 ray = frame.forward.xyz + position.x * frame.right.xyz + position.y * frame.up.xyz;
    vec3 direction = normalize(ray);
    if (found == 0u) {
        resolved.colour = skyThroughAir(skyColour(direction, frame.sun.xyz), direction);
    } else {
        NodeParameters node = nodes[found - 1u];
        vec4 hit = texelFetch(hits, pixel, 0);
        vec2 slope = smoothGradient(hit.xy, node.source.x, hit.z);
        vec2 rise = slope * (node.right.w / node.eye.w);  // metres per metre to the east and to the south
        resolved.normal = normalize(vec3(-rise.x, rise.y, 1.0));
        vec3 ground = groundColour(node, hit, slope, position);
        float height = heightOfCode(node, hit.z);
        vec3 shaded = lit(ground, resolved.normal, frame.sun.xyz, lightAt(height), sunLightAt(pixel));
        resolved.colour = throughAir(shaded, direction, hit.w * length(ray), height);
    }
#if TERRAY_SHADE_STEPS || TERRAY_SHADE_SHADOW_STEPS
    resolved.colour = stepColour(pixel);
#endif
    resolved.colour = storedColour(resolved.colour, picturePixel(pixel));
    return resolved;
}

#endif
