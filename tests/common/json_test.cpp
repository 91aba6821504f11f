#include "common/json.h"

#include <bit>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/common/random.h"

namespace terray {
namespace {

std::string complaint(std::string_view text) {
    const auto result = Json::parse(text);
    return result.ok() ? "accepted" : result.failure().message;
}

Json parsed(std::string_view text) {
    auto result = Json::parse(text);
    EXPECT_TRUE(result.ok()) << complaint(text);
    return result.ok() ? *std::move(result) : Json();
}

std::string nested(int depth) {
    return std::string(depth, '[') + std::string(depth, ']');
}

TEST(Json, ReadsEveryKindOfValue) {
    const Json json = parsed(R"( {"a": [1, -2.5e3, true, false, null], "b": {"c": "d"}, "": {}, "e": []} )");
    EXPECT_EQ(json.find("a")->array()[1].number(), -2500);
    EXPECT_TRUE(json.find("a")->array()[2].boolean());
    EXPECT_TRUE(json.find("a")->array()[4].isNull());
    EXPECT_EQ(json.find("b")->find("c")->string(), "d");
    EXPECT_TRUE(json.find("")->object().empty());
    EXPECT_EQ(json.find("nothing"), nullptr);
}

TEST(Json, WritesWhatItReadsBackEqual) {
    const Json json = parsed(R"({"text": "a\"\\\n\t\u0001é😀", "n": [0, -0.5, 1e300, [true], {}], "o": {"x": null}})");
    for (const int indent : {0, 2, 4}) EXPECT_EQ(parsed(json.dump(indent)), json) << json.dump(indent);
    EXPECT_EQ(json.dump(0).find('\n'), std::string::npos);
}

TEST(Json, KeepsTheOrderOfMembersAndReplacesInPlace) {
    Json json;
    json.set("z", 1);
    json.set("a", 2);
    json.set("z", 3);
    EXPECT_EQ(json.dump(0), R"({"z":3,"a":2})");
}

TEST(Json, ReadsEscapesAndSurrogatePairs) {
    EXPECT_EQ(parsed(R"("\"\\\/\b\f\n\r\t\u0041\u00e9\u20AC\ud83d\ude00")").string(), "\"\\/\b\f\n\r\tAé€😀");
    EXPECT_EQ(parsed(R"("\u0000")").string(), std::string(1, '\0'));
    EXPECT_EQ(parsed(R"("\uDBFF\uDFFF")").string(), "\xF4\x8F\xBF\xBF");
}

TEST(Json, RefusesMalformedStrings) {
    for (const char* text :
         {R"("\ud83d")", R"("\ude00")", R"("\ud83dA")", R"("\ud83d\u0041")", R"("\u12g4")", R"("\u12)", R"("\x")",
          R"("\)", R"("open)", "\"\n\"", "\"\x80\"", "\"\xC0\xAF\"", "\"\xE0\x80\x80\"", "\"\xED\xA0\x80\"",
          "\"\xF4\x90\x80\x80\"", "\"\xF0\x82\x82\xAC\"", "\"\xE2\x82\""})
        EXPECT_NE(complaint(text), "accepted") << text;
}

TEST(Json, RefusesMalformedValues) {
    for (const char* text :
         {"",          " ",       "nul",      "tru",       "[",          "[1",    "[1,",    "[1,]",  "{",
          "{\"a\"",    "{\"a\":", "{\"a\":1", "{\"a\":1,", "{\"a\":1,}", "{a:1}", "1 2",    "[1] x", "01",
          "-",         "+1",      ".5",       "1.",        "1e",         "1e+",   "0x1",    "NaN",   "Infinity",
          "-Infinity", "1e400",   "-1e400",   "1e-400",    "'a'",        "[1 2]", "// c\n1"})
        EXPECT_NE(complaint(text), "accepted") << text;
}

