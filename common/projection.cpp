// The only door to PROJ.
#include "common/projection.h"

#include <utility>

#if TERRAY_WITH_PROJ
#include <array>
#include <cmath>
#include <cstdio>

#include <proj.h>
#endif

#include "common/check.h"

namespace terray {

#if TERRAY_WITH_PROJ

struct Projection::State {
    State() { proj_log_func(context, this, &State::log); }
    ~State() {
        proj_destroy(transform);
        proj_context_destroy(context);
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    /// Keeps what PROJ would print on standard error.
    static void log(void* self, int level, const char* message) {
        if (level == PJ_LOG_ERROR) static_cast<State*>(self)->lastMessage = message;
    }
    /// What the last call complained about.
    [[nodiscard]] std::string reason() const {
        if (!lastMessage.empty()) return lastMessage;
        const int number = proj_context_errno(context);
        return number != 0 ? proj_context_errno_string(context, number) : "PROJ gives no reason";
    }
    [[nodiscard]] Result<PJ_COORD> run(PJ_DIRECTION direction, double x, double y, const char* what) {
        lastMessage.clear();
        proj_errno_reset(transform);
        const PJ_COORD result = proj_trans(transform, direction, proj_coord(x, y, 0, HUGE_VAL));
        if (proj_errno(transform) == 0 && std::isfinite(result.xy.x) && std::isfinite(result.xy.y)) return result;
        std::array<char, 64> place{};
        std::snprintf(place.data(), place.size(), "%.9g, %.9g", x, y);
        return Failure{"cannot convert " + std::string(place.data()) + " to " + what + ": " + reason()};
    }

    PJ_CONTEXT* context = proj_context_create();
    PJ* transform = nullptr;  ///< forward: plane to longitude and latitude in degrees, in that order
    std::string lastMessage;
};

Result<Projection> Projection::create(const std::string& crs) {
    auto state = std::make_unique<State>();
    const auto failed = [&] {
        const std::string shown = crs.size() > 60 ? crs.substr(0, 60) + "..." : crs;
        return Failure{"cannot convert between \"" + shown + "\" and WGS 84: " + state->reason()};
    };
    PJ* const found = proj_create_crs_to_crs(state->context, crs.c_str(), "EPSG:4326", nullptr);
    if (found == nullptr) return failed();
    // East before north, whatever order the definitions of the two systems ask for.
    state->transform = proj_normalize_for_visualization(state->context, found);
    proj_destroy(found);
    if (state->transform == nullptr) return failed();
    return Projection(std::move(state));
}

Result<LonLat> Projection::lonLat(glm::dvec2 plane) const {
    const auto result = state_->run(PJ_FWD, plane.x, plane.y, "longitude and latitude");
    if (!result.ok()) return result.failure();
    return LonLat{.longitude = result->xy.x, .latitude = result->xy.y};
}

Result<glm::dvec2> Projection::plane(LonLat place) const {
    const auto result = state_->run(PJ_INV, place.longitude, place.latitude, "plane coordinates");
    if (!result.ok()) return result.failure();
    return glm::dvec2(result->xy.x, result->xy.y);
}

Result<Radians> Projection::gridHeadingOfNorth(glm::dvec2 plane) const {
    const auto here = lonLat(plane);
    if (!here.ok()) return here.failure();
    // One step north; at the pole, where there is no north, one step south and turned round.
    constexpr double kStepDegrees = 1e-6;
    const double step = here->latitude + kStepDegrees <= 90 ? kStepDegrees : -kStepDegrees;
    const auto from = this->plane(*here);
    const auto to = this->plane({.longitude = here->longitude, .latitude = here->latitude + step});
    if (!from.ok()) return from.failure();
    if (!to.ok()) return to.failure();
    const glm::dvec2 north = step > 0 ? *to - *from : *from - *to;
    return Radians(std::atan2(north.x, north.y));
}

Result<glm::dmat2> Projection::groundFromPlane(glm::dvec2 plane) const {
    constexpr double kHalf = 10;  // metres
    const auto here = lonLat(plane);
    if (!here.ok()) return here.failure();
    glm::dmat2 ground;
    for (int axis = 0; axis < 2; ++axis) {
        const glm::dvec2 step = axis == 0 ? glm::dvec2(kHalf, 0) : glm::dvec2(0, kHalf);
        const auto before = lonLat(plane - step);
        const auto after = lonLat(plane + step);
        if (!before.ok()) return before.failure();
        if (!after.ok()) return after.failure();
        ground[axis] = (geodesicOffset(*here, *after) - geodesicOffset(*here, *before)) / (2 * kHalf);
    }
    return ground;
}

#else

struct Projection::State {};

namespace {

const Failure kWithoutProj{"this build has no map projections (configured with TERRAY_WITH_PROJ=OFF)"};

}  // namespace

Result<Projection> Projection::create(const std::string&) {
    return kWithoutProj;
}
Result<LonLat> Projection::lonLat(glm::dvec2) const {
    return kWithoutProj;
}
Result<glm::dvec2> Projection::plane(LonLat) const {
    return kWithoutProj;
}
Result<Radians> Projection::gridHeadingOfNorth(glm::dvec2) const {
    return kWithoutProj;
}
Result<glm::dmat2> Projection::groundFromPlane(glm::dvec2) const {
    return kWithoutProj;
}

#endif

Projection::Projection(std::unique_ptr<State> state) : state_(std::move(state)) {
    TERRAY_CHECK(state_ != nullptr);
}
Projection::Projection(Projection&&) noexcept = default;
Projection& Projection::operator=(Projection&&) noexcept = default;
Projection::~Projection() = default;

}  // namespace terray
