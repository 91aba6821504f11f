#include "client/render/feature_set.h"

namespace terray {

FeatureSet FeatureSet::marching() const {
    return {.statistics = statistics, .occlusion = occlusion, .bilinear = bilinear, .curved = curved};
}

FeatureSet FeatureSet::resolving() const {
    return {.imagery = imagery,
            .normals = normals,
            .signalSky = signalSky,
            .linearColour = linearColour,
            .photoProbes = imagery && photoProbes,
            .curved = imagery && curved,
            .sky = sky,
            .air = air,
            .shadows = shadows};
}

FeatureSet FeatureSet::shadowing() const {
    return {.statistics = statistics, .bilinear = true, .curved = curved, .softSun = softSun};
}

FeatureSet FeatureSet::overlaying() const {
    return {.linearColour = linearColour, .curved = curved, .sky = sky, .air = air};
}

ShaderDefines FeatureSet::defines() const {
    const auto digit = [](bool on) { return on ? "1" : "0"; };
    return {
        {"TERRAY_IMAGERY", digit(imagery)},
        {"TERRAY_STATISTICS", digit(statistics)},
        {"TERRAY_NORMALS", digit(normals)},
        {"TERRAY_SIGNAL_SKY", digit(signalSky)},
        {"TERRAY_OCCLUSION", digit(occlusion)},
        {"TERRAY_PHOTO_PROBES", digit(photoProbes)},
        {"TERRAY_BILINEAR", digit(bilinear)},
        {"TERRAY_CURVED", digit(curved)},
        {"TERRAY_SKY", digit(sky)},
        {"TERRAY_AIR", digit(air)},
        {"TERRAY_SHADOWS", digit(shadows)},
        {"TERRAY_SOFT_SUN", digit(softSun)},
        {"TERRAY_SRGB_COLOUR", digit(!linearColour)},
    };
}

}  // namespace terray