TEST(Json, RefusesDuplicateNames) {
    EXPECT_EQ(complaint("{\"a\": 1,\n  \"a\": 2}"), "JSON line 2, column 3: the name \"a\" occurs twice in one object");
    EXPECT_EQ(complaint(R"([{"a": 1}, {"a": 2}])"), "accepted");
    // The same name, once by an escape.
    EXPECT_NE(complaint(R"({"a": 1, "\u0061": 2})"), "accepted");
}

TEST(Json, BoundsTheDepth) {
    EXPECT_EQ(complaint(nested(64)), "accepted");
    EXPECT_NE(complaint(nested(65)), "accepted");
    EXPECT_NE(complaint(std::string(1000000, '[')), "accepted");
    std::string objects;
    for (int i = 0; i < 65; ++i) objects += "{\"a\":";
    EXPECT_NE(complaint(objects), "accepted");
}

TEST(Json, SaysLineAndColumn) {
    EXPECT_EQ(complaint("{\n  \"a\": 1,\n  \"b\": x\n}"), "JSON line 3, column 8: expected a value");
    EXPECT_EQ(complaint("[1, 02]"), "JSON line 1, column 6: expected ',' or ']' after an element");
    EXPECT_EQ(complaint("[\n"), "JSON line 2, column 1: expected a value, found the end of the text");
}

TEST(Json, RoundTripsNumbersExactly) {
    test::Random random(7);
    for (int i = 0; i < 100000; ++i) {
        const auto number = std::bit_cast<double>(random.bits());
        if (!std::isfinite(number)) continue;
        const std::string text = Json(number).dump();
        ASSERT_EQ(std::bit_cast<uint64_t>(parsed(text).number()), std::bit_cast<uint64_t>(number)) << text;
    }
    using Limits = std::numeric_limits<double>;
    for (const double number : {0.0, -0.0, Limits::min(), Limits::denorm_min(), Limits::max(), Limits::epsilon(), 0.1})
        EXPECT_EQ(std::bit_cast<uint64_t>(parsed(Json(number).dump()).number()), std::bit_cast<uint64_t>(number));
}

TEST(Json, PrintsIntegersWithoutFraction) {
    EXPECT_EQ(Json(uint64_t{9007199254740992}).dump(), "9007199254740992");
    EXPECT_EQ(Json(-3).dump(), "-3");
    EXPECT_EQ(Json(1e15).dump(), "1000000000000000");
    EXPECT_EQ(Json(0.25).dump(), "0.25");
}

TEST(Json, WritesNumbersThatAreNotFiniteAsNull) {
    EXPECT_EQ(Json(std::nan("")).dump(), "null");
    EXPECT_EQ(Json(-HUGE_VAL).dump(), "null");
}

TEST(Json, LooksUpMembersByKind) {
    const Json json = parsed(R"({"n": 1, "s": "x", "b": true})");
    EXPECT_EQ(*json.numberAt("n"), 1);
    EXPECT_EQ(*json.stringAt("s"), "x");
    EXPECT_TRUE(*json.boolAt("b"));
    EXPECT_EQ(json.numberAt("s").failure().message, "member \"s\" is a string, expected a number");
    EXPECT_EQ(json.boolAt("missing").failure().message, "member \"missing\" is missing");
    EXPECT_FALSE(Json(3).stringAt("s").ok());
}

TEST(JsonDeathTest, StopsOnReadingAsTheWrongKind) {
    EXPECT_DEATH((void)Json(1).string(), "isString");
    EXPECT_DEATH((void)Json("a").number(), "isNumber");
}

TEST(Json, SurvivesRandomText) {
    constexpr std::string_view kLetters = "{}[]\",:0123456789.eE+-truefalsn\\ud8 \n\x80\xE2";
    test::Random random(11);
    for (int i = 0; i < 20000; ++i) {
        std::string text;
        for (uint64_t size = random.below(40); size > 0; --size) text += kLetters[random.below(kLetters.size())];
        const auto result = Json::parse(text);
        if (!result.ok()) continue;
        EXPECT_EQ(parsed(result->dump()), *result) << text;
    }
}

}  // namespace
}  // namespace terray
