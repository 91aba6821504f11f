// shading/legend.glsl: the colours of legends, written as sRGB bytes 0xRRGGBB and returned linear.
#ifndef TERRAY_SHADING_LEGEND
#define TERRAY_SHADING_LEGEND

// Source: IEC 61966-2-1:1999, the inverse of srgb.glsl.
vec3 linearFromSrgb(vec3 encoded) {
    return mix(pow((encoded + 0.055) / 1.055, vec3(2.4)), encoded / 12.92, lessThanEqual(encoded, vec3(0.04045)));
}

vec3 encodedColour(uint rgb) { return vec3(uvec3(rgb >> 16, rgb >> 8, rgb) & 0xffu) / 255.0; }

vec3 legendColour(uint rgb) { return linearFromSrgb(encodedColour(rgb)); }

// Ramps have as many stops, evenly spaced; between them colours are mixed as sRGB. place: 0 at the first stop, 1 at the next.
const int kStops = 7;
vec3 rampColour(uint stops[kStops], float place) {
    float inside = clamp(place, 0.0, float(kStops - 1));
    int below = min(int(inside), kStops - 2);
    return linearFromSrgb(
        mix(encodedColour(stops[below]), encodedColour(stops[below + 1]), inside - float(below)));
}

#endif
