#include "client/stream/edits_file.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/common/temporary_directory.h"

namespace terray::test {
namespace {

constexpr const char* kHead = R"({"format":"terray-edits","version":1,"edits":[)";

Result<EditList> read(const std::string& edits, const Projection* projection = nullptr) {
    const auto json = Json::parse(kHead + edits + "]}");
    EXPECT_TRUE(json.ok()) << json.failure().message;
    return editsFromJson(*json, projection);
}

TEST(EditsFile, ReadsEveryKindInOrder) {
    const auto edits = read(R"(
        {"kind":"crater","at":{"x_m":10,"y_m":-20},"radius_m":30,"depth_m":4,"rim_m":1},
        {"kind":"crater","at":{"x_m":1,"y_m":2},"radius_m":3,"depth_m":4},
        {"kind":"raise","along":[{"x_m":0,"y_m":0}],"radius_m":8,"amount_m":5},
        {"kind":"lower","along":[{"x_m":0,"y_m":0},{"x_m":1,"y_m":0}],"radius_m":8,"full_m":0,"amount_m":5},
        {"kind":"level","along":[{"x_m":0,"y_m":0},{"x_m":1,"y_m":0},{"x_m":1,"y_m":1}],"radius_m":8,"full_m":7,"height_m":-3})");
    ASSERT_TRUE(edits.ok()) << edits.failure().message;
    using Kind = TerrainEdit::Kind;
    const EditList expected = {
        {.kind = Kind::crater, .line = {{{10, -20}, {10, -20}}}, .radius = 30, .height = 4, .rim = 1},
        {.kind = Kind::crater, .line = {{{1, 2}, {1, 2}}}, .radius = 3, .height = 4},
        {.kind = Kind::raise, .line = {{{0, 0}, {0, 0}}}, .radius = 8, .full = 4, .height = 5},
        {.kind = Kind::raise, .line = {{{0, 0}, {1, 0}}}, .radius = 8, .full = 0, .height = -5},
        {.kind = Kind::level, .line = {{{0, 0}, {1, 0}}, {{1, 0}, {1, 1}}}, .radius = 8, .full = 7, .height = -3}};
    EXPECT_EQ(*edits, expected);
    EXPECT_TRUE(read("").value().empty());
}

#if TERRAY_WITH_PROJ
TEST(EditsFile, ReadsLongitudeAndLatitudeWhereThereIsAProjection) {
    const Projection projection = Projection::create("EPSG:32632").value();
    const auto edits =
        read(R"({"kind":"crater","at":{"longitude":9,"latitude":0},"radius_m":30,"depth_m":4})", &projection);
    ASSERT_TRUE(edits.ok()) << edits.failure().message;
    EXPECT_NEAR(edits->at(0).line[0].from.x, 500000, 1e-3) << "on the zone's meridian";
    EXPECT_NEAR(edits->at(0).line[0].from.y, 0, 1e-3) << "on the equator";
}
#endif

TEST(EditsFile, RefusesWhatItDoesNotKnowAndNamesIt) {
    const auto why = [](const std::string& edit) {
        const auto edits = read(R"({"kind":"crater","at":{"x_m":1,"y_m":2},"radius_m":3,"depth_m":4},)" + edit);
        return edits.ok() ? std::string() : edits.failure().message;
    };
    const auto expectNamed = [&](const std::string& edit, const std::string& named) {
        const std::string message = why(edit);
        EXPECT_EQ(message.substr(0, 8), "edit 2: ") << edit;
        EXPECT_NE(message.find(named), std::string::npos) << edit << " gave " << message;
    };
    expectNamed("7", "object");
    expectNamed("{}", "kind");
    expectNamed(R"({"kind":"dig"})", "dig");
    expectNamed(R"({"kind":"crater","radius_m":3,"depth_m":4})", "at");
    expectNamed(R"({"kind":"crater","at":{"x_m":1,"y_m":2},"radius_m":3,"depth_m":4,"rim":1})", "\"rim\"");
    expectNamed(R"({"kind":"crater","at":{"x_m":1},"radius_m":3,"depth_m":4})", "y_m");
    expectNamed(R"({"kind":"crater","at":{"x_m":1,"y_m":"2"},"radius_m":3,"depth_m":4})", "y_m");
    expectNamed(R"({"kind":"crater","at":[1,2],"radius_m":3,"depth_m":4})", "place");
    expectNamed(R"({"kind":"crater","at":{"x_m":1,"latitude":2},"radius_m":3,"depth_m":4})", "x_m");
    expectNamed(R"({"kind":"crater","at":{"longitude":1,"latitude":2},"radius_m":3,"depth_m":4})", "x_m and y_m");
    expectNamed(R"({"kind":"crater","at":{"x_m":1,"y_m":2},"radius_m":0,"depth_m":4})", "radius_m");
    expectNamed(R"({"kind":"crater","at":{"x_m":1,"y_m":2},"radius_m":3,"depth_m":-4})", "depth_m");
    expectNamed(R"({"kind":"crater","at":{"x_m":1,"y_m":2},"radius_m":3})", "depth_m");
    expectNamed(R"({"kind":"raise","along":[],"radius_m":3,"amount_m":1})", "along");
    expectNamed(R"({"kind":"raise","along":[{"x_m":1,"y_m":2}],"radius_m":3,"full_m":3,"amount_m":1})", "full_m");
    expectNamed(R"({"kind":"raise","along":[{"x_m":1,"y_m":2}],"radius_m":3,"height_m":1})", "height_m");
    expectNamed(R"({"kind":"level","along":[{"x_m":1,"y_m":2}],"radius_m":3})", "height_m");
    expectNamed(R"({"kind":"level","along":[{"x_m":1,"y_m":2}],"radius_m":3,"height_m":1e7})", "height_m");
}

TEST(EditsFile, RefusesOtherFilesAndLists) {
    const auto why = [](const std::string& text) {
        const auto edits = editsFromJson(*Json::parse(text), nullptr);
        return edits.ok() ? std::string() : edits.failure().message;
    };
    EXPECT_NE(why("{}").find("terray-edits"), std::string::npos);
    EXPECT_NE(why(R"({"format":"terray-edits","version":2,"edits":[]})").find("version 2"), std::string::npos);
    EXPECT_NE(why(R"({"format":"terray-edits","version":1,"edits":{}})").find("array"), std::string::npos);
    std::string deep;
    for (int i = 0; i < 11; ++i)
        deep +=
            std::string(i > 0 ? "," : "") + R"({"kind":"crater","at":{"x_m":1,"y_m":2},"radius_m":3,"depth_m":1e6})";
    EXPECT_NE(why(kHead + deep + "]}").find("together"), std::string::npos);
    std::string place = R"({"x_m":1,"y_m":2})", stroke = place;
    for (int i = 0; i < 100'001; ++i) stroke += "," + place;
    EXPECT_NE(why(kHead + (R"({"kind":"raise","radius_m":3,"amount_m":1,"along":[)" + stroke) + "]}]}").find("100000"),
              std::string::npos);

    const TemporaryDirectory directory;
    const auto codeOf = [&](const std::string& name) {
        try {
            (void)loadEdits(directory / name, nullptr);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
            return error.code();
        }
        return ExitCode::ok;
    };
    EXPECT_EQ(codeOf("none.json"), ExitCode::input);
    std::ofstream(directory / "cut.json") << kHead;
    EXPECT_EQ(codeOf("cut.json"), ExitCode::input);
    std::ofstream(directory / "good.json") << kHead << "]}";
    EXPECT_EQ(codeOf("good.json"), ExitCode::ok);
}

}  // namespace
}  // namespace terray::test
