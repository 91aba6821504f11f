// daylight.glsl: light on the ground under a sun at 40 degrees, from where all other light is counted; linear.
#ifndef TERRAY_DAYLIGHT
#define TERRAY_DAYLIGHT

// Weights of sun and sky: flat ground under a sun at 40 degrees shows its own colour.
const vec3 kSunLight = vec3(1.22, 1.16, 1.08);  // on ground that faces the sun
const vec3 kSkyLight = vec3(0.22, 0.25, 0.30);  // on level ground

#endif
