// sky.glsl: what a ray that meets no ground sees. A gradient by elevation, hazy below the horizon, with a bright sun; linear.
// With TERRAY_SIGNAL_SKY a colour that no ground has, so that tests can count pixels without ground.
#ifndef TERRAY_SKY
#define TERRAY_SKY

#if TERRAY_SIGNAL_SKY
vec3 skyColour(vec3 direction, vec3 sun) { return vec3(1.0, 0.0, 1.0); }
#else
// direction, sun: unit, world.
vec3 skyColour(vec3 direction, vec3 sun) {
    const vec3 kHorizon = vec3(0.62, 0.73, 0.85);
    const vec3 kZenith = vec3(0.13, 0.29, 0.60);
    const vec3 kBelow = vec3(0.49, 0.56, 0.64);
    float elevation = direction.z;
    vec3 above = mix(kHorizon, kZenith, pow(clamp(elevation, 0.0, 1.0), 0.55));
    vec3 sky = mix(above, kBelow, smoothstep(0.0, -0.12, elevation));
    float towardsSun = max(dot(direction, sun), 0.0);
    return sky + vec3(1.0, 0.9, 0.7) * (0.18 * pow(towardsSun, 32.0) + 2.0 * smoothstep(0.99996, 0.99999, towardsSun));
}
#endif

#endif
