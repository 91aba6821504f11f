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
    [[nodiscard]] ErrorSetting& last() { return settings_.back(); }
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
    const auto add = [&](const std::string& text) {
        const MethodOptions method = methodNamed(text);
        sweep.add(std::string(entryOf(method.method).name), text,
                  [&](EngineOptions& options) { options.render.method = method; });
    };
    for (const MethodEntry& entry : kMethods) add(std::string(entry.name));
    for (const int samples : {8, 16, 32, 64, 256})
        add("linear:least=" + std::to_string(samples) + ",most=" + std::to_string(4 * samples));
    for (const char* numbers : {"quads=16", "quads=64", "quads=128", "quads=256,stride=1.6,steps=10,more=20",
                                "quads=64,stride=0.4,steps=40,more=160", "exponential=1,steps=10"})
        add("hull:" + std::string(numbers));
    for (const char* numbers : {"blocks=64", "blocks=128,reach=32", "steps=32", "steps=512"})
        add("cones:" + std::string(numbers));
    for (const char* error : {"0.1", "0.25", "1", "2", "4"}) add("mesh:error=" + std::string(error));
}

void sweepPhoto(Sweep& sweep) {
    for (const double tolerance : {0.5, 1.0, 2.0, 4.0, 8.0})
        sweep.add("photo", "photo " + Json(tolerance).dump() + " px",
                  [&](EngineOptions& options) { options.selection.imageryTolerance = Pixels(tolerance); });
}

void sweepQuantum(Sweep& sweep, double stored) {
    const auto finest = [](EngineOptions& options) {
        options.render.surface = Surface::bilinear;
        options.selection.tolerance = Pixels(0.25);
    };
    sweep.add("quantum", "quantum as stored", finest);
    for (const double quantum : {0.05, 0.2, 1.0, 2.0, 5.0, 10.0}) {
        if (quantum <= stored) continue;
        sweep.add("quantum", "quantum " + Json(quantum).dump() + " m", finest);
        sweep.last().quantum = quantum;
    }
}

struct NamedSweep {
    const char* name;
    void (*add)(Sweep& sweep, double storedQuantum);
};
constexpr NamedSweep kSweeps[] = {{"tolerance", [](Sweep& sweep, double) { sweepTolerance(sweep); }},
                                  {"surface", [](Sweep& sweep, double) { sweepSurface(sweep); }},
                                  {"launch", [](Sweep& sweep, double) { sweepLaunch(sweep); }},
                                  {"anisotropy", [](Sweep& sweep, double) { sweepAnisotropy(sweep); }},
                                  {"photo", [](Sweep& sweep, double) { sweepPhoto(sweep); }},
                                  {"method", [](Sweep& sweep, double) { sweepMethod(sweep); }},
                                  {"quantum", sweepQuantum}};

}  // namespace

std::vector<ErrorSetting> settingsOf(const std::string& name, const EngineOptions& base, double storedQuantum) {
    Sweep sweep(base);
    if (name.empty()) {
        sweep.add("as given", "as given", [](EngineOptions&) {});
        return sweep.take();
    }
    for (const NamedSweep& known : kSweeps) {
        if (name != known.name) continue;
        known.add(sweep, storedQuantum);
        return sweep.take();
    }
    throw Error(ExitCode::usage, "--sweep: found \"" + name + "\", expected one of " + sweepNames());
}

std::string sweepNames() {
    std::string names;
    for (const NamedSweep& sweep : kSweeps) names += (names.empty() ? "" : "|") + std::string(sweep.name);
    return names;
}

}  // namespace terray
