#include "client/render/feature_set.h"

namespace terray {

FeatureSet FeatureSet::marching() const {
    return {.statistics = statistics,
            .occlusion = occlusion,
            .bilinear = bilinear,
            .curved = curved,
            .method = entryOf(method).define.empty() ? Method::pyramid : method};
}

FeatureSet FeatureSet::resolving() const {
    const ShadingNeeds needs = needsOf(shading);
    const bool photo = imagery && needs.photo;
    return {.imagery = photo,
            .normals = normals,
            .signalSky = signalSky && needs.sky,
            .linearColour = linearColour,
            .photoProbes = photo && photoProbes,
            .curved = curved && (photo || needs.footprint),
            .sky = sky && needs.sky,
            .air = air && needs.light,
            .shadows = shadows && (needs.light || needs.shadowSteps),
            .shading = shading == Shading::light ? Shading::photo : shading};
}

FeatureSet FeatureSet::shadowing() const {
    return {.statistics = statistics, .bilinear = true, .curved = curved, .softSun = softSun};
}

FeatureSet FeatureSet::overlaying() const {
    return {.linearColour = linearColour, .curved = curved, .sky = sky, .air = air};
}

ShaderDefines FeatureSet::defines() const {
    const auto digit = [](bool on) { return on ? "1" : "0"; };
    ShaderDefines defines = {
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
    for (const MethodEntry& entry : kMethods)
        if (!entry.define.empty()) defines.emplace(entry.define, digit(entry.method == method));
    bool ownGround = false;
    for (const ShadingMode& mode : kShadingModes) {
        if (mode.define.empty()) continue;
        defines.emplace(mode.define, digit(mode.shading == shading));
        ownGround |= mode.shading == shading;
    }
    defines.emplace("TERRAY_SHADING", digit(ownGround));
    defines.emplace("TERRAY_UNLIT", digit(!needsOf(shading).light));
    return defines;
}

}  // namespace terray
