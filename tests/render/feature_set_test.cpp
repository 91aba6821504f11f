#include "client/render/feature_set.h"

#include <algorithm>
#include <string>
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
static_assert(std::size(kFeatures) + sizeof(Shading) + sizeof(Method) == sizeof(FeatureSet), "a new feature joins these tests");

/// Modes with a define of their own, and the two of all.
constexpr size_t kShadingDefines = kShadingModes.size() - 2 + 2;
/// Methods with a define of their own.
constexpr auto kMethodDefines = static_cast<size_t>(
    std::ranges::count_if(kMethods, [](const MethodEntry& entry) { return !entry.define.empty(); }));

/// Every combination of features with the photo, and each mode with none of them and with all.
std::vector<FeatureSet> allFeatureSets() {
    std::vector<FeatureSet> sets;
    for (unsigned bits = 0; bits < 1u << std::size(kFeatures); ++bits) {
        FeatureSet& features = sets.emplace_back();
        for (size_t i = 0; i < std::size(kFeatures); ++i) features.*kFeatures[i].feature = (bits >> i & 1) != 0;
    }
    FeatureSet all;
    for (const Named& named : kFeatures) all.*named.feature = true;
    for (const ShadingMode& mode : kShadingModes) {
        sets.emplace_back().shading = mode.shading;
        sets.emplace_back(all).shading = mode.shading;
    }
    for (const MethodEntry& entry : kMethods) sets.emplace_back(all).method = entry.method;
    return sets;
}

TEST(FeatureSet, DefinesEveryFeatureAsZeroOrOne) {
    for (const FeatureSet& features : allFeatureSets()) {
        const ShaderDefines defines = features.defines();
        EXPECT_EQ(defines.size(), std::size(kFeatures) + kShadingDefines + kMethodDefines);
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

TEST(FeatureSet, OneMethodIsCompiledInAndOnlyIntoTheMarch) {
    for (const MethodEntry& entry : kMethods) {
        EXPECT_EQ(entryOf(entry.method).name, entry.name) << "the table's order is that of the enumeration";
        const FeatureSet features{.method = entry.method};
        const ShaderDefines defines = features.marching().defines();
        for (const MethodEntry& other : kMethods)
            if (!other.define.empty()) {
                EXPECT_EQ(defines.at(std::string(other.define)), other.method == entry.method ? "1" : "0") << entry.name;
            }
        EXPECT_EQ(features.marching() == FeatureSet(), entry.define.empty()) << entry.name;
        for (const FeatureSet& other : {features.resolving(), features.shadowing(), features.overlaying()})
            EXPECT_EQ(other.method, Method::pyramid) << "all else is the same program whatever the method";
    }
}

TEST(FeatureSet, OneModeIsCompiledInAndOnlyWhereItShowsSomethingElseThanThePhoto) {
    for (const ShadingMode& mode : kShadingModes) {
        const ShaderDefines defines = FeatureSet{.shading = mode.shading}.defines();
        size_t on = 0;
        for (const ShadingMode& other : kShadingModes)
            if (!other.define.empty()) {
                on += defines.at(std::string(other.define)) == "1" ? 1 : 0;
            }
        EXPECT_EQ(on, mode.define.empty() ? 0u : 1u) << mode.name;
        EXPECT_EQ(defines.at("TERRAY_SHADING"), mode.define.empty() ? "0" : "1") << mode.name;
        EXPECT_EQ(kShadingModes[static_cast<size_t>(mode.shading)].name, mode.name);
        if (!mode.define.empty()) {
            EXPECT_EQ(defines.at(std::string(mode.define)), "1");
        }
    }
}

TEST(FeatureSet, ModesLeaveOutWhatTheyDoNotShow) {
    FeatureSet all;
    for (const Named& named : kFeatures) all.*named.feature = true;
    const auto resolving = [&](Shading shading) {
        all.shading = shading;
        return all.resolving();
    };
    for (const ShadingMode& mode : kShadingModes) {
        const FeatureSet kept = resolving(mode.shading);
        const bool photo = mode.shading == Shading::photo || mode.shading == Shading::sobel;
        EXPECT_EQ(kept.imagery, photo) << mode.name;
        EXPECT_EQ(kept.photoProbes, photo) << mode.name;
        EXPECT_EQ(kept.curved, photo || mode.shading == Shading::grid || mode.shading == Shading::contours);
        EXPECT_EQ(kept.resolving(), kept) << mode.name;
        // The march, shadow rays and overlays are the same programs whatever the mode.
        for (const FeatureSet& other : {all.marching(), all.shadowing(), all.overlaying()})
            EXPECT_EQ(other.shading, Shading::photo) << mode.name;
    }
    EXPECT_EQ(resolving(Shading::light).shading, Shading::photo) << "light is the photo's program without a photo";
    for (const Shading measured : {Shading::depth, Shading::normal, Shading::slope, Shading::sobel}) {
        EXPECT_FALSE(resolving(measured).air || resolving(measured).shadows);
        EXPECT_TRUE(resolving(measured).sky);
    }
    EXPECT_FALSE(resolving(Shading::steps).sky || resolving(Shading::steps).shadows);
    EXPECT_TRUE(resolving(Shading::shadowSteps).shadows) << "without shadows there are none to count";
    EXPECT_TRUE(resolving(Shading::contours).air && resolving(Shading::contours).shadows);
}

TEST(Shading, ContoursLieAtOneTwoOrFiveTimesAPowerOfTen) {
    const auto interval = [](double lowest, double highest) {
        return automaticContourInterval(Metres(lowest), Metres(highest)).value();
    };
    EXPECT_NEAR(interval(1358, 4298), 100, 1e-9);
    EXPECT_NEAR(interval(-400, 8848), 200, 1e-9);
    EXPECT_NEAR(interval(600, 1400), 20, 1e-9);
    EXPECT_NEAR(interval(0, 999), 20, 1e-9);
    EXPECT_NEAR(interval(0, 1001), 50, 1e-9);
    EXPECT_NEAR(interval(0, 4.1), 0.2, 1e-9);
    EXPECT_EQ(interval(7, 7), 1);
}

}  // namespace
}  // namespace terray
