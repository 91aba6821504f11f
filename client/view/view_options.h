#pragma once

#include <optional>
#include <string>

#include "client/engine/dataset_options.h"
#include "client/engine/engine_options.h"
#include "client/stream/camera.h"
#include "client/view/arguments.h"

namespace terray {

/// The options of terray-view as they were given.
struct ViewOptions {
    DatasetCommandLine dataset;
    bool headless = false;
    std::string camera;
    int width = 1280;
    int height = 720;
    std::string vsync = "on";
    bool fullScreen = false;
    double targetFps = 0;
    std::string pictures = ".";
    std::string out;
    bool force = false;
    EngineCommandLine engine;

    /// Throws Error(usage) naming the culprit. @return false when help was asked for and printed
    [[nodiscard]] bool parse(const Arguments& arguments);
    /// The camera that was given, if one was. Throws Error(usage), or Error(georeference) as projectionOf.
    [[nodiscard]] std::optional<Camera> cameraOver(const DatasetMetadata& metadata) const;
};

}  // namespace terray
