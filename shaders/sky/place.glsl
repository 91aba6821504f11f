// sky/place.glsl: where a direction lies in the sky table. Across: the azimuth from the sun, 0 .. pi, fine near the sun. Up:
// the elevation, the lower half of the rows from straight down to the horizon and the upper half from there to the zenith, fine
// near the horizon. The table of air has distances beside, fine near the eye.
#ifndef TERRAY_SKY_PLACE
#define TERRAY_SKY_PLACE

const float kHalfPi = 1.57079633;
const float kFarthestAir = 300000.0;  // metres

// Azimuth from the sun and elevation of a texel's centre, radians. horizon: its elevation.
vec2 skyAngles(ivec2 texel, ivec2 size, float horizon) {
    float across = float(texel.x) / float(size.x - 1);
    int middle = size.y / 2;
    bool above = texel.y >= middle;
    float away = float(above ? texel.y - middle : middle - 1 - texel.y) / float(middle - 1);
    float reach = above ? kHalfPi - horizon : -kHalfPi - horizon;
    return vec2(2.0 * kHalfPi * across * across, horizon + reach * away * away);
}

// Texture coordinate of a direction. azimuth: from the sun, 0 .. pi.
vec2 skyPlace(float azimuth, float elevation, vec2 size, float horizon) {
    float across = sqrt(azimuth / (2.0 * kHalfPi));
    float middle = 0.5 * size.y;
    bool above = elevation >= horizon;
    float away = sqrt(clamp((elevation - horizon) / (above ? kHalfPi - horizon : -kHalfPi - horizon), 0.0, 1.0));
    float row = above ? middle + 0.5 + away * (middle - 1.0) : middle - 0.5 - away * (middle - 1.0);
    return vec2(0.5 + across * (size.x - 1.0), row) / size;
}

// Distance of a slice of the table of air, metres.
float sliceDistance(int slice, int slices) {
    float share = float(slice) / float(slices - 1);
    return kFarthestAir * share * share;
}
// Texture coordinate of a distance across the slices.
float slicePlace(float distance, float slices) {
    return (0.5 + sqrt(min(distance / kFarthestAir, 1.0)) * (slices - 1.0)) / slices;
}

#endif
