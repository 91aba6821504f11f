#include "client/navigation/bookmarks.h"

#include <fstream>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/common/temporary_directory.h"

namespace terray::test {
namespace {

Bookmarks some() {
    Bookmarks bookmarks;
    bookmarks.cameras[0] =
        Camera{.position = {412345.6, 4212345.4, 3210.9}, .heading = Radians(1), .pitch = Radians(-0.5)};
    bookmarks.cameras[8] = Camera{.position = {1, 2, 3}};
    return bookmarks;
}

TEST(Bookmarks, ComeBackFromTheirFile) {
    const TemporaryDirectory folder;
    const auto path = folder / "new" / "bookmarks.json";
    EXPECT_EQ(loadBookmarks(path), Bookmarks());
    saveBookmarks(some(), path, nullptr);
    const Bookmarks back = loadBookmarks(path);
    for (size_t n = 0; n < back.cameras.size(); ++n) {
        ASSERT_EQ(back.cameras[n].has_value(), some().cameras[n].has_value());
        if (!back.cameras[n]) continue;
        EXPECT_LT(glm::distance(back.cameras[n]->position, some().cameras[n]->position), 1e-3);
        EXPECT_NEAR(back.cameras[n]->pitch.value(), some().cameras[n]->pitch.value(), 1e-8);
    }
}

TEST(Bookmarks, RefuseWhatTheyAreNot) {
    const auto fails = [](const std::string& text) { return !bookmarksFromJson(Json::parse(text).value()).ok(); };
    const std::string head = R"({"format": "terray-bookmarks", "version": 1, "bookmarks": )";
    EXPECT_FALSE(fails(head + "[]}"));
    EXPECT_TRUE(fails("[]"));
    EXPECT_TRUE(fails(R"({"format": "terray-flight", "version": 1, "bookmarks": []})"));
    EXPECT_TRUE(fails(R"({"format": "terray-bookmarks", "version": 2, "bookmarks": []})"));
    EXPECT_TRUE(fails(head + R"([{"number": 10, "camera": "0,0,0,0,0"}]})"));
    EXPECT_TRUE(fails(head + R"([{"number": 1}]})"));
    EXPECT_TRUE(fails(head + R"([{"number": 1, "camera": "here"}]})"));

    const TemporaryDirectory folder;
    std::ofstream(folder / "bookmarks.json") << "not JSON";
    EXPECT_THROW((void)loadBookmarks(folder / "bookmarks.json"), Error);
}

}  // namespace
}  // namespace terray::test
