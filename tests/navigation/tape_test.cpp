#include "client/navigation/tape.h"

#include <cmath>

#include <gtest/gtest.h>

namespace terray::test {
namespace {

/// A roof along x: up to 1000 m at slope 3/4, down again; a hole beyond y = 100.
class Roof final : public Ground {
    std::optional<GroundHeight> under(glm::dvec2 place) override {
        if (place.y > 100) return {};
        return GroundHeight{0.75 * (1000 - std::abs(place.x)), 0};
    }
};

TEST(Tape, MeasuresStraightAndAlongTheGround) {
    Roof roof;
    const TapeReading reading = readTape(roof, {-1000, 0}, {1000, 0}, nullptr);
    EXPECT_EQ(reading.straight.value(), 2000);
    EXPECT_NEAR(reading.alongGround.value(), 2500, 1e-6);  // 3, 4, 5
    EXPECT_NEAR(reading.climb.value(), 750, 1e-9);
    EXPECT_NEAR(reading.profile[reading.profile.size() / 2].z, 750, 1e-9);
    EXPECT_EQ(reading.profile.front(), glm::dvec3(-1000, 0, 0));
}

TEST(Tape, CrossesHolesLevel) {
    Roof roof;
    const TapeReading hole = readTape(roof, {0, 200}, {0, 300}, nullptr);
    EXPECT_NEAR(hole.alongGround.value(), 100, 1e-9);
    const TapeReading into = readTape(roof, {0, 0}, {0, 300}, nullptr);
    EXPECT_NEAR(into.alongGround.value(), 300, 1e-9);
    const TapeReading out = readTape(roof, {0, 300}, {0, 0}, nullptr);
    EXPECT_NEAR(out.climb.value(), 0, 1e-9);
}

#if TERRAY_WITH_PROJ
TEST(Tape, IsGeodesicWhereTheEarthIsKnown) {
    Roof roof;
    const auto utm = Projection::create("EPSG:32613");
    ASSERT_TRUE(utm.ok());
    const TapeReading reading = readTape(roof, {500000, 0}, {500000, 1000}, &*utm);
    EXPECT_NEAR(reading.straight.value(), 1000 / 0.9996, 1e-3) << "the central meridian of UTM has the scale 0.9996";
}
#endif

}  // namespace
}  // namespace terray::test
