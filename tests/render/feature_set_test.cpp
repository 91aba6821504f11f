#include "client/render/feature_set.h"

#include <vector>

#include <gtest/gtest.h>

namespace terray {
namespace {

/// The features one by one, with their defines. TERRAY_SRGB_COLOUR says the opposite of its feature.
struct Named {
    bool FeatureSet::*feature;
    const char* define;
};
constexpr Named kFeatures[] = {
    {&FeatureSet::imagery, "TERRAY_IMAGERY"},
    {&FeatureSet::statistics, "TERRAY_STATISTICS"},
    {&FeatureSet::normals, "TERRAY_NORMALS"},
    {&FeatureSet::signalSky, "TERRAY_SIGNAL_SKY"},
    {&FeatureSet::occlusion, "TERRAY_OCCLUSION"},
    {&FeatureSet::photoProbes, "TERRAY_PHOTO_PROBES"},
    {&FeatureSet::bilinear, "TERRAY_BILINEAR"},
    {&FeatureSet::curved, "TERRAY_CURVED"},
    {&FeatureSet::shadows, "TERRAY_SHADOWS"},
    {&FeatureSet::softSun, "TERRAY_SOFT_SUN"},
    {&FeatureSet::linearColour, "TERRAY_SRGB_COLOUR"},
    {&FeatureSet::sky, "TERRAY_SKY"},
    {&FeatureSet::air, "TERRAY_AIR"},
};
static_assert(std::size(kFeatures) == sizeof(FeatureSet), "a new feature joins these tests");

/// Every combination of features.
std::vector<FeatureSet> allFeatureSets() {
    std::vector<FeatureSet> sets;
    for (unsigned bits = 0; bits < 1u << std::size(kFeatures); ++bits) {
        FeatureSet& features = sets.emplace_back();
        for (size_t i = 0; i < std::size(kFeatures); ++i) features.*kFeatures[i].feature = (bits >> i & 1) != 0;
    }
    return sets;
}

TEST(FeatureSet, DefinesEveryFeatureAsZeroOrOne) {
    for (const FeatureSet& features : allFeatureSets()) {
        const ShaderDefines defines = features.defines();
        EXPECT_EQ(defines.size(), sizeof(FeatureSet));
        for (const auto& [name, value] : defines) {
            EXPECT_TRUE(name.starts_with("TERRAY_")) << name;
            EXPECT_TRUE(value == "0" || value == "1") << name << " " << value;
        }
    }
}

TEST(FeatureSet, EachDefineSaysItsOwnFeature) {
    for (const FeatureSet& features : allFeatureSets()) {
        const ShaderDefines defines = features.defines();
        for (const auto& [feature, define] : kFeatures) {
            const bool on = features.*feature != (feature == &FeatureSet::linearColour);
            ASSERT_EQ(defines.at(define), on ? "1" : "0") << define;
        }
    }
}

TEST(FeatureSet, MarchAndResolveIgnoreWhatTheyDoNotUse) {
    FeatureSet lookOnly;
    lookOnly.imagery = lookOnly.normals = lookOnly.signalSky = lookOnly.photoProbes = lookOnly.linearColour = true;
    lookOnly.sky = lookOnly.air = true;
    EXPECT_EQ(lookOnly.marching(), FeatureSet());
    FeatureSet marchOnly;
    marchOnly.statistics = marchOnly.occlusion = marchOnly.bilinear = marchOnly.curved = true;
    EXPECT_EQ(marchOnly.resolving(), FeatureSet());
    const FeatureSet probesForNothing{.photoProbes = true};
    EXPECT_EQ(probesForNothing.resolving(), FeatureSet());
    // Only a photo's footprint asks how the earth falls.
    const FeatureSet photoOverCurve{.imagery = true, .curved = true};
    EXPECT_EQ(photoOverCurve.resolving(), photoOverCurve);
}

}  // namespace
}  // namespace terray
