#pragma once
// The modules of this folder in float (Single) and in double (Double) behind the same names, so that one template runs
// as both.

#include "shaders/math/math.h"

namespace terray::math {

#define TERRAY_PRECISION(Name, math)                                        \
    struct Name {                                                           \
        using real = math::real;                                            \
        using vec2 = math::vec2;                                            \
        using vec3 = math::vec3;                                            \
        using ivec2 = math::ivec2;                                          \
        using Interval = math::Interval;                                    \
        using Clearance = math::Clearance;                                  \
        using Corners = math::Corners;                                      \
        using Footprint = math::Footprint;                                  \
        static constexpr auto* safeInverse = math::safeInverse;             \
        static constexpr auto* boxInterval = math::boxInterval;             \
        static constexpr auto* blockEdge = math::blockEdge;                 \
        static constexpr auto* edgeTimes = math::edgeTimes;                 \
        static constexpr auto* cellAfter = math::cellAfter;                 \
        static constexpr auto* levelAfter = math::levelAfter;               \
        static constexpr auto* cellAt = math::cellAt;                       \
        static constexpr auto* meetsColumn = math::meetsColumn;             \
        static constexpr auto* columnTime = math::columnTime;               \
        static constexpr auto* clearanceAt = math::clearanceAt;             \
        static constexpr auto* firstContact = math::firstContact;           \
        static constexpr auto* riseTime = math::riseTime;                   \
        static constexpr auto* patchHeight = math::patchHeight;             \
        static constexpr auto* patchClearance = math::patchClearance;       \
        static constexpr auto* bentHeight = math::bentHeight;               \
        static constexpr auto* bentSlope = math::bentSlope;                 \
        static constexpr auto* lowestTime = math::lowestTime;               \
        static constexpr auto* bentMeetsColumn = math::bentMeetsColumn;     \
        static constexpr auto* bentColumnTime = math::bentColumnTime;       \
        static constexpr auto* earthDrop = math::earthDrop;                 \
        static constexpr auto* earthFall = math::earthFall;                 \
        static constexpr auto* projected = math::projected;                 \
        static constexpr auto* pixelFootprint = math::pixelFootprint;       \
        static constexpr auto* meanDecay = math::meanDecay;                 \
        static constexpr auto* airColumn = math::airColumn;                 \
        static constexpr auto* airColumnToSpace = math::airColumnToSpace;   \
        static constexpr auto* aerosolExtinction = math::aerosolExtinction; \
        static constexpr auto* moleculePhase = math::moleculePhase;         \
        static constexpr auto* aerosolPhase = math::aerosolPhase;           \
        static constexpr auto* heightAlong = math::heightAlong;             \
        static constexpr auto* cosineAlong = math::cosineAlong;             \
        static constexpr auto* horizonCosine = math::horizonCosine;         \
        static constexpr auto* seaDistance = math::seaDistance;             \
        static constexpr auto* leavingDistance = math::leavingDistance;     \
        static constexpr auto* enteringDistance = math::enteringDistance;   \
    };

TERRAY_PRECISION(Single, mathf)
TERRAY_PRECISION(Double, mathd)

#undef TERRAY_PRECISION

}  // namespace terray::math
