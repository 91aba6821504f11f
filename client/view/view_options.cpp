#include "client/view/view_options.h"

#include "client/engine/dataset_camera.h"
#include "common/command_line.h"
#include "common/error.h"

namespace terray {

bool ViewOptions::parse(const Arguments& arguments) {
    CommandLine line("terray-view",
                     "Flies over a dataset in a window (F1 there tells the keys), or with --headless draws one picture "
                     "of it, when all of its tiles are loaded. --reproduce FILE.json takes the options of a picture "
                     "that the window made.");
    dataset.declare(line);
    line.flag("--headless", headless, "draw one picture without a window, into --out");
    line.option("--camera", camera, "LON,LAT,HEIGHT,HEADING,PITCH[,FOV]",
                "degrees and metres; X,Y instead of LON,LAT where the dataset has no coordinate system or this build "
                "no PROJ (an overview of the whole dataset)");
    line.size("--size", width, height, "of the picture or the window, in pixels (1280x720)");
    line.option("--vsync", vsync, "on|off", "whether frames wait for the screen (on)");
    line.flag("--full-screen", fullScreen, "the window fills the screen");
    line.option("--target-fps", targetFps, "RATE",
                "a window gives up pixels, then tiles, while the camera moves and frames come more slowly; 0: never "
                "(0)");
    line.option("--pictures", pictures, "DIR", "where pictures and flights of the window go (.)");
    line.option("--out", out, "FILE.png|FILE.exr", "where the picture goes");
    line.size("--part-size", partWidth, partHeight,
              "largest part of a PNG (the window's too) that is drawn at a time: GPU memory is that of a part (all of "
              "it up to 4 million "
              "pixels, 2048x512 of larger ones)");
    line.flag("--force", force, "replace an existing picture");
    engine.declare(line);
    if (!line.parse(arguments)) return false;
    if (vsync != "on" && vsync != "off")
        throw Error(ExitCode::usage, "--vsync: found \"" + vsync + "\", expected on or off");
    if (!(targetFps >= 0 && targetFps <= 1000))
        throw Error(ExitCode::usage, "--target-fps: found " + numberText(targetFps) + ", expected 0 to 1000");
    return true;
}

std::optional<glm::ivec2> ViewOptions::partSize() const {
    if (partWidth == 0) return {};
    return glm::ivec2(partWidth, partHeight);
}

std::optional<Camera> ViewOptions::cameraOver(const DatasetMetadata& metadata) const {
    const std::optional<Projection> projection = projectionOf(metadata);
    if (camera.empty()) return {};
    Result<Camera> found = parseCamera(camera, projection ? &*projection : nullptr);
    if (!found) throw Error(ExitCode::usage, "--camera: " + found.failure().message);
    return *found;
}

}  // namespace terray
