#include "client/engine/sun_clock.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "common/error.h"
#include "common/sun_position.h"

namespace terray {
namespace {

const UtcTime kNoon = parseUtcTime("2026-06-21T12:00Z").value();

ExitCode refusalOf(const DatasetMetadata& metadata) {
    try {
        const SunClock clock(kNoon, metadata);
    } catch (const Error& error) {
        return error.code();
    }
    return ExitCode::ok;
}

TEST(SunClock, RefusesWhatLiesNowhere) {
    EXPECT_EQ(refusalOf({}), ExitCode::georeference);
    DatasetMetadata odd;
    odd.crsWkt = "no coordinate system";
    EXPECT_EQ(refusalOf(odd), TERRAY_WITH_PROJ ? ExitCode::georeference : ExitCode::unsupported);
}

#if TERRAY_WITH_PROJ

TEST(SunClock, FollowsThePlace) {
    DatasetMetadata metadata;
    metadata.crsWkt = "EPSG:32632";
    const SunClock clock(kNoon, metadata);
    const auto projection = Projection::create(metadata.crsWkt);
    ASSERT_TRUE(projection.ok());
    for (const LonLat place : {LonLat{.longitude = 9, .latitude = 46}, LonLat{.longitude = 6.2, .latitude = 44}}) {
        const auto plane = projection->plane(place);
        ASSERT_TRUE(plane.ok());
        const auto expected = gridSunDirection(kNoon, *projection, *plane);
        EXPECT_EQ(clock.direction(*plane), *expected);
        // Over the central meridian that is the true direction itself.
        if (place.longitude != 9) continue;
        EXPECT_LT(glm::length(clock.direction(*plane) - directionOf(sunAngles(kNoon, place))), 2e-6);
    }
}

TEST(SunClock, SaysWhereItKnowsNoSun) {
    DatasetMetadata metadata;
    metadata.crsWkt = "EPSG:32632";
    const SunClock clock(kNoon, metadata);
    try {
        (void)clock.direction({1e30, 1e30});
        FAIL() << "the place is not on the earth";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::georeference);
    }
}

#endif

}  // namespace
}  // namespace terray
