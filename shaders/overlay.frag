// overlay.frag: a fragment of an overlay's triangle, where no terrain is nearer. Drawn after the resolve pass, with depth
// of its own: the terrain's comes from the hits, so that it does not matter which launch made them.
#include "air.glsl"
#include "light.glsl"
#include "nodes.glsl"
#include "srgb.glsl"

layout(binding = TERRAY_UNIT_HIT) uniform sampler2D hits;
layout(binding = TERRAY_UNIT_NODE) uniform usampler2D hitNodes;
layout(location = TERRAY_UNIFORM_COLOUR) uniform vec3 colour;  // linear

in vec3 seen;
in float height;
in vec3 worldNormal;
layout(location = 0) out vec4 outColour;

// Part of the light on level ground that the ground throws back, on faces that look down on it.
const float kGroundLight = 0.25;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = 1.0 / gl_FragCoord.w;  // metres
    bool ground = texelFetch(hitNodes, pixel, 0).r != 0u;
    if (ground && texelFetch(hits, pixel, 0).w <= depth) discard;

    vec3 normal = normalize(worldNormal);
    Light light = lightAt(height);
    vec3 shaded = lit(colour, normal, frame.sun.xyz, light, 1.0) +
                  lit(colour, vec3(0.0, 0.0, 1.0), frame.sun.xyz, light, 1.0) * kGroundLight * (0.5 - 0.5 * normal.z);
    outColour = vec4(storedColour(throughAir(shaded, normalize(seen), length(seen), height), picturePixel(pixel)), 1.0);
}
