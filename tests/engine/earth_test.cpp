#include "client/engine/earth.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/engine/dataset_camera.h"

namespace terray {
namespace {

constexpr double kFocal720 = 720 / (2 * 0.41421356237);  // pixels: 45 degrees over 720 rows
constexpr double kTolerance = 2.0 / 3;

/// A square dataset of metres a side, in UTM or nowhere.
DatasetMetadata square(double side, const std::string& crs) {
    DatasetMetadata metadata;
    metadata.tiling = {.west = 400000, .north = 5100000, .finestSpacing = side / 512, .finestLevel = 0};
    metadata.samples = {512, 512};
    metadata.crsWkt = metadata.crsName = crs;
    metadata.maxHeight = 4000;
    return metadata;
}

bool curvedByItself(double side, const std::string& crs, double tolerance = kTolerance) {
    return EarthModel(square(side, crs), {}, tolerance, kFocal720).curved();
}

TEST(EarthModel, IsCurvedByItselfWhereThatMovesGroundByMoreThanTheTolerance) {
    // (1 - 0.13) D / (2 * 6371 km) * 869 pixels > 2/3 from D = 11.24 km on: 7.94 km a side.
    EXPECT_FALSE(curvedByItself(7.9e3, "EPSG:32632"));
    EXPECT_TRUE(curvedByItself(8e3, "EPSG:32632"));
    EXPECT_FALSE(curvedByItself(20e3, "EPSG:32632", 3)) << "a coarser tolerance reaches farther";
    EXPECT_FALSE(curvedByItself(600e3, "")) << "a plain image lies nowhere on the earth";
    EXPECT_EQ(EarthModel(square(8e3, ""), {}, 1, 1).description(), "flat");
}

TEST(EarthModel, ObeysTheOption) {
    const EarthModel flat(square(600e3, "EPSG:32632"), {.shape = EarthShape::flat}, kTolerance, kFocal720);
    EXPECT_FALSE(flat.curved());
    EXPECT_FALSE(flat.at({600000, 4900000, 3000}).has_value());
    const EarthModel sphere(square(1e3, ""), {.shape = EarthShape::curved, .refraction = 0.25}, kTolerance, kFocal720);
    ASSERT_TRUE(sphere.curved());
    EXPECT_EQ(sphere.at({1, 2, 3000}), sphericalEarth({.eyeHeight = 3000, .refraction = 0.25}));
    EXPECT_NE(sphere.description().find("sphere"), std::string::npos);
    EXPECT_NE(sphere.description().find("0.25"), std::string::npos);
}

TEST(EarthModel, FollowsTheEyeAndStaysOverTheDataset) {
    const DatasetMetadata metadata = square(200e3, "EPSG:32632");
    const EarthModel earth(metadata, {.shape = EarthShape::curved}, kTolerance, kFocal720);
#if TERRAY_WITH_PROJ
    EXPECT_NE(earth.description().find("EPSG:32632"), std::string::npos);
    const auto projection = Projection::create("EPSG:32632");
    ASSERT_TRUE(projection.ok());
    EXPECT_EQ(earth.at({450000, 5000000, 2000}), *earthCurvature(*projection, {450000, 5000000}, {.eyeHeight = 2000}));
    EXPECT_NE(earth.at({450000, 5000000, 2000}), earth.at({450000, 4950000, 2000}));
    // Far outside the map that the projection is good for: as over the nearest corner.
    EXPECT_EQ(earth.at({1e30, -1e30, 2000}), earth.at({600000, 4900000, 2000}));
    // A coordinate system that PROJ does not know leaves a sphere and the reason.
    const EarthModel unknown(square(200e3, "no such system"), {}, kTolerance, kFocal720);
    EXPECT_EQ(unknown.at({450000, 5000000, 0}), sphericalEarth({.eyeHeight = 0}));
    EXPECT_NE(unknown.description().find("no such system"), std::string::npos) << unknown.description();
#else
    EXPECT_EQ(earth.at({450000, 5000000, 0}), sphericalEarth({.eyeHeight = 0}));
#endif
}

TEST(EarthModel, TheOverviewShowsTheWholeDatasetAsItIsSeen) {
    for (const double side : {50e3, 600e3, 2000e3}) {
        const DatasetMetadata metadata = square(side, "");
        const EarthModel earth(metadata, {.shape = EarthShape::curved, .refraction = 0}, kTolerance, kFocal720);
        const Camera camera = overviewCamera(metadata, 16.0 / 9, earth);
        const View view = viewOf(camera, 160, 90);
        const GroundRect ground = metadata.groundBounds();
        for (const double x : {ground.west, ground.east})
            for (const double y : {ground.south, ground.north})
                for (const double z : {metadata.minHeight, metadata.maxHeight}) {
                    glm::dvec3 way = glm::dvec3{x, y, z} - view.eye;
                    way.z -= earth.at(view.eye)->drop(way.x, way.y);
                    const double depth = glm::dot(way, view.forward);
                    EXPECT_GT(depth, 0);
                    EXPECT_LE(std::abs(glm::dot(way, view.right)), depth * view.tanHalfWidth()) << side;
                    EXPECT_LE(std::abs(glm::dot(way, view.up)), depth * view.tanHalfHeight) << side;
                }
    }
}

}  // namespace
}  // namespace terray
