// shading/sobel.glsl: the photo in the light of paper 003 (Kentie, "On-GPU ray traced terrain", section 3.8 and appendix A):
// normals by a Sobel filter over the filtered height map, and the photo times an ambient light, plus diffuse, plus specular light.
// The paper keeps its intensities to itself; these are ours. Its listing takes the specular term from light and halfway vector,
// which leaves the ground out; here it is from normal and halfway vector. Its light is a point, ours the sun.
#ifndef TERRAY_SHADING_SOBEL
#define TERRAY_SHADING_SOBEL
#include "photo.glsl"
#include "surface.glsl"

const float kAmbient = 0.5;
const float kDiffuse = 0.35;
const float kSpecular = 0.1;
const float kSpecularExponent = 20.0;

// The height map, filtered bilinearly. fromCentre: texels from the centre of the tile's first one.
float filteredCode(vec2 fromCentre, uint slot, float other) {
    ivec2 c = ivec2(floor(fromCentre));
    vec2 f = fromCentre - vec2(c);
    return mix(mix(codeOr(c, slot, other), codeOr(c + ivec2(1, 0), slot, other), f.x),
               mix(codeOr(c + ivec2(0, 1), slot, other), codeOr(c + ivec2(1, 1), slot, other), f.x), f.y);
}

// Codes per texel.
vec2 sobelGradient(vec2 position, uint slot, float heightHere) {
    vec2 fromCentre = clamp(position, vec2(0.0), vec2(float(kCore))) - 0.5;
    vec2 gradient = vec2(0.0);
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            vec2 weight = vec2(float(x * (2 - y * y)), float(y * (2 - x * x)));
            gradient += weight * filteredCode(fromCentre + vec2(float(x), float(y)), slot, heightHere);
        }
    return gradient / 8.0;
}

vec3 groundColour(NodeParameters node, vec4 hit, vec2 slope, vec2 position) {
    vec2 rise = sobelGradient(hit.xy, node.source.x, hit.z) * (node.right.w / node.eye.w);
    vec3 normal = normalize(vec3(-rise.x, rise.y, 1.0));
    vec3 ray = normalize(frame.forward.xyz + position.x * frame.right.xyz + position.y * frame.up.xyz);
    vec3 halfway = normalize(frame.sun.xyz - ray);
    return kAmbient * photoColour(node, hit, slope, position) + kDiffuse * max(dot(frame.sun.xyz, normal), 0.0) +
           kSpecular * pow(max(dot(normal, halfway), 0.0), kSpecularExponent);
}

#endif
