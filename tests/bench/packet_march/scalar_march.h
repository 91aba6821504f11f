#pragma once

#include "tests/bench/packet_march/packet_march.h"

namespace terray {

struct ScalarHit {
    double t;   ///< infinity without a hit
    int steps;  ///< looked up blocks and patches
};

/// The same march in double, one ray at a time and with branches, from shaders/math as it compiles for C++: between it
/// and a PacketKernel lie float's rounding and the transcription to lanes, nothing else.
[[nodiscard]] ScalarHit scalarMarch(const HeightPyramid& pyramid, const MapRay& ray);

}  // namespace terray
