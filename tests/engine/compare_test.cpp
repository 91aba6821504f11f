// terray-bench compare: which runs it takes, what it makes of their figures, when it fails.

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "client/bench/bench.h"
#include "client/bench/run_comparison.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

Json parsed(const std::string& text) {
    return Json::parse(text).value();
}

/// A run of two frames' figures, as a replay would write it.
RecordedRun run(double frameMs, double nodes) {
    return {"run", parsed(R"({"program": "terray-bench replay", "build": {"commit": "one"}, "dataset": {"path": "a",
                "contentHash": "12"}, "flight": {"path": "f.json", "crc32c": "34"},
                "protocol": {"width": 64, "height": 48, "fps": 30}, "options": {"tolerance": 1}, "started": "now"})"),
            Json::Object{{"columns", Json::Object{{"frame_ms", Json::Object{{"median", frameMs}, {"p99", 3 * frameMs}}},
                                                  {"nodes", Json::Object{{"sum", nodes}}}}}}};
}

void setIn(RecordedRun& run, const std::string& part, const std::string& member, const Json& value) {
    Json changed = *run.manifest.find(part);
    changed.set(member, value);
    run.manifest.set(part, changed);
}

std::string refusal(const std::string& limits) {
    try {
        (void)thresholdsFrom(limits);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::usage);
        return error.what();
    }
    return "";
}

TEST(RunComparison, RunsOfUnlikeProtocolAreToldApartAndWhyIsSaid) {
    const RecordedRun a = run(10, 5);
    EXPECT_TRUE(unlikenesses(a, run(20, 6)).empty()) << "figures may differ, that is the point";
    RecordedRun b = a;
    setIn(b, "protocol", "width", 128);
    EXPECT_EQ(unlikenesses(a, b), std::vector<std::string>{"protocol.width: 64, 128"});
    b = a;
    setIn(b, "protocol", "warm", true);
    EXPECT_EQ(unlikenesses(a, b), std::vector<std::string>{"protocol.warm: null, true"});
    EXPECT_EQ(unlikenesses(b, a), std::vector<std::string>{"protocol.warm: true, null"});
    b = a;
    setIn(b, "dataset", "contentHash", "13");
    setIn(b, "flight", "crc32c", "35");
    EXPECT_EQ(unlikenesses(a, b).size(), 2U);
    b = a;
    b.manifest.set("program", "terray-bench error");
    EXPECT_EQ(unlikenesses(a, b).size(), 1U);
}

TEST(RunComparison, WhereTheFilesLieAndWhenTheyWereMadeDoesNotMatter) {
    const RecordedRun a = run(10, 5);
    RecordedRun b = a;
    setIn(b, "dataset", "path", "elsewhere");
    setIn(b, "flight", "path", "other.json");
    b.manifest.set("started", "later");
    EXPECT_TRUE(unlikenesses(a, b).empty());
    EXPECT_TRUE(differences(a, b).empty());
    setIn(b, "options", "tolerance", 2);
    setIn(b, "build", "commit", "two");
    EXPECT_EQ(differences(a, b),
              (std::vector<std::string>{"build.commit: \"one\", \"two\"", "options.tolerance: 1, 2"}));
}

TEST(RunComparison, SettingsAreMatchedByNameAndMustBeTheSame) {
    const auto sweep = [](std::initializer_list<const char*> names) {
        RecordedRun a = run(1, 1);
        Json settings = Json::Array{};
        for (const char* name : names)
            settings.push(Json::Object{{"name", name}, {"columns", *a.summary.find("columns")}});
        a.summary = Json::Object{{"settings", settings}};
        return a;
    };
    EXPECT_TRUE(unlikenesses(sweep({"fine", "coarse"}), sweep({"fine", "coarse"})).empty());
    EXPECT_FALSE(unlikenesses(sweep({"fine", "coarse"}), sweep({"coarse", "fine"})).empty());
    EXPECT_FALSE(unlikenesses(sweep({"fine", "coarse"}), sweep({"fine"})).empty());
    const auto figures = figuresOf(sweep({"fine", "coarse"}), sweep({"fine", "coarse"}));
    ASSERT_EQ(figures.size(), 6U);
    EXPECT_EQ(figures[5].title(), "coarse: nodes.sum");
}

