// A picture that is drawn in parts is the picture that is drawn in one piece.

#include <algorithm>

#include <gtest/gtest.h>

#include "client/engine/engine.h"
#include "client/overlay/shapes.h"
#include "client/render/gl_context.h"
#include "common/rgba.h"
#include "tests/support/analytic_dataset.h"

namespace terray {
namespace {

constexpr int kWidth = 230;  // none of the parts below divides it
constexpr int kHeight = 170;
using Picture = Grid<Rgba>;

const Camera kCamera{.position = {402000, 5195500, 900}, .heading = Radians(0.4), .pitch = radiansFromDegrees(-9)};

int64_t differingPixels(const Picture& a, const Picture& b) {
    int64_t pixels = 0;
    for (size_t n = 0; n < a.cells().size(); ++n) pixels += a.cells()[n] != b.cells()[n] ? 1 : 0;
    return pixels;
}

class PictureParts : public testing::Test {
  protected:
    void TearDown() override { EXPECT_EQ(context_.takeDebugMessages(), ""); }

    Picture whole(const EngineOptions& options) {
        Engine engine(dataset_, shaders_, options, kWidth, kHeight);
        EXPECT_EQ(engine.drawFrame(camera_, true).wanted, 0u);
        return engine.targets().readSrgb();
    }
    /// Drawn from the lower right part to the upper left one: the order must not matter.
    Picture inParts(const EngineOptions& options, int columns, int rows) {
        Engine engine(dataset_, shaders_, options, 64, 48);
        Picture picture({kWidth, kHeight});
        for (int part = columns * rows - 1; part >= 0; --part) {
            const int column = part % columns, row = part / columns;
            const auto edge = [&](int n, int count, int pixels) { return n == count ? pixels : pixels * n / count; };
            const int left = edge(column, columns, kWidth), right = edge(column + 1, columns, kWidth);
            const int bottom = edge(row, rows, kHeight), top = edge(row + 1, rows, kHeight);  // from below
            const GridRect rect{left, kHeight - top, right - left, top - bottom};
            engine.resizeToPart(kWidth, kHeight, rect);
            const FrameReport report = engine.drawFrame(camera_, true);
            EXPECT_EQ(report.wanted, 0u);
            EXPECT_EQ(report.coarsening, Coarsening());
            const Picture drawn = engine.targets().readSrgb();
            EXPECT_EQ(drawn.size(), (GridSize{rect.width, rect.height}));
            for (int64_t y = 0; y < rect.height; ++y)
                std::ranges::copy(drawn.view().row(y), picture.view().row(rect.y + y).begin() + rect.x);
        }
        return picture;
    }
    void expectTheSame(const EngineOptions& options, const char* what) {
        const Picture expected = whole(options);
        EXPECT_EQ(differingPixels(inParts(options, 2, 2), expected), 0) << what << ", 2 x 2";
        EXPECT_EQ(differingPixels(inParts(options, 3, 2), expected), 0) << what << ", 3 x 2";
    }

    HeadlessContext context_{{.debug = true}};
    ShaderLibrary shaders_;
    AnalyticDataset dataset_{{.imageryLevel = 3}};
    Camera camera_ = kCamera;
};

EngineOptions with(Launch launch) {
    EngineOptions options;
    options.render.launch = launch;
    return options;
}

TEST_F(PictureParts, AreTheWholeByteByByteByBothLaunches) {
    for (const Launch launch : {Launch::raster, Launch::compute}) expectTheSame(with(launch), name(launch).data());
}

TEST_F(PictureParts, AgreeAboutShadowsSkyAndAir) {
    for (const Launch launch : {Launch::raster, Launch::compute}) {
        EngineOptions options = with(launch);
        options.render.shadows = ShadowOptions();
        options.render.sunDirection = {-0.9, 0.3, 0.25};
        expectTheSame(options, "shadows");
        options.render.sky = true;
        options.render.visualRange = Metres(20000);
        expectTheSame(options, "shadows, sky and air");
    }
}

TEST_F(PictureParts, AgreeAboutFilteredPhotosAndCurvedExaggeratedGround) {
    EngineOptions options = with(Launch::raster);
    options.render.photoFilter = PhotoFilter::probes;
    expectTheSame(options, "probes");
    options.earth.shape = EarthShape::curved;
    options.exaggeration = 1.7;
    for (const Surface surface : {Surface::columns, Surface::bilinear, Surface::automatic}) {
        options.render.surface = surface;
        expectTheSame(options, "curved and exaggerated");
    }
}

TEST_F(PictureParts, AgreeAboutShadingModesThatMeasureThePicture) {
    EngineOptions options = with(Launch::raster);
    for (const Shading shading : {Shading::level, Shading::contours, Shading::grid, Shading::error, Shading::sobel}) {
        options.render.shading.mode = shading;
        expectTheSame(options, "shading");
    }
}

TEST_F(PictureParts, AgreeWhereTheCameraLooksStraightDownOrTheEyeIsWithinABox) {
    camera_.pitch = radiansFromDegrees(-90);
    expectTheSame(with(Launch::raster), "down");
    camera_.position.z = AnalyticDataset::heightAt(camera_.position.x, camera_.position.y) + 2;
    camera_.pitch = Radians(0.05);
    for (const Launch launch : {Launch::raster, Launch::compute}) expectTheSame(with(launch), "near the ground");
}

TEST_F(PictureParts, AgreeAboutThingsPutIntoThePicture) {
    EngineOptions options = with(Launch::raster);
    std::vector<glm::dvec3> line;
    for (int n = 0; n < 20; ++n)
        line.push_back(kCamera.position + glm::dvec3(60.0 * n - 400, 200.0 * n + 300, -20 + 40 * (n % 3)));
    options.overlay = {tubeMesh({{line}}, {.radius = 5, .leastPixels = 2.5}),
                       pinMesh(kCamera.position + glm::dvec3(300, 900, -150), 80, glm::vec3(1, 0, 0))};
    expectTheSame(options, "a tube and a pin");
}

TEST_F(PictureParts, AgreeByEveryMethodOfRays) {
    for (const Method method : {Method::march, Method::linear, Method::hull, Method::cones}) {
        EngineOptions options = with(Launch::raster);
        options.render.method.method = method;
        EXPECT_EQ(differingPixels(inParts(options, 3, 2), whole(options)), 0) << entryOf(method).name;
    }
}

TEST_F(PictureParts, OfTriangulatedGroundDifferWhereATriangleEndsAtAPixelsCentre) {
    EngineOptions options = with(Launch::raster);
    options.render.method.method = Method::mesh;
    EXPECT_LE(differingPixels(inParts(options, 3, 2), whole(options)), 4) << "of 39100; measured: 2";
}

}  // namespace
}  // namespace terray
