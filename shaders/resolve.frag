// resolve.frag: from hits to colours, once per pixel: slope, photo, light, sky.
#include "light.glsl"
#include "nodes.glsl"
#include "photo.glsl"
#include "sky.glsl"
#include "surface.glsl"

layout(binding = TERRAY_UNIT_HIT) uniform sampler2D hits;
layout(binding = TERRAY_UNIT_NODE) uniform usampler2D hitNodes;

layout(location = 0) out vec4 outColour;
#if TERRAY_NORMALS
layout(location = 1) out vec4 outNormal;
#endif

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec2 position = picturePosition(gl_FragCoord.xy);
    uint found = texelFetch(hitNodes, pixel, 0).r;
    vec3 colour;
    vec3 normal = vec3(0.0);
    if (found == 0u) {
        vec3 direction = frame.forward.xyz + position.x * frame.right.xyz + position.y * frame.up.xyz;
        colour = skyColour(normalize(direction), frame.sun.xyz);
    } else {
        NodeParameters node = nodes[found - 1u];
        vec4 hit = texelFetch(hits, pixel, 0);
        vec2 slope = smoothGradient(hit.xy, node.source.x, hit.z);
        vec2 rise = slope * (node.right.w / node.eye.w);  // metres per metre to the east and to the south
        normal = normalize(vec3(-rise.x, rise.y, 1.0));
        colour = lit(groundColour(node, hit.xy, slope, hit.w, position), normal, frame.sun.xyz);
    }
    outColour = vec4(colour, 1.0);
#if TERRAY_NORMALS
    outNormal = vec4(normal, 0.0);
#endif
}
