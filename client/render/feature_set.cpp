#include "client/render/feature_set.h"

namespace terray {

ShaderDefines FeatureSet::defines() const {
    const auto digit = [](bool on) { return on ? "1" : "0"; };
    return {
        {"TERRAY_IMAGERY", digit(imagery)},
        {"TERRAY_STATISTICS", digit(statistics)},
        {"TERRAY_NORMALS", digit(normals)},
        {"TERRAY_SIGNAL_SKY", digit(signalSky)},
    };
}

}  // namespace terray
