#pragma once

#include <optional>
#include <string>

#include <glm/vec2.hpp>

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
    int partWidth = 0;  ///< 0: not given
    int partHeight = 0;
    EngineCommandLine engine;

    /// Throws Error(usage) naming the culprit. @return false when help was asked for and printed
    [[nodiscard]] bool parse(const Arguments& arguments);
    /// The largest part of a picture that is drawn at a time, if it was given.
    [[nodiscard]] std::optional<glm::ivec2> partSize() const;
    /// The camera that was given, if one was. Throws Error(usage), or Error(georeference) as projectionOf.
    [[nodiscard]] std::optional<Camera> cameraOver(const DatasetMetadata& metadata) const;
};

}  // namespace terray
