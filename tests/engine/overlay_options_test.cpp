// Tracks, pins and cubes from the command line to meshes in a dataset's world.

#include <fstream>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "client/engine/dataset_camera.h"
#include "client/engine/engine_options.h"
#include "client/engine/program.h"
#include "common/error.h"
#include "tests/common/temporary_directory.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

/// The analytic dataset, placed into a coordinate system.
class PlacedDataset final : public TileSource {
  public:
    explicit PlacedDataset(const std::string& crs) : metadata_(dataset_.metadata()) {
        metadata_.crsWkt = metadata_.crsName = crs;
    }
    [[nodiscard]] const DatasetMetadata& metadata() const override { return metadata_; }
    [[nodiscard]] Result<Bytes> read(TileLayer layer, const TileId& id) const override {
        return dataset_.read(layer, id);
    }
    [[nodiscard]] std::string contentHash() const override { return dataset_.contentHash(); }
    [[nodiscard]] uint64_t reads() const { return dataset_.reads(); }
    [[nodiscard]] glm::dvec2 centre() const {
        const GroundRect ground = metadata_.groundBounds();
        return {(ground.west + ground.east) / 2, (ground.south + ground.north) / 2};
    }

  private:
    AnalyticDataset dataset_{{.finestLevel = 1}};
    DatasetMetadata metadata_;
};

std::vector<OverlayMesh> meshesOf(const TileSource& source, const std::vector<std::string>& arguments) {
    EngineCommandLine options;
    CommandLine line("test", "");
    options.declare(line);
    EXPECT_TRUE(line.parse(arguments));
    EngineOptions drawn;
    options.place(source, drawn);
    return drawn.overlay;
}

ExitCode refusal(const TileSource& source, const std::vector<std::string>& arguments) {
    try {
        (void)meshesOf(source, arguments);
    } catch (const Error& error) {
        return error.code();
    }
    return ExitCode::ok;
}

std::string placeText(double x, double y) {
    char text[64];
    std::snprintf(text, sizeof(text), "%.9f,%.9f", x, y);
    return text;
}

/// A file with one edit that levels the ground around a place to 4321 m.
std::string levellingFile(const test::TemporaryDirectory& directory, glm::dvec2 place) {
    const std::filesystem::path path = directory / "edits.json";
    std::ofstream(path)
        << R"({"format":"terray-edits","version":1,"edits":[{"kind":"level","radius_m":50,"height_m":4321,"along":[{"x_m":)"
        << std::to_string(place.x) << R"(,"y_m":)" << std::to_string(place.y) << "}]}]}";
    return path.string();
}

TEST(EditOptions, PinsStandOnEditedGround) {
    const PlacedDataset dataset("");
    const test::TemporaryDirectory directory;
    const std::string file = levellingFile(directory, dataset.centre());
    const std::string text = placeText(dataset.centre().x, dataset.centre().y);
    EXPECT_EQ(meshesOf(dataset, {"--edits", file, "--marker", text}).at(0).origin.z, 4321);
}

TEST(EditOptions, AFileThatCannotBeReadIsRefusedAsInput) {
    const PlacedDataset dataset("");
    const test::TemporaryDirectory directory;
    EXPECT_EQ(refusal(dataset, {"--edits", (directory / "none.json").string()}), ExitCode::input);
    EXPECT_EQ(refusal(dataset, {"--edits", levellingFile(directory, {0, 0})}), ExitCode::ok);
    EXPECT_EQ(dataset.reads(), 0u) << "edits alone need no ground";
}

TEST(OverlayOptions, NothingGivenReadsNothingAndMakesNothing) {
    const PlacedDataset dataset("no such coordinate system");
    EXPECT_TRUE(meshesOf(dataset, {}).empty());
    EXPECT_EQ(dataset.reads(), 0u);
}

TEST(OverlayOptions, PinsAndCubesStandWhereTheyAreTold) {
    const PlacedDataset dataset("");  // x and y
    const glm::dvec2 place = dataset.centre();
    const std::string text = placeText(place.x, place.y);
    const auto meshes = meshesOf(dataset, {"--marker", text, text + ",1234.5", "--cube", text + ",700,40"});
    ASSERT_EQ(meshes.size(), 3u);
    EXPECT_NEAR(meshes[0].origin.z, AnalyticDataset::heightAt(place.x, place.y), 4 * AnalyticDataset::kSteepest)
        << "on the ground, that of a sample within its spacing";
    EXPECT_EQ(meshes[1].origin, glm::dvec3(place, 1234.5));
    EXPECT_GT(meshes[1].leastPixels, 0);
    EXPECT_EQ(meshes[2].origin, glm::dvec3(place, 700));
    EXPECT_EQ(meshes[2].leastPixels, 0);
    EXPECT_EQ(meshes[2].size, 40);
}

