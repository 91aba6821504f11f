// light.glsl: sun and sky on matt ground; linear.
#ifndef TERRAY_LIGHT
#define TERRAY_LIGHT

// Weights of sun and sky: flat ground under a sun at 40 degrees shows its own colour. Sky light falls off to half on a
// vertical wall, which sees half of the sky.
const vec3 kSunLight = vec3(1.22, 1.16, 1.08);
const vec3 kSkyLight = vec3(0.22, 0.25, 0.30);

vec3 lit(vec3 colour, vec3 normal, vec3 sun) {
    return colour * (kSunLight * max(dot(normal, sun), 0.0) + kSkyLight * (0.5 + 0.5 * normal.z));
}

#endif
