#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/engine/engine.h"
#include "client/engine/overlay_options.h"
#include "common/command_line.h"
#include "common/json.h"
#include "common/units.h"

namespace terray {

/// EngineOptions as they are written on a command line: the same names and defaults in every program that draws.
class EngineCommandLine {
  public:
    /// Declares the options. This object must outlive line.parse().
    void declare(CommandLine& line);

    /// What was given, checked. @param datasetHasImagery  decides how --gpu-memory is split: half to heights and half
    /// to imagery; all of it to heights when there is no imagery or --no-imagery was given. Throws Error(usage) naming
    /// the option that is out of range.
    [[nodiscard]] EngineOptions options(bool datasetHasImagery) const;

    /// What is given as a file or in places of a dataset, put into the options of its engine: edits (loadEdits), and
    /// what stands on the edited ground (OverlayCommandLine::meshes). Throws as these do.
    void place(const TileSource& source, EngineOptions& options) const;

    /// Every option by name without its dashes, as it is in force, for manifests.
    [[nodiscard]] Json toJson() const;

    /// The directory given by --shaders; none: the sources compiled into the program.
    [[nodiscard]] ShaderLibrary shaders() const;

  private:
    [[nodiscard]] ShadingOptions shading() const;

    OverlayCommandLine overlay_;
    std::string edits_;
    double tolerance_ = SelectionOptions().tolerance.value();
    std::optional<double> lodDistance_;
    double imageryTolerance_ = SelectionOptions().imageryTolerance.value();
    bool noImagery_ = false;
    std::string sun_;
    bool sunGiven_ = false;
    std::string sunTime_;
    std::string sky_ = "gradient";
    std::string visualRange_ = "off";
    double anisotropy_ = RenderOptions().anisotropy;
    std::string photoFilter_ = "auto";
    uint64_t hostMemory_ = PagerOptions().hostBudgetBytes;
    uint64_t gpuMemory_ = EngineOptions().gpuHeightBytes + EngineOptions().gpuImageryBytes;
    uint64_t uploadBudget_ = EngineOptions().uploadBytesPerFrame;
    double uploadShare_ = EngineOptions().uploadShare;
    int64_t decodeThreads_ = 0;
    std::string prefetch_ = "on";
    std::string cancelReads_ = "on";
    std::string launch_ = "auto";
    std::string occlusion_ = "on";
    std::string surface_ = "auto";
    double exaggeration_ = EngineOptions().exaggeration;
    std::string earth_ = "auto";
    double refraction_ = EarthOptions().refraction;
    std::string method_ = "pyramid";
    std::string drawCosts_;
    std::string shadows_ = "off";
    double sunDiameter_ = 0;
    int64_t shadowRays_ = ShadowOptions().rays;
    std::string shading_ = "photo";
    std::optional<double> contourInterval_;
    std::string shaders_;
    bool signalSky_ = false;
};

/// The direction towards a sun given as "AZIMUTH,ELEVATION": degrees clockwise from grid north, and above the horizon
/// (-90 .. 90). Unit length, world frame. Throws Error(usage) on anything else.
[[nodiscard]] glm::dvec3 sunDirection(const std::string& azimuthAndElevation);

/// The visual range that "off" or a number of metres from 1000 to 300000 names; none when it is off. Pure air has 323
/// km. Throws Error(usage) on anything else.
[[nodiscard]] std::optional<Metres> visualRangeNamed(const std::string& text);

/// The filter that "auto", "hardware" or "probes" names. Throws Error(usage) on anything else.
[[nodiscard]] PhotoFilter photoFilter(const std::string& name);

/// The launch that "auto", "raster" or "compute" names. Throws Error(usage) on anything else.
[[nodiscard]] Launch launchNamed(const std::string& name);

/// The shape of the earth that "auto", "flat" or "curved" names. Throws Error(usage) on anything else.
[[nodiscard]] EarthShape earthShapeNamed(const std::string& name);

/// The mode of kShadingModes that has this name. Throws Error(usage) on anything else.
[[nodiscard]] Shading shadingNamed(const std::string& name);

/// The surface that "auto", "columns" or "bilinear" names. Throws Error(usage) on anything else.
[[nodiscard]] Surface surfaceNamed(const std::string& name);

}  // namespace terray