TEST(OverlayOptions, AbsurdOnesAreRefused) {
    const PlacedDataset dataset("");
    const std::string inside = placeText(dataset.centre().x, dataset.centre().y);
    for (const std::string text : {"", "1", "1,2,3,4", "1,north", "1,2,", "nan,2", "1e9,2"})
        EXPECT_EQ(refusal(dataset, {"--marker", text}), ExitCode::usage) << text;
    for (const std::string text : {"1,2,3", "1,2,3,4,5", "1,2,3,x"})
        EXPECT_EQ(refusal(dataset, {"--cube", text}), ExitCode::usage) << text;
    EXPECT_EQ(refusal(dataset, {"--cube", inside + ",3,0"}), ExitCode::usage);
    EXPECT_EQ(refusal(dataset, {"--cube", inside + ",3,-5"}), ExitCode::usage);
    for (const std::string radius : {"0", "-1", "1e6"})
        EXPECT_EQ(refusal(dataset, {"--track-radius", radius}), ExitCode::usage) << radius;
    EXPECT_EQ(refusal(dataset, {"--marker", "0,0"}), ExitCode::georeference) << "no ground there";
    EXPECT_EQ(refusal(dataset, {"--marker", "0,0,100"}), ExitCode::ok) << "a height is enough";
}

TEST(OverlayOptions, ATrackNeedsACoordinateSystem) {
    const test::TemporaryDirectory folder;
    std::ofstream(folder / "a.igc") << "AXXX\nB1012304612345N00712345EA0123401256\n";
    EXPECT_EQ(refusal(PlacedDataset(""), {"--track", (folder / "a.igc").string()}),
              TERRAY_WITH_PROJ ? ExitCode::georeference : ExitCode::unsupported);
    EXPECT_EQ(refusal(PlacedDataset("EPSG:32632"), {"--track", (folder / "missing.igc").string()}),
              TERRAY_WITH_PROJ ? ExitCode::input : ExitCode::unsupported);
}

TEST(OverlayOptions, AreAllInTheManifest) {
    EngineCommandLine options;
    CommandLine line("test", "");
    options.declare(line);
    EXPECT_TRUE(line.parse({"--track", "a", "b", "--track", "c", "--track-radius", "3", "--marker", "1,2"}));
    const Json all = options.toJson();
    ASSERT_NE(all.find("overlay"), nullptr);
    EXPECT_EQ(all.find("overlay")->dump(0), Json(Json::Object{{"track", Json::Array{"a", "b", "c"}},
                                                              {"track-radius", 3.0},
                                                              {"marker", Json::Array{"1,2"}},
                                                              {"cube", Json::Array{}}})
                                                .dump(0));
}

#if TERRAY_WITH_PROJ

TEST(OverlayOptions, TracksArePlacedByTheDatasetsCoordinateSystem) {
    const PlacedDataset dataset("EPSG:32632");
    const Projection projection = *projectionOf(dataset.metadata());
    const LonLat from = projection.lonLat(dataset.centre()).value();
    const LonLat to = projection.lonLat(dataset.centre() + glm::dvec2(300, 200)).value();
    // IGC holds thousandths of minutes of arc: 1.9 m.
    const auto minutes = [](double degrees) { return std::lround(std::abs(degrees) * 60'000); };
    const auto fix = [&](LonLat place, int height) {
        char text[64];
        std::snprintf(text, sizeof(text), "B101230%02ld%05ld%c%03ld%05ld%cA00000%05d\n",
                      minutes(place.latitude) / 60'000, minutes(place.latitude) % 60'000,
                      place.latitude < 0 ? 'S' : 'N', minutes(place.longitude) / 60'000,
                      minutes(place.longitude) % 60'000, place.longitude < 0 ? 'W' : 'E', height);
        return std::string(text);
    };
    const test::TemporaryDirectory folder;
    std::ofstream(folder / "a.igc") << "AXXX\n" << fix(from, 900) << fix(to, 1000);
    const auto meshes = meshesOf(dataset, {"--track", (folder / "a.igc").string(), "--track-radius", "3"});
    ASSERT_EQ(meshes.size(), 1u);
    EXPECT_EQ(meshes[0].size, 3);
    EXPECT_GT(meshes[0].leastPixels, 0);
    const auto ends = {meshes[0].vertices.front(), meshes[0].vertices.back()};
    const glm::dvec3 expected[] = {{dataset.centre(), 900}, {dataset.centre() + glm::dvec2(300, 200), 1000}};
    size_t i = 0;
    for (const OverlayVertex& end : ends)
        EXPECT_LT(glm::distance(meshes[0].origin + glm::dvec3(end.anchor), expected[i++]), 2) << i;
}

TEST(OverlayOptions, LongitudesAndLatitudesOutOfRangeAreRefused) {
    const PlacedDataset dataset("EPSG:32632");
    EXPECT_EQ(refusal(dataset, {"--marker", "181,0,5"}), ExitCode::usage);
    EXPECT_EQ(refusal(dataset, {"--marker", "9,91,5"}), ExitCode::usage);
    EXPECT_EQ(refusal(dataset, {"--marker", "9,45,5"}), ExitCode::ok);
}

#endif

}  // namespace
}  // namespace terray
