// methods/cones.glsl: relaxed cone stepping, then halving (Policarpo and Oliveira 2007, GPU Gems 3, chapter 18; ConeTiles). A ray
// above its block's highest sample goes on to where it leaves that block's cone; below it, sample by sample.
// Fails by design: a ray that has not met the ground after so many steps finds nothing; a cone lets a ray through ground that is
// entered and left within it, as the widest cones of a block do for the samples beside the highest.
#ifndef TERRAY_METHOD_CONES_MODULE
#define TERRAY_METHOD_CONES_MODULE
#include "march_result.glsl"
#include "methods/ground.glsl"

layout(binding = TERRAY_UNIT_METHOD) uniform sampler2DArray cones;

March marchNode(NodeParameters node, vec3 direction) {
    March march = March(false, false, 0, 0.0);
    Interval part = partInBox(node, direction);
    if (!(part.enter <= part.exit)) return march;
    int side = textureSize(cones, 0).x;
    int level = findMSB(kCore / side);
    float along = length(direction.xy);  // texels
    float rise = direction.z;            // codes
#if TERRAY_CURVED
    float bend = rayBend(node, direction);
#endif
    // A sample's length, and as far as cones know of the ground.
    float sampleTime = node.eye.w / length(direction * vec3(node.eye.w, node.eye.w, node.right.w));
    float mostTime = method.cones.y * float(kCore / side) / max(along, 1e-30);

    float before = part.enter;
    float t = part.enter;
    for (; march.steps < int(method.cones.x); ++march.steps) {
        vec3 point = rayPoint(node, direction, t);
        vec2 inside = clamp(point.xy, node.boxMin.xy, node.boxMax.xy);
        ivec2 block = min(ivec2(inside), ivec2(kCore - 1)) >> level;
        float above = point.z - float(blockMaximum(block, node.source.x, level));
        if (above <= 0.0 && point.z <= groundCode(node, inside)) {
            march.hit = true;
            march.t = t > part.enter ? halved(node, direction, before, t, int(method.cones.z), march.steps) : t;
            return march;
        }
        if (t >= part.exit) return march;
        float stride = sampleTime;
        if (above > 0.0) {
            float width = texelFetch(cones, ivec3(block, node.source.x), 0).r;
#if TERRAY_CURVED
            rise = bentSlope(direction.z, bend, t);
#endif
            float opening = along - width * rise;  // of ray and cone's side, per metre
            float leaves = opening > 0.0 ? width * above / opening : mostTime;
            stride = max(min(leaves, mostTime), sampleTime);
        }
        before = t;
        t = min(t + stride, part.exit);
    }
    return march;
}

#endif
