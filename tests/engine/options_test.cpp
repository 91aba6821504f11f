#include <cmath>
#include <sstream>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/engine/engine_options.h"
#include "client/engine/program.h"
#include "common/error.h"

namespace terray {
namespace {

EngineOptions parsed(const std::vector<std::string>& arguments, bool datasetHasImagery = true) {
    EngineCommandLine options;
    CommandLine line("test", "");
    options.declare(line);
    EXPECT_TRUE(line.parse(arguments));
    return options.options(datasetHasImagery);
}

ExitCode refusal(const std::vector<std::string>& arguments) {
    try {
        (void)parsed(arguments);
    } catch (const Error& error) {
        return error.code();
    }
    return ExitCode::ok;
}

TEST(EngineOptions, TheManifestHoldsEveryOne) {
    EngineCommandLine options;
    CommandLine line("test", "");
    options.declare(line);
    const Json manifest = options.toJson();
    std::istringstream help(line.help());
    int found = 0;
    for (std::string word; help >> word;) {
        if (!word.starts_with("--") || word == "--help") continue;
        const std::string name = word.substr(2);
        const bool held = manifest.find(name) != nullptr || manifest.find("overlay")->find(name) != nullptr;
        EXPECT_TRUE(held) << word;
        ++found;
    }
    EXPECT_GT(found, 20);
}

TEST(EngineOptions, DefaultsAreThoseOfTheLibrary) {
    const EngineOptions options = parsed({});
    const EngineOptions library;
    EXPECT_EQ(options.selection.tolerance, library.selection.tolerance);
    EXPECT_EQ(options.selection.imageryTolerance, library.selection.imageryTolerance);
    EXPECT_EQ(options.gpuHeightBytes, library.gpuHeightBytes);
    EXPECT_EQ(options.gpuImageryBytes, library.gpuImageryBytes);
    EXPECT_EQ(options.uploadBytesPerFrame, library.uploadBytesPerFrame);
    EXPECT_EQ(options.pager.hostBudgetBytes, library.pager.hostBudgetBytes);
    EXPECT_EQ(options.render.anisotropy, library.render.anisotropy);
    EXPECT_TRUE(options.render.occlusion);
    EXPECT_EQ(options.exaggeration, 1);
    EXPECT_EQ(options.render.photoFilter, PhotoFilter::automatic);
    // The default sun is printed with one decimal of a degree.
    const glm::dvec3 sun = glm::normalize(library.render.sunDirection);
    EXPECT_NEAR(glm::length(options.render.sunDirection - sun), 0, 0.002);
}

TEST(EngineOptions, TheEarthHasTheShapeThatIsAskedFor) {
    EXPECT_EQ(parsed({}).earth.shape, EarthShape::automatic);
    EXPECT_EQ(parsed({}).earth.refraction, 0.13);
    EXPECT_EQ(parsed({"--earth", "flat"}).earth.shape, EarthShape::flat);
    const EarthOptions curved = parsed({"--earth", "curved", "--refraction", "-0.5"}).earth;
    EXPECT_EQ(curved.shape, EarthShape::curved);
    EXPECT_EQ(curved.refraction, -0.5);
    EXPECT_EQ(refusal({"--earth", "round"}), ExitCode::usage);
    EXPECT_EQ(refusal({"--refraction", "1"}), ExitCode::usage);
    EXPECT_EQ(refusal({"--refraction", "-6"}), ExitCode::usage);
}

TEST(EngineOptions, MemoryGoesToHeightsWhenThereIsNoPhoto) {
    EXPECT_EQ(parsed({"--gpu-memory", "100M"}).gpuHeightBytes, 50ull << 20);
    EXPECT_EQ(parsed({"--gpu-memory", "100M"}).gpuImageryBytes, 50ull << 20);
    for (const EngineOptions& options :
         {parsed({"--gpu-memory", "100M"}, false), parsed({"--gpu-memory", "100M", "--no-imagery"})}) {
        EXPECT_EQ(options.gpuHeightBytes, 100ull << 20);
        EXPECT_EQ(options.gpuImageryBytes, 0u);
        EXPECT_FALSE(options.selection.useImagery);
    }
}

TEST(EngineOptions, TheSunStandsWhereItIsPut) {
    const auto expectNear = [](const glm::dvec3& found, const glm::dvec3& expected) {
        EXPECT_NEAR(glm::length(found - expected), 0, 1e-12);
    };
    expectNear(sunDirection("0,0"), {0, 1, 0});
    expectNear(sunDirection("90,0"), {1, 0, 0});
    expectNear(sunDirection("180,30"), {0, -std::sqrt(0.75), 0.5});
    expectNear(sunDirection("-90,-45"), {-std::sqrt(0.5), 0, -std::sqrt(0.5)});
    expectNear(sunDirection("12,90"), {0, 0, 1});
}

TEST(EngineOptions, TheSunHasOnePlace) {
    const EngineOptions options = parsed({"--sun-time", "2026-06-21T14:00+02:00"});
    ASSERT_TRUE(options.sunTime.has_value());
    EXPECT_EQ(*options.sunTime, parseUtcTime("2026-06-21T12:00Z").value());
    EXPECT_FALSE(parsed({"--sun", "10,20"}).sunTime.has_value());
    EXPECT_EQ(refusal({"--sun", "10,20", "--sun-time", "2026-06-21T12:00Z"}), ExitCode::usage);
}

TEST(EngineOptions, SkyAndAirAreOffUnlessAskedFor) {
    EXPECT_FALSE(parsed({}).render.sky);
    EXPECT_FALSE(parsed({}).render.visualRange.has_value());
    EXPECT_TRUE(parsed({"--sky", "physical"}).render.sky);
    EXPECT_FALSE(parsed({"--sky", "gradient"}).render.sky);
    EXPECT_EQ(parsed({"--visual-range", "80000"}).render.visualRange, Metres(80000));
    EXPECT_EQ(parsed({"--visual-range", "1e5"}).render.visualRange, Metres(100000));
    EXPECT_FALSE(parsed({"--visual-range", "off"}).render.visualRange.has_value());
}

TEST(EngineOptions, EveryMethodHasItsName) {
    EXPECT_EQ(parsed({}).render.method, MethodOptions());
    for (const MethodEntry& entry : kMethods)
        EXPECT_EQ(parsed({"--method", std::string(entry.name)}).render.method, MethodOptions{.method = entry.method});
    EXPECT_EQ(refusal({"--method", "magic"}), ExitCode::usage);
    EXPECT_EQ(refusal({"--method", ""}), ExitCode::usage);
}

TEST(EngineOptions, AMethodsNumbersAreSetBehindItsName) {
    const MethodOptions linear = parsed({"--method", "linear:least=8,most=32"}).render.method;
    EXPECT_EQ(linear, (MethodOptions{.method = Method::linear, .least = 8, .most = 32}));
    EXPECT_EQ(description(linear), "linear:least=8,most=32");
    EXPECT_EQ(description(MethodOptions()), "pyramid");
    for (const MethodKey& key : kMethodKeys) {
        const std::string name(entryOf(key.method).name), start = name + ":" + std::string(key.key) + "=";
        const double value = key.kind == MethodKey::Kind::powerOfTwo ? 2 * MethodOptions().*key.value
                             : key.highest == 1                      ? 1
                                                                     : MethodOptions().*key.value + 1;
        EXPECT_EQ(parsed({"--method", start + Json(value).dump()}).render.method.*key.value, value) << start;
        for (const std::string& wrong : {start, start + "-1", start + "x", start + "1e9", name + ":", name + ":x=1"})
            EXPECT_EQ(refusal({"--method", wrong}), ExitCode::usage) << wrong;
    }
    EXPECT_EQ(refusal({"--method", "pyramid:least=8"}), ExitCode::usage);
    EXPECT_EQ(refusal({"--method", "linear:least=64,most=32"}), ExitCode::usage);
    EXPECT_EQ(refusal({"--method", "linear:halvings=1.5"}), ExitCode::usage);
    EXPECT_EQ(refusal({"--method", "hull:quads=48"}), ExitCode::usage);
    EXPECT_EQ(refusal({"--method", "hull", "--launch", "compute"}), ExitCode::usage) << "it rasterises";
}

TEST(EngineOptions, EveryShadingModeHasItsName) {
    EXPECT_EQ(parsed({}).render.shading.mode, Shading::photo);
    for (const ShadingMode& mode : kShadingModes)
        EXPECT_EQ(parsed({"--shading", std::string(mode.name), "--shadows", "on"}).render.shading.mode, mode.shading);
}

TEST(EngineOptions, ContoursHaveTheIntervalThatIsAskedFor) {
    EXPECT_EQ(parsed({"--shading", "contours"}).render.shading.contourInterval, Metres(0)) << "the dataset decides";
    EXPECT_EQ(parsed({"--shading", "contours", "--contour-interval", "7.5"}).render.shading.contourInterval,
              Metres(7.5));
    EXPECT_EQ(refusal({"--shading", "contours", "--contour-interval", "0"}), ExitCode::usage);
    EXPECT_EQ(refusal({"--shading", "height", "--contour-interval", "5"}), ExitCode::usage);
}

TEST(EngineOptions, MemoryGoesToHeightsWhereAModeShowsNoPhoto) {
    EXPECT_EQ(parsed({"--gpu-memory", "100M", "--shading", "height"}).gpuHeightBytes, 100ull << 20);
    EXPECT_EQ(parsed({"--gpu-memory", "100M", "--shading", "residency"}).gpuHeightBytes, 50ull << 20);
}

TEST(EngineOptions, OutOfRangeIsAUsageError) {
    for (const auto& arguments : std::vector<std::vector<std::string>>{{"--tolerance", "0"},
                                                                       {"--tolerance", "-1"},
                                                                       {"--imagery-tolerance", "0"},
                                                                       {"--anisotropy", "17"},
                                                                       {"--decode-threads", "-1"},
                                                                       {"--occlusion", "maybe"},
                                                                       {"--exaggeration", "0"},
                                                                       {"--exaggeration", "-2"},
                                                                       {"--exaggeration", "101"},
                                                                       {"--photo-filter", "none"},
                                                                       {"--sun", "10"},
                                                                       {"--sun", "10,91"},
                                                                       {"--sun", "10,20,30"},
                                                                       {"--sun", "north,20"},
                                                                       {"--sun-time", "noon"},
                                                                       {"--sun-time", "2026-06-21T12:00"},
                                                                       {"--sky", "blue"},
                                                                       {"--visual-range", "999"},
                                                                       {"--visual-range", "300001"},
                                                                       {"--visual-range", "far"},
                                                                       {"--shading", "pretty"},
                                                                       {"--shading", "shadow-steps"},
                                                                       {"--contour-interval", "50"},
                                                                       {"--host-memory", "much"}})
        EXPECT_EQ(refusal(arguments), ExitCode::usage) << arguments[0] << " " << arguments[1];
}

TEST(Program, ExitsWithTheCodeOfTheError) {
    char name[] = "test";
    char* arguments[] = {name, nullptr};
    const auto exitCode = [&](const std::function<ExitCode(const std::vector<std::string>&)>& body) {
        return runProgram("test", 1, arguments, body);
    };
    EXPECT_EQ(exitCode([](const auto&) { return ExitCode::ok; }), 0);
    EXPECT_EQ(exitCode([](const auto&) -> ExitCode { throw Error(ExitCode::dataset, "damaged"); }), 5);
    EXPECT_EQ(exitCode([](const auto&) -> ExitCode { throw std::runtime_error("unforeseen"); }), 1);
}

}  // namespace
}  // namespace terray
