#include "client/stream/camera.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include <glm/geometric.hpp>

#include "common/check.h"

namespace terray {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// The same direction in [0, 2 pi).
Radians normalised(Radians heading) {
    const double turned = std::fmod(heading.value(), kTurn);
    return Radians(turned < 0 ? turned + kTurn : turned);
}

/// One number of a camera's text: what it is called and what it may be.
struct Field {
    const char* name;
    double min;
    double max;
    const char* range;  ///< the same for people
};

// Heights and plane coordinates are bounded only against slips of the pen; 1e8 m is beyond any map of the earth.
constexpr Field kLongitude{"longitude", -180, 180, "-180 to 180 degrees"};
constexpr Field kLatitude{"latitude", -90, 90, "-90 to 90 degrees"};
constexpr Field kX{"x", -1e8, 1e8, "-1e8 to 1e8 metres"};
constexpr Field kY{"y", -1e8, 1e8, "-1e8 to 1e8 metres"};
constexpr Field kHeight{"height", -1e8, 1e8, "-1e8 to 1e8 metres"};
constexpr Field kHeading{"heading", -360, 360, "-360 to 360 degrees"};
constexpr Field kPitch{"pitch", -90, 90, "-90 to 90 degrees"};
constexpr Field kFov{"field of view", 0.001, 179, "0.001 to 179 degrees"};

std::vector<std::string_view> splitAtCommas(std::string_view text) {
    std::vector<std::string_view> parts;
    for (size_t start = 0;;) {
        const size_t comma = text.find(',', start);
        parts.push_back(text.substr(start, comma - start));
        if (comma == std::string_view::npos) return parts;
        start = comma + 1;
    }
}

std::string_view withoutBlanks(std::string_view text) {
    const size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

Result<double> parseField(std::string_view text, const Field& field) {
    const std::string_view digits = withoutBlanks(text);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value))
        return Failure{std::string("camera: ") + field.name + " is \"" + std::string(text) + "\", expected a number"};
    if (value < field.min || value > field.max)
        return Failure{std::string("camera: ") + field.name + " is " + std::string(digits) + ", expected " +
                       field.range};
    return value;
}

void append(std::string& text, double value, int decimals) {
    std::array<char, 400> digits{};  // the longest fixed double has 309 digits before the point
    const auto [end, error] =
        std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals);
    TERRAY_CHECK(error == std::errc());
    if (!text.empty()) text += ',';
    text.append(digits.data(), end);
}

Camera cameraIn(glm::dvec2 plane, Radians north, const GeographicCamera& camera) {
    return {.position = {plane, camera.height},
            .heading = normalised(radiansFromDegrees(camera.heading) + north),
            .pitch = radiansFromDegrees(camera.pitch),
            .verticalFov = radiansFromDegrees(camera.fov)};
}

}  // namespace

View viewOf(const Camera& camera, int width, int height) {
    TERRAY_CHECK_OP(width, >, 0);
    TERRAY_CHECK_OP(height, >, 0);
    const double sinHeading = std::sin(camera.heading.value()), cosHeading = std::cos(camera.heading.value());
    const double sinPitch = std::sin(camera.pitch.value()), cosPitch = std::cos(camera.pitch.value());
    const glm::dvec3 ahead(sinHeading, cosHeading, 0), zenith(0, 0, 1);
    return {
        .eye = camera.position,
        .right = {cosHeading, -sinHeading, 0},
        .up = cosPitch * zenith - sinPitch * ahead,
        .forward = cosPitch * ahead + sinPitch * zenith,
        .tanHalfHeight = std::tan(camera.verticalFov.value() / 2),
        .width = width,
        .height = height,
    };
}

