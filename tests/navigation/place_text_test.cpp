#include "client/navigation/place_text.h"

#include <gtest/gtest.h>

namespace terray::test {
namespace {

TEST(PlaceText, ReadsProjectedCoordinates) {
    for (const char* text : {"412000.5, 4210000", "412000.5 4210000", " 412000.5;4210000 "}) {
        const auto place = parsePlace(text, nullptr);
        ASSERT_TRUE(place.ok()) << text;
        EXPECT_EQ(*place, glm::dvec2(412000.5, 4210000));
    }
    EXPECT_EQ(*parsePlace("12, 45", nullptr), glm::dvec2(12, 45)) << "no projection, no degrees";
}

TEST(PlaceText, RefusesAnythingElse) {
    for (const char* text : {"", "12", "12, north", "1, 2, 3", "nan, 2", "1e99, 2", "inf 1"})
        EXPECT_FALSE(parsePlace(text, nullptr).ok()) << text;
}

#if TERRAY_WITH_PROJ
TEST(PlaceText, ReadsLatitudeThenLongitudeAndStillProjectedCoordinates) {
    const auto utm = Projection::create("EPSG:32613");
    ASSERT_TRUE(utm.ok());
    const auto place = parsePlace("38.03, -105.99", &*utm);
    ASSERT_TRUE(place.ok()) << place.failure().message;
    const auto back = utm->lonLat(*place);
    ASSERT_TRUE(back.ok());
    EXPECT_NEAR(back->latitude, 38.03, 1e-9);
    EXPECT_NEAR(back->longitude, -105.99, 1e-9);
    EXPECT_EQ(*parsePlace("412000, 4210000", &*utm), glm::dvec2(412000, 4210000));
}
#endif

}  // namespace
}  // namespace terray::test
