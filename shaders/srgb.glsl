// srgb.glsl: linear colour as it is stored: with TERRAY_SRGB_COLOUR encoded and rounded to 8 bits, else as it is.
// Encoded here and not by the output unit, since images that compute shaders write know no sRGB: both launches store the
// same bytes. Source: IEC 61966-2-1:1999.
// Rounding is dithered, or a clear sky would show its 8 bits as bands: a value between two bytes becomes either, by a threshold
// of the pixel, so that an area's mean is right to 1/64 of a step. A value that is a byte stays that byte.
#ifndef TERRAY_SRGB
#define TERRAY_SRGB

#if TERRAY_SRGB_COLOUR
// Threshold of a pixel, 1/128 .. 127/128 in steps of 1/64. Neighbours differ much and no pattern is seen: the lattice of the
// plane's most even sequence, in 32-bit fractions of 1 (Roberts 2018, "The unreasonable effectiveness of quasirandom
// sequences": 1/p and 1/p^2 of p^3 = p + 1). Channels take thirds of a turn, so that their steps do not coincide.
vec3 ditherThreshold(ivec2 pixel) {
    uint place = uint(pixel.x) * 3242174889u + uint(pixel.y) * 2447445414u;
    uvec3 turns = uvec3(place) + uvec3(0u, 0x55555555u, 0xaaaaaaaau);
    return (vec3(turns >> 26) + 0.5) / 64.0;
}

vec3 storedColour(vec3 linear, ivec2 pixel) {
    vec3 c = clamp(linear, vec3(0.0), vec3(1.0));
    vec3 encoded = mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
    return floor(255.0 * encoded + ditherThreshold(pixel)) / 255.0;
}
#else
vec3 storedColour(vec3 linear, ivec2 pixel) { return linear; }
#endif

#endif
