// srgb.glsl: linear colour as it is stored: with TERRAY_SRGB_COLOUR encoded for 8 bits, else as it is.
// Encoded here and not by the output unit, since images that compute shaders write know no sRGB: both launches store the
// same bytes. Source: IEC 61966-2-1:1999.
#ifndef TERRAY_SRGB
#define TERRAY_SRGB

#if TERRAY_SRGB_COLOUR
vec3 storedColour(vec3 linear) {
    vec3 c = clamp(linear, vec3(0.0), vec3(1.0));
    return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}
#else
vec3 storedColour(vec3 linear) { return linear; }
#endif

#endif
