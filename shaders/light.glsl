// light.glsl: sun and sky on matt ground; linear.
#ifndef TERRAY_LIGHT
#define TERRAY_LIGHT

// Weights of sun and sky: flat ground under a sun at 53 degrees shows its own colour. Sky light falls off to half on a
// vertical wall, which sees half of the sky.
const vec3 kSunLight = vec3(0.86, 0.83, 0.78);
const vec3 kSkyLight = vec3(0.30, 0.33, 0.38);

vec3 lit(vec3 colour, vec3 normal, vec3 sun) {
    return colour * (kSunLight * max(dot(normal, sun), 0.0) + kSkyLight * (0.5 + 0.5 * normal.z));
}

#endif
