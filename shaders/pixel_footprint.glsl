// pixel_footprint.glsl: the ground that one pixel sees, in the tile frame of the node that it hit.
#ifndef TERRAY_PIXEL_FOOTPRINT
#define TERRAY_PIXEL_FOOTPRINT
#include "math/footprint.glsl"
#include "nodes.glsl"

// hit: tile frame, and view depth in metres. slope: gradient of the surface, codes per texel. position: on the picture, -1 .. 1.
// longest: limit of either side, texels.
Footprint footprintAt(NodeParameters node, vec4 hit, vec2 slope, vec2 position, float longest) {
    // The texel vectors (1, 0) and (0, 1), lifted onto the tangent plane, in metres and then in camera axes.
    vec2 seen = seenSlope(node, hit.xy, slope);
    vec3 east = vec3(node.eye.w, 0.0, seen.x * node.right.w);
    vec3 south = vec3(0.0, -node.eye.w, seen.y * node.right.w);
    vec2 halfPicture = vec2(length(frame.right.xyz), length(frame.up.xyz));
    vec3 right = frame.right.xyz / halfPicture.x;
    vec3 up = frame.up.xyz / halfPicture.y;
    vec3 eastView = vec3(dot(east, right), dot(east, up), dot(east, frame.forward.xyz));
    vec3 southView = vec3(dot(south, right), dot(south, up), dot(south, frame.forward.xyz));
    float focal = 0.5 * frame.up.w / halfPicture.y;
    vec2 raySlope = position * halfPicture;
    return pixelFootprint(projected(eastView, raySlope, hit.w, focal), projected(southView, raySlope, hit.w, focal),
                          longest);
}

#endif
