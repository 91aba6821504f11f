#pragma once

#include "client/overlay/ground_heights.h"
#include "client/overlay/track.h"
#include "client/stream/flight.h"
#include "common/projection.h"

namespace terray {

/// How a camera flies along a recorded track. Seconds are those of the flight.
struct TrackFlightOptions {
    double speed = 1;             ///< times as fast as it was recorded, > 0
    double metresPerSecond = 30;  ///< where the track has no times, > 0
    double smoothing = 2;         ///< seconds over which the path is averaged, > 0
    double lookAhead = 4;         ///< the camera looks to where it will be in so many seconds, > 0
    double lookDown = 8;          ///< degrees, and by so much lower
    double above = 0;             ///< metres above the recorded heights
    double clearance = 20;        ///< metres above the ground at least, > 0
};

/// A flight along all lines of a track, one after the other, headed where it goes.
///
/// The path is linear between fixes, then averaged with a Gaussian whose standard deviation is half of `smoothing`,
/// mirrored at both ends so that these stay where they are; keys lie half of `smoothing` apart, and between them is the
/// spline of flights. A fix that is not later than the one before is left out. Where any fix lacks its time, all are
/// flown through at one speed. A fix without a height is on the ground, or where there is none at the height before it.
/// Then keys are raised until the path keeps `clearance` above the finest ground (keepAbove). Fails with a sentence
/// where fewer than two fixes are apart, where it would have more than kMostTrackKeys keys, and where a place is not
/// in the projection. Throws Error(dataset) when a tile cannot be read.
[[nodiscard]] Result<Flight> flightAlong(const Track& track, const TrackFlightOptions& options,
                                         const Projection& projection, GroundHeights& ground);

/// A day's flight with a key a second has 86 400.
inline constexpr size_t kMostTrackKeys = 200'000;

}  // namespace terray
