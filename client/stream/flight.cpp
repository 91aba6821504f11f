#include "client/stream/flight.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <span>
#include <sstream>

#include "common/check.h"
#include "common/error.h"
#include "common/output_file.h"

namespace terray {
namespace {

constexpr const char* kFormat = "terray-flight";
constexpr int kVersion = 1;

/// The turn from one heading to another, the shorter way round: -pi .. pi.
double shorterTurn(Radians from, Radians to) {
    return std::remainder(to.value() - from.value(), 2 * std::numbers::pi);
}

/// What is interpolated, linear in every entry. Heading counts from a reference heading.
struct Pose {
    glm::dvec3 position{0};
    double heading = 0;
    double pitch = 0;
    double fov = 0;

    friend Pose operator+(const Pose& a, const Pose& b) {
        return {a.position + b.position, a.heading + b.heading, a.pitch + b.pitch, a.fov + b.fov};
    }
    friend Pose operator*(double factor, const Pose& a) {
        return {factor * a.position, factor * a.heading, factor * a.pitch, factor * a.fov};
    }
};

/// The pose of a key as seen from the neighbouring one whose pose is known.
Pose poseFrom(const Pose& known, const Camera& knownCamera, const Camera& camera) {
    return {camera.position, known.heading + shorterTurn(knownCamera.heading, camera.heading), camera.pitch.value(),
            camera.verticalFov.value()};
}

/// A pose and when it is reached.
struct Moment {
    double seconds;
    Pose pose;
};

/// Velocity at b of the parabola through three poses (Catmull-Rom for uneven times).
Pose velocity(const Moment& a, const Moment& b, const Moment& c) {
    const double before = b.seconds - a.seconds, after = c.seconds - b.seconds;
    const Pose arriving = 1 / before * (b.pose + -1.0 * a.pose);
    const Pose leaving = 1 / after * (c.pose + -1.0 * b.pose);
    return 1 / (before + after) * (after * arriving + before * leaving);
}

Camera cameraOf(const Pose& pose, Radians referenceHeading) {
    // A spline may overshoot its keys; these two have bounds.
    constexpr double kLeastFov = 1e-4;
    return {.position = pose.position,
            .heading = Radians(referenceHeading.value() + pose.heading),
            .pitch = Radians(std::clamp(pose.pitch, -std::numbers::pi / 2, std::numbers::pi / 2)),
            .verticalFov = Radians(std::clamp(pose.fov, kLeastFov, std::numbers::pi - kLeastFov))};
}

/// The spline from keys[segment] to the next, `share` (0..1) of the way in time.
Camera onSegment(std::span<const FlightKey> keys, size_t segment, double share) {
    const FlightKey& start = keys[segment];
    const FlightKey& end = keys[segment + 1];
    const Pose first{start.camera.position, 0, start.camera.pitch.value(), start.camera.verticalFov.value()};
    const Moment from{start.seconds, first};
    const Moment to{end.seconds, poseFrom(first, start.camera, end.camera)};
    // The camera rests before the first key and after the last, so it starts and ends with no velocity.
    Pose leaving, arriving;
    if (segment > 0) {
        const FlightKey& before = keys[segment - 1];
        leaving = velocity({before.seconds, poseFrom(from.pose, start.camera, before.camera)}, from, to);
    }
    if (segment + 2 < keys.size()) {
        const FlightKey& after = keys[segment + 2];
        arriving = velocity(from, to, {after.seconds, poseFrom(to.pose, end.camera, after.camera)});
    }
    // Cubic Hermite basis.
    const double s = share, rest = 1 - s, span = end.seconds - start.seconds;
    const Pose pose = (1 + 2 * s) * rest * rest * from.pose + s * s * (3 - 2 * s) * to.pose +
                      span * s * rest * rest * leaving + -span * s * s * rest * arriving;
    return cameraOf(pose, start.camera.heading);
}

/// Longitude, latitude and heading from true north, for people; left out where the projection has no answer.
void addGeographic(Json& json, const Camera& camera, const Projection& projection) {
    const glm::dvec2 plane(camera.position);
    const auto place = projection.lonLat(plane);
    const auto north = projection.gridHeadingOfNorth(plane);
    if (!place || !north) return;
    json.set("longitude", place->longitude);
    json.set("latitude", place->latitude);
    json.set("true_heading_deg", std::remainder(degreesFromRadians(camera.heading - *north), 360.0));
}

Json keyToJson(const FlightKey& key, const Projection* projection) {
    Json json;
    json.set("seconds", key.seconds);
    json.set("x_m", key.camera.position.x);
    json.set("y_m", key.camera.position.y);
    json.set("height_m", key.camera.position.z);
    json.set("heading_deg", degreesFromRadians(key.camera.heading));
    json.set("pitch_deg", degreesFromRadians(key.camera.pitch));
    json.set("fov_deg", degreesFromRadians(key.camera.verticalFov));
    if (projection != nullptr) addGeographic(json, key.camera, *projection);
    return json;
}

/// Degrees and radians are grids of different fineness; going there and back settles within three rounds.
Radians settled(Radians angle) {
    for (;;) {
        const Radians next = radiansFromDegrees(degreesFromRadians(angle));
        if (next == angle) return angle;
        angle = next;
    }
}

/// A number of a key and where it goes.
struct Member {
    const char* name;
    double min;
    double max;
    double value = 0;
};

Result<FlightKey> keyFromJson(const Json& json) {
    Member members[] = {
        {"seconds", 0, kMostFlightSeconds}, {"x_m", -1e9, 1e9},     {"y_m", -1e9, 1e9},     {"height_m", -1e9, 1e9},
        {"heading_deg", -1e6, 1e6},         {"pitch_deg", -90, 90}, {"fov_deg", 0.001, 179}};
    for (Member& member : members) {
        const auto value = json.numberAt(member.name);
        if (!value) return value.failure();
        if (!(*value >= member.min && *value <= member.max))
            return Failure{std::string("\"") + member.name + "\" is " + Json(*value).dump(0) + ", expected " +
                           Json(member.min).dump(0) + " to " + Json(member.max).dump(0)};
        member.value = *value;
    }
    return FlightKey{.seconds = members[0].value,
                     .camera = {.position = {members[1].value, members[2].value, members[3].value},
                                .heading = radiansFromDegrees(members[4].value),
                                .pitch = radiansFromDegrees(members[5].value),
                                .verticalFov = radiansFromDegrees(members[6].value)}};
}

}  // namespace

Camera Flight::at(double seconds) const {
    TERRAY_CHECK(!keys.empty());
    const auto next = std::upper_bound(keys.begin(), keys.end(), seconds,
                                       [](double time, const FlightKey& key) { return time < key.seconds; });
    if (next == keys.begin()) return keys.front().camera;
    if (next == keys.end()) return keys.back().camera;
    const auto previous = next - 1;
    if (seconds == previous->seconds) return previous->camera;
    const double share = (seconds - previous->seconds) / (next->seconds - previous->seconds);
    return onSegment(keys, static_cast<size_t>(previous - keys.begin()), share);
}

size_t frameCount(const Flight& flight, double framesPerSecond) {
    TERRAY_CHECK_OP(framesPerSecond, >, 0.0);
    constexpr double kSlack = 1e-6;  // of a frame: a flight of 10 s at 30 a second has its frame 300
    return static_cast<size_t>(std::floor(flight.seconds() * framesPerSecond + kSlack)) + 1;
}

Camera asWritten(const Camera& camera) {
    return {.position = camera.position,
            .heading = settled(camera.heading),
            .pitch = settled(camera.pitch),
            .verticalFov = settled(camera.verticalFov)};
}

Json toJson(const Flight& flight, const Projection* projection) {
    Json json;
    json.set("format", kFormat);
    json.set("version", kVersion);
    json.set("dataset", flight.dataset);
    json.set("name", flight.name);
    Json::Array keys;
    for (const FlightKey& key : flight.keys) keys.push_back(keyToJson(key, projection));
    json.set("keys", std::move(keys));
    return json;
}

Result<Flight> flightFromJson(const Json& json) {
    const auto format = json.stringAt("format");
    if (!format || *format != kFormat)
        return Failure{std::string("no flight: expected \"format\": \"") + kFormat + "\""};
    const auto version = json.numberAt("version");
    if (!version) return version.failure();
    if (*version != kVersion)
        return Failure{"flight of format version " + Json(*version).dump(0) + ", this build reads " +
                       std::to_string(kVersion)};
    const auto dataset = json.stringAt("dataset");
    if (!dataset) return dataset.failure();
    const auto name = json.stringAt("name");
    if (!name) return name.failure();
    const Json* keys = json.find("keys");
    if (keys == nullptr || !keys->isArray() || keys->array().empty())
        return Failure{"flight without keys: expected \"keys\" to be an array of at least one"};

    Flight flight{.dataset = *dataset, .name = *name, .keys = {}};
    for (const Json& item : keys->array()) {
        const std::string where = "key " + std::to_string(flight.keys.size()) + ": ";
        const auto key = keyFromJson(item);
        if (!key) return Failure{where + key.failure().message};
        if (!flight.keys.empty() && !(key->seconds > flight.keys.back().seconds))
            return Failure{where + "\"seconds\" must be greater than in the key before"};
        flight.keys.push_back(*key);
    }
    return flight;
}

Flight loadFlight(const std::filesystem::path& path) {
    const auto refuse = [&path](const std::string& why) {
        return Error(ExitCode::input,
                     "cannot read flight " + path.string() + ": " + why +
                         "; give a file that terray-bench tour wrote, or one as client/README.md describes");
    };
    std::ifstream file(path, std::ios::binary);
    if (!file) throw refuse("it cannot be opened");
    std::ostringstream text;
    text << file.rdbuf();
    if (!text) throw refuse("it is empty, or reading failed");
    const auto json = Json::parse(text.str());
    if (!json) throw refuse(json.failure().message);
    auto flight = flightFromJson(*json);
    if (!flight) throw refuse(flight.failure().message);
    return std::move(*flight);
}

void saveFlight(const Flight& flight, const std::filesystem::path& path, const Projection* projection) {
    const std::string text = toJson(flight, projection).dump(2) + "\n";
    writeWholeFile(path, std::as_bytes(std::span(text)));
}

}  // namespace terray
