// overlay.vert: a corner of a triangle in the terrain's picture (OverlayVertex of common/overlay_mesh.h).
// Frame: world axes (metres east, north, up) from the eye.
#include "nodes.glsl"

layout(location = TERRAY_UNIFORM_ORIGIN) uniform vec4 origin;   // of the mesh, from the eye; w: exaggeration of heights
layout(location = TERRAY_UNIFORM_GROWTH) uniform float growth;  // of offsets for each metre of view depth; never below 1

layout(location = 0) in vec3 anchor;
layout(location = 1) in vec3 offset;
layout(location = 2) in vec3 normal;

out vec3 seen;  // as straight lines of sight see it
out float height;  // above the sea, metres
out vec3 worldNormal;

// Where straight lines of sight see a place: over a curved earth lower by the drop at its distance.
vec3 bentPosition(vec3 fromEye) {
#if TERRAY_CURVED
    fromEye.z -= earthDrop(frame.bend.xyz, fromEye.x, fromEye.y);
#endif
    return fromEye;
}

void main() {
    // Heights of places are exaggerated; the thing itself keeps its shape.
    vec3 place = origin.xyz + anchor * vec3(1.0, 1.0, origin.w);
    float depth = dot(bentPosition(place), frame.forward.xyz);
    vec3 corner = place + offset * max(1.0, growth * depth);
    seen = bentPosition(corner);
    height = frame.air.y + corner.z * frame.air.z;
    worldNormal = normal;
    gl_Position = clipPosition(seen);
}
