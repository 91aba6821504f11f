#include "common/dataset_metadata.h"

#include <gtest/gtest.h>

namespace terray {
namespace {

DatasetMetadata fullMetadata() {
    DatasetMetadata metadata;
    metadata.tiling = {.west = 415012.5, .north = 4211987.25, .finestSpacing = 29.7, .finestLevel = 3};
    metadata.samples = {2401, 1201};
    metadata.imageryLevel = 4;
    metadata.imageryBounds = GroundRect{415012.5, 4176000, 486000, 4211987.25};
    metadata.crsWkt = "PROJCRS[\"WGS 84 / UTM zone 13N\"]";
    metadata.crsName = "EPSG:32613";
    metadata.lonLatBounds = GroundRect{-106, 37, -105, 38};
    metadata.verticalDatum = "NAVD88";
    metadata.quantum = 0.005;
    metadata.minHeight = 1801.5;
    metadata.maxHeight = 4365.25;
    metadata.holeSamples = 17;
    metadata.heightTiles = 25;
    metadata.imageryTiles = 81;
    metadata.levelErrors = {123.5, 44.25, 10, 0.0025};
    metadata.errorBound = 0.005;
    metadata.tool = "terray-preprocess 0.1.0";
    metadata.options = "--height-scale 0.3048";
    metadata.sources = {{"a \"quoted\" name.nc", 11534336, 1700000000}, {"old.tif", 0, -86400}};
    return metadata;
}

Json copyWith(const Json& json, const std::vector<std::string>& path, const Json* value);

/// A member object's copy in which the member at the end of `path` is replaced, or removed where value is nullptr.
Json copyWith(const Json& json, const std::vector<std::string>& path, const Json* value) {
    Json copy = Json::Object{};
    for (const auto& [name, member] : json.object()) {
        if (name != path.front()) {
            copy.set(name, member);
        } else if (path.size() > 1) {
            copy.set(name, copyWith(member, {path.begin() + 1, path.end()}, value));
        } else if (value != nullptr) {
            copy.set(name, *value);
        }
    }
    return copy;
}

using Path = std::vector<std::string>;

/// Every member of nested objects, groups included.
void collectPaths(const Json& json, const Path& base, std::vector<Path>& paths) {
    for (const auto& [name, member] : json.object()) {
        Path path = base;
        path.push_back(name);
        paths.push_back(path);
        if (member.isObject()) collectPaths(member, path, paths);
    }
}

std::string join(const Path& path) {
    std::string text;
    for (const std::string& part : path) text += "/" + part;
    return text;
}

std::string complaint(const Json& json) {
    const auto result = metadataFromJson(json);
    return result.ok() ? "accepted" : result.failure().message;
}

TEST(DatasetMetadata, RoundTripsThroughText) {
    for (const DatasetMetadata& metadata : {fullMetadata(), [] {
                                                DatasetMetadata plain;
                                                plain.samples = {1, 1};
                                                plain.levelErrors = {0};
                                                return plain;
                                            }()}) {
        const auto json = Json::parse(toJson(metadata).dump());
        ASSERT_TRUE(json.ok());
        const auto read = metadataFromJson(*json);
        ASSERT_TRUE(read.ok()) << read.failure().message;
        EXPECT_EQ(*read, metadata);
    }
}

TEST(DatasetMetadata, RefusesEachMissingField) {
    const Json json = toJson(fullMetadata());
    std::vector<Path> paths;
    collectPaths(json, {}, paths);
    EXPECT_GE(paths.size(), 25U);
    for (const Path& path : paths) {
        if (path.back() == "errorBound" || path.back() == "errorsHold") continue;  // younger than the format
        const std::string message = complaint(copyWith(json, path, nullptr));
        EXPECT_NE(message, "accepted") << join(path);
        EXPECT_NE(message.find(path.back()), std::string::npos) << message;
    }
}

TEST(DatasetMetadata, TakesTheMeasuredErrorForABoundThatIsNotThere) {
    const Json json = copyWith(toJson(fullMetadata()), {"heights", "errorBound"}, nullptr);
    EXPECT_EQ(metadataFromJson(json).value().errorBound, 0.0025);
}

TEST(DatasetMetadata, TakesErrorsForThoseOfAnOlderBuildUnlessItSaysOtherwise) {
    const Json json = toJson(fullMetadata());
    EXPECT_TRUE(metadataFromJson(json).value().errorsHoldEverywhere);
    const Json older = copyWith(json, {"heights", "errorsHold"}, nullptr);
    EXPECT_FALSE(metadataFromJson(older).value().errorsHoldEverywhere);
    const Json other("somewhere");
    EXPECT_NE(complaint(copyWith(json, {"heights", "errorsHold"}, &other)).find("errorsHold"), std::string::npos);
}

TEST(DatasetMetadata, RefusesEachFieldOfAnotherKind) {
    const Json json = toJson(fullMetadata());
    std::vector<Path> paths;
    collectPaths(json, {}, paths);
    const Json wrongKind(true);
    for (const Path& path : paths) EXPECT_NE(complaint(copyWith(json, path, &wrongKind)), "accepted") << join(path);
}

TEST(DatasetMetadata, RefusesOtherFormats) {
    const Json two(2);
    EXPECT_EQ(complaint(copyWith(toJson(fullMetadata()), {"format"}, &two)),
              "metadata: the dataset has format 2, this build reads format 1 (build the dataset again, or update this "
              "program)");
    EXPECT_NE(complaint(Json(3)), "accepted");
    EXPECT_NE(complaint(Json::Object{}), "accepted");
}

TEST(DatasetMetadata, RefusesValuesOutOfRange) {
    const Json json = toJson(fullMetadata());
    const std::pair<Path, Json> cases[] = {
        {{"grid", "finestLevel"}, Json(32)},
        {{"grid", "finestLevel"}, Json(2.5)},
        {{"grid", "finestLevel"}, Json(-1)},
        {{"grid", "columns"}, Json(0)},
        {{"grid", "columns"}, Json(4097)},  // more than 512 * 2^3
        {{"grid", "rows"}, Json(1e18)},
        {{"grid", "transform"}, Json(Json::Array{0, 1, 0, 0, 0, -2})},
        {{"grid", "transform"}, Json(Json::Array{0, 1, 0.5, 0, 0, -1})},
        {{"grid", "transform"}, Json(Json::Array{0, -1, 0, 0, 0, 1})},
        {{"grid", "transform"}, Json(Json::Array{0, 1, 0, 0, 0})},
        {{"heights", "quantum"}, Json(0)},
        {{"heights", "max"}, Json(-9999)},
        {{"heights", "unit"}, Json("foot")},
        {{"heights", "tiles"}, Json(-1)},
        {{"heights", "tiles"}, Json(1e17)},
        {{"heights", "errorBound"}, Json(-1)},
        {{"heights", "levelErrors"}, Json(Json::Array{1, 2, 3})},
        {{"heights", "levelErrors"}, Json(Json::Array{1, 2, 3, -4})},
        {{"heights", "levelErrors"}, Json(Json::Array{1, 2, 3, "x"})},
        {{"imagery", "finestLevel"}, Json(32)},
        {{"imagery", "bounds"}, Json(Json::Array{0, 1, 1, 0})},
        {{"lonLatBounds"}, Json(Json::Array{0, 1, 2})},
        {{"sources"}, Json(Json::Array{Json(1)})},
        {{"sources"}, Json(Json::Array{Json(Json::Object{{"path", Json("x")}})})},
    };
    for (const auto& [path, value] : cases)
        EXPECT_NE(complaint(copyWith(json, path, &value)), "accepted") << join(path) << " " << value.dump(0);
}

TEST(DatasetMetadata, BoundsTheGroundByItsSamples) {
    DatasetMetadata metadata;
    metadata.tiling = {.west = 100, .north = 1000, .finestSpacing = 2, .finestLevel = 1};
    metadata.samples = {600, 30};
    EXPECT_EQ(metadata.groundBounds(), (GroundRect{100, 940, 1300, 1000}));
}

}  // namespace
}  // namespace terray
