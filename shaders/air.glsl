// air.glsl: aerial perspective: ground and sky seen through air that dims what is behind it and shines by scattered light.
// Off, colours come through as they are.
// Extinction at sea level is 3.912 / visual range for green (Koschmieder 1924: a black mountain at that range keeps 2 % of
// contrast against the sky) and more for blue, less for red; it is shared between molecules and aerosol, whose densities fall
// with height (math/atmosphere.glsl). Heights above the sea, metres; the path is straight over flat ground.
#ifndef TERRAY_AIR_MODULE
#define TERRAY_AIR_MODULE
#include "sky.glsl"

#if TERRAY_AIR
#include "math/air.glsl"
#include "math/atmosphere.glsl"
#include "nodes.glsl"

vec3 throughColumns(vec3 colour, vec3 light, float molecules, float aerosol) {
    vec3 depth = kMolecules * molecules + aerosolExtinction(frame.air.x) * aerosol;
    return mix(light, colour, exp(-depth));
}

// Ground at a distance. direction: unit, world. height: of the ground.
vec3 throughAir(vec3 colour, vec3 direction, float distance, float height) {
    float eye = frame.air.y;
    return throughColumns(colour, airlight(direction, frame.sun.xyz, distance),
                          airColumn(eye, height, distance, kMoleculeScale),
                          airColumn(eye, height, distance, kAerosolScale));
}
#else
vec3 throughAir(vec3 colour, vec3 direction, float distance, float height) { return colour; }
#endif

// The sky. The table of TERRAY_SKY has its air in it; the gradient's lower end fades into the same haze as far ground.
#if TERRAY_AIR && !TERRAY_SKY && !TERRAY_SIGNAL_SKY
vec3 skyThroughAir(vec3 colour, vec3 direction) {
    float eye = frame.air.y;
    return throughColumns(colour, airlight(direction, frame.sun.xyz, 0.0),
                          airColumnToSpace(eye, direction.z, kMoleculeScale),
                          airColumnToSpace(eye, direction.z, kAerosolScale));
}
#else
vec3 skyThroughAir(vec3 colour, vec3 direction) { return colour; }
#endif

#endif
