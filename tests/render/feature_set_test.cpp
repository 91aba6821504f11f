#include "client/render/feature_set.h"

#include <vector>

#include <gtest/gtest.h>

namespace terray {
namespace {

/// Every combination of features.
std::vector<FeatureSet> allFeatureSets() {
    static_assert(sizeof(FeatureSet) == 4, "a new feature joins these tests");
    std::vector<FeatureSet> sets;
    for (unsigned bits = 0; bits < 16; ++bits) {
        sets.push_back({.imagery = (bits & 1) != 0,
                        .statistics = (bits & 2) != 0,
                        .normals = (bits & 4) != 0,
                        .signalSky = (bits & 8) != 0});
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
        EXPECT_EQ(defines.at("TERRAY_IMAGERY") == "1", features.imagery);
        EXPECT_EQ(defines.at("TERRAY_STATISTICS") == "1", features.statistics);
        EXPECT_EQ(defines.at("TERRAY_NORMALS") == "1", features.normals);
        EXPECT_EQ(defines.at("TERRAY_SIGNAL_SKY") == "1", features.signalSky);
    }
}

}  // namespace
}  // namespace terray