TEST(RunComparison, RatiosAreOfBOverA) {
    const auto ratio = [](std::optional<double> a, std::optional<double> b) { return Figure{"", "x.y", a, b}.ratio(); };
    EXPECT_EQ(ratio(10, 11), 1.1);
    EXPECT_EQ(ratio(0, 0), 1);
    EXPECT_TRUE(std::isinf(*ratio(0, 1)));
    EXPECT_FALSE(ratio(1, {}));
    EXPECT_FALSE(ratio({}, 1));
}

TEST(RunComparison, AFigureThatOnlyOneRunHasIsListedWithoutRatio) {
    RecordedRun b = run(10, 5);
    Json columns = *b.summary.find("columns");
    columns.set("gpu_edit_ms", Json::Object{{"median", 3}});
    b.summary.set("columns", columns);
    for (const bool inB : {true, false}) {
        const auto figures = inB ? figuresOf(run(10, 5), b) : figuresOf(b, run(10, 5));
        ASSERT_EQ(figures.size(), 4U);
        EXPECT_EQ(figures[3].name, "gpu_edit_ms.median");
        EXPECT_EQ(figures[3].a.has_value(), !inB);
        EXPECT_FALSE(figures[3].ratio());
    }
}

TEST(Thresholds, AreReadAsWritten) {
    const auto limits = thresholdsFrom("frame_ms.median>1.1x,psnr_db.mean<-0.5,see_through.sum>0");
    ASSERT_EQ(limits.size(), 3U);
    EXPECT_EQ(limits[0].figure, "frame_ms.median");
    EXPECT_TRUE(limits[0].above && limits[0].ratio);
    EXPECT_EQ(limits[0].limit, 1.1);
    EXPECT_FALSE(limits[1].above || limits[1].ratio);
    EXPECT_EQ(limits[1].limit, -0.5);
    EXPECT_TRUE(limits[2].above && !limits[2].ratio);
}

TEST(Thresholds, ThatAreBadlyFormedAreRefusedPartByPart) {
    for (const char* bad :
         {"", ",", "frame_ms.median", "frame_ms.median>", "frame_ms.median>x", ">1", "frame_ms>1x", "frame_ms.>1x",
          ".median>1x", "a.b=1", "a.b>1 x", "a.b>=1", "a.b>nan", "a.b>1x,", "a.b>inf"})
        EXPECT_NE(refusal(bad).find("--fail-if: found \""), std::string::npos) << bad;
    EXPECT_NE(refusal("a.b>1x,c.d>1y").find("\"c.d>1y\""), std::string::npos);
}

TEST(Thresholds, AreCrossedOnlyBeyondTheirLimit) {
    const auto crossed = [](const std::string& limits, double b) {
        return crossings(thresholdsFrom(limits), figuresOf(run(10, 0), run(b, 0)));
    };
    EXPECT_TRUE(crossed("frame_ms.median>1.1x", 11).empty()) << "the limit itself is allowed";
    EXPECT_EQ(crossed("frame_ms.median>1.1x", 11.5),
              std::vector<std::string>{"frame_ms.median is 1.15 times RUN_A's, allowed is at most 1.1"});
    EXPECT_EQ(crossed("frame_ms.median<12", 11.5).size(), 1U);
    EXPECT_TRUE(crossed("frame_ms.median<11.5", 11.5).empty());
    EXPECT_EQ(crossed("frame_ms.median>1.1x,frame_ms.p99>1.1x,nodes.sum>0", 20).size(), 2U);
}

