#include "client/bench/error_settings.h"

#include <functional>

#include "common/error.h"
#include "common/json.h"

namespace terray {
namespace {

struct NamedSurface {
    const char* name;
    Surface surface;
};
constexpr NamedSurface kSurfaces[] = {
    {"auto", Surface::automatic}, {"columns", Surface::columns}, {"bilinear", Surface::bilinear}};

/// Collects settings, each a change of the base.
class Sweep {
  public:
    explicit Sweep(const EngineOptions& base) : base_(base) {}
    void add(const std::string& curve, const std::string& name, const std::function<void(EngineOptions&)>& change) {
        settings_.push_back({curve, name, base_});
        change(settings_.back().options);
    }
    [[nodiscard]] std::vector<ErrorSetting> take() { return std::move(settings_); }

  private:
    EngineOptions base_;
    std::vector<ErrorSetting> settings_;
};

void sweepTolerance(Sweep& sweep) {
    for (const NamedSurface& surface : kSurfaces)
        for (const double tolerance : {0.25, 0.5, 1.0, 2.0, 4.0, 8.0})
            sweep.add(surface.name, std::string(surface.name) + " " + Json(tolerance).dump() + " px",
                      [&](EngineOptions& options) {
                          options.render.surface = surface.surface;
                          options.selection.tolerance = Pixels(tolerance);
                      });
}

void sweepSurface(Sweep& sweep) {
    for (const NamedSurface& surface : kSurfaces)
        sweep.add(surface.name, surface.name,
                  [&](EngineOptions& options) { options.render.surface = surface.surface; });
}

void sweepLaunch(Sweep& sweep) {
    for (const Launch launch : {Launch::raster, Launch::compute})
        sweep.add(std::string(name(launch)), std::string(name(launch)),
                  [&](EngineOptions& options) { options.render.launch = launch; });
}

void sweepAnisotropy(Sweep& sweep) {
    for (const int ratio : {1, 2, 4, 8, 16})
        sweep.add("anisotropy", "anisotropy " + std::to_string(ratio),
                  [&](EngineOptions& options) { options.render.anisotropy = static_cast<float>(ratio); });
}

void sweepMethod(Sweep& sweep) {
    for (const MethodEntry& entry : kMethods)
        sweep.add(std::string(entry.name), std::string(entry.name),
                  [&](EngineOptions& options) { options.render.method = entry.method; });
}

}  // namespace

std::vector<ErrorSetting> settingsOf(const std::string& name, const EngineOptions& base) {
    Sweep sweep(base);
    if (name.empty()) {
        sweep.add("as given", "as given", [](EngineOptions&) {});
    } else if (name == "tolerance") {
        sweepTolerance(sweep);
    } else if (name == "surface") {
        sweepSurface(sweep);
    } else if (name == "launch") {
        sweepLaunch(sweep);
    } else if (name == "anisotropy") {
        sweepAnisotropy(sweep);
    } else if (name == "method") {
        sweepMethod(sweep);
    } else {
        throw Error(ExitCode::usage,
                    "--sweep: found \"" + name + "\", expected tolerance, surface, launch, anisotropy or method");
    }
    return sweep.take();
}

}  // namespace terray