Camera framing(Camera camera, const glm::dvec3& low, const glm::dvec3& high, double aspect, double share) {
    const View view = viewOf(camera, 1, 1);
    const double tanHalfWidth = view.tanHalfHeight * aspect;
    const glm::dvec3 centre = (low + high) / 2.0;
    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 place(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
        const glm::dvec3 fromCentre = place - centre;
        const double across = std::abs(glm::dot(fromCentre, view.right)) / tanHalfWidth;
        const double along = std::abs(glm::dot(fromCentre, view.up)) / view.tanHalfHeight;
        distance = std::max(distance, std::max(across, along) / share - glm::dot(fromCentre, view.forward));
    }
    camera.position = centre - distance * view.forward;
    return camera;
}

Result<Camera> cameraFrom(const GeographicCamera& camera, const Projection& projection) {
    const auto plane = projection.plane(camera.place);
    if (!plane) return plane.failure();
    const auto north = projection.gridHeadingOfNorth(*plane);
    if (!north) return north.failure();
    return cameraIn(*plane, *north, camera);
}

Result<GeographicCamera> geographicCamera(const Camera& camera, const Projection& projection) {
    const glm::dvec2 plane(camera.position);
    const auto place = projection.lonLat(plane);
    if (!place) return Failure{"cannot tell longitude and latitude: " + place.failure().message};
    const auto north = projection.gridHeadingOfNorth(plane);
    if (!north) return Failure{"cannot tell where north is: " + north.failure().message};
    return GeographicCamera{.place = *place,
                            .height = camera.position.z,
                            .heading = degreesFromRadians(normalised(camera.heading - *north)),
                            .pitch = degreesFromRadians(camera.pitch),
                            .fov = degreesFromRadians(camera.verticalFov)};
}

Result<Camera> parseCamera(const std::string& text, const Projection* projection) {
    const auto parts = splitAtCommas(text);
    if (parts.size() != 5 && parts.size() != 6)
        return Failure{"camera: found " + std::to_string(parts.size()) + " numbers in \"" + text + "\", expected " +
                       (projection ? "lon,lat,height_m,heading_deg,pitch_deg[,fov_deg]"
                                   : "x_m,y_m,height_m,heading_deg,pitch_deg[,fov_deg]")};
    const std::array<Field, 6> fields{
        projection ? kLongitude : kX, projection ? kLatitude : kY, kHeight, kHeading, kPitch, kFov};
    std::array<double, 6> values{0, 0, 0, 0, 0, degreesFromRadians(Camera().verticalFov)};
    for (size_t i = 0; i < parts.size(); ++i) {
        const auto value = parseField(parts[i], fields[i]);
        if (!value) return value.failure();
        values[i] = *value;
    }
    const GeographicCamera given{.place = {values[0], values[1]},
                                 .height = values[2],
                                 .heading = values[3],
                                 .pitch = values[4],
                                 .fov = values[5]};
    if (!projection) return cameraIn({values[0], values[1]}, Radians(0), given);
    auto camera = cameraFrom(given, *projection);
    if (!camera) return Failure{"camera: cannot place \"" + text + "\": " + camera.failure().message};
    return camera;
}

Result<std::string> formatCamera(const Camera& camera, const Projection* projection) {
    GeographicCamera told{.place = {camera.position.x, camera.position.y},
                          .height = camera.position.z,
                          .heading = degreesFromRadians(normalised(camera.heading)),
                          .pitch = degreesFromRadians(camera.pitch),
                          .fov = degreesFromRadians(camera.verticalFov)};
    if (projection) {
        const auto geographic = geographicCamera(camera, *projection);
        if (!geographic) return Failure{"camera: " + geographic.failure().message};
        told = *geographic;
    }
    const int decimals = projection ? 9 : 4;  // 1e-9 degrees are 0.1 mm on the ground
    std::string text;
    append(text, told.place.longitude, decimals);
    append(text, told.place.latitude, decimals);
    append(text, told.height, 4);
    append(text, told.heading, 8);
    append(text, told.pitch, 8);
    append(text, told.fov, 8);
    return text;
}

}  // namespace terray