TEST(Thresholds, ThatCannotBeJudgedAreErrors) {
    RecordedRun without = run(1, 1);
    without.summary = Json::Object{{"columns", Json::Object{{"nodes", Json::Object{{"sum", 1}}}}}};
    EXPECT_THROW((void)crossings(thresholdsFrom("frame_ms.mean>1x"), figuresOf(run(1, 1), run(1, 1))), Error);
    EXPECT_THROW((void)crossings(thresholdsFrom("frame_ms.median>1x"), figuresOf(run(1, 1), without)), Error);
}

class CompareTest : public testing::Test {
  protected:
    static ExitCode bench(const std::vector<std::string>& arguments, std::string* said = nullptr) {
        try {
            testing::internal::CaptureStdout();
            const ExitCode code = runBench(arguments);
            const std::string out = testing::internal::GetCapturedStdout();
            if (said != nullptr) *said = out;
            return code;
        } catch (const Error& error) {
            (void)testing::internal::GetCapturedStdout();
            if (said != nullptr) *said = error.what();
            return error.code();
        }
    }
    [[nodiscard]] std::string in(const std::string& name) const { return (directory_ / name).string(); }

    test::TemporaryDirectory directory_;
};

TEST_F(CompareTest, JudgesRunsThatReplayWrote) {
    std::filesystem::create_directory(directory_ / "dataset");
    AnalyticDataset({.finestLevel = 1}).write(directory_ / "dataset");
    ASSERT_EQ(bench({"tour", in("dataset"), "--seconds", "1", "--out", in("tour.json")}), ExitCode::ok);
    const auto fly = [&](const std::string& name, const std::string& size, const std::string& tolerance) {
        ASSERT_EQ(bench({"replay", in("dataset"), "--flight", in("tour.json"), "--size", size, "--fps", "2",
                         "--wait-for-tiles", "--tolerance", tolerance, "--launch", "compute", "--out", in(name)}),
                  ExitCode::ok);
    };
    fly("fine", "64x48", "0.01");
    fly("coarse", "64x48", "50");
    fly("small", "32x48", "50");
    std::string said;
    EXPECT_EQ(bench({"compare", in("fine"), in("coarse"), "--fail-if", "nodes.sum>1x,rays_out_of_steps.sum>0"}, &said),
              ExitCode::ok)
        << said;
    EXPECT_NE(said.find("differs: options.tolerance: 0.01, 50"), std::string::npos) << said;
    EXPECT_EQ(bench({"compare", in("coarse"), in("fine"), "--fail-if", "nodes.sum>1x"}, &said), ExitCode::threshold);
    EXPECT_NE(said.find("crossed: nodes.sum is "), std::string::npos) << said;
    EXPECT_EQ(bench({"compare", in("coarse"), in("small")}, &said), ExitCode::usage);
    EXPECT_NE(said.find("protocol.width: 64, 32"), std::string::npos) << said;
    EXPECT_EQ(bench({"compare", in("coarse"), in("fine"), "--fail-if", "colour.sum>1x"}, &said), ExitCode::usage);
    EXPECT_EQ(bench({"compare", in("coarse"), in("fine"), "--fail-if", "nodes.sum>1x", "--json"}, &said),
              ExitCode::threshold);
    EXPECT_EQ(parsed(said).find("crossed")->array().size(), 1U);
}

TEST_F(CompareTest, WhatIsNoRunIsRefused) {
    std::string said;
    EXPECT_EQ(bench({"compare", in("a"), in("b")}, &said), ExitCode::input);
    EXPECT_NE(said.find("manifest.json"), std::string::npos) << said;
    std::filesystem::create_directory(directory_ / "a");
    std::ofstream(directory_ / "a" / "manifest.json") << "[]";
    EXPECT_EQ(bench({"compare", in("a"), in("a")}, &said), ExitCode::input);
    EXPECT_NE(said.find("no JSON object"), std::string::npos) << said;
}

}  // namespace
}  // namespace terray
