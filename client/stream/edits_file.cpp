#include "client/stream/edits_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "common/error.h"

namespace terray {
namespace {

constexpr const char* kFormat = "terray-edits";
constexpr int kVersion = 1;
constexpr double kMostMetres = 1e6;      // of a height or a depth
constexpr double kMostRadius = 1e6;      // metres
constexpr double kLeastRadius = 1e-3;    // metres
constexpr double kMostCoordinate = 1e9;  // metres, as in flights
constexpr size_t kMostPoints = 100'000;  // of all edits: each sample near a line looks at each of its segments

/// A number of an edit and where it must lie.
struct Range {
    double least;
    double most;
};

Result<double> numberIn(const Json& json, std::string_view name, Range range) {
    const auto value = json.numberAt(name);
    if (!value) return value.failure();
    if (!(*value >= range.least && *value <= range.most))
        return Failure{"\"" + std::string(name) + "\" is " + Json(*value).dump(0) + ", expected " +
                       Json(range.least).dump(0) + " to " + Json(range.most).dump(0)};
    return *value;
}

Result<double> numberOr(const Json& json, std::string_view name, double otherwise, Range range) {
    return json.find(name) == nullptr ? Result<double>(otherwise) : numberIn(json, name, range);
}

/// A sentence about the first member that is none of `known`.
std::optional<Failure> unknownMember(const Json& json, std::initializer_list<std::string_view> known) {
    for (const auto& [name, value] : json.object()) {
        if (std::ranges::find(known, name) != known.end()) continue;
        std::string expected;
        for (const std::string_view one : known) expected += (expected.empty() ? "" : ", ") + std::string(one);
        return Failure{"\"" + name + "\" is unknown, expected " + expected};
    }
    return {};
}

Result<glm::dvec2> placeFromJson(const Json& json, const Projection* projection) {
    if (!json.isObject()) return Failure{"a place is no object: expected x_m and y_m, or longitude and latitude"};
    if (json.find("longitude") == nullptr && json.find("latitude") == nullptr) {
        if (auto unknown = unknownMember(json, {"x_m", "y_m"})) return *unknown;
        const auto x = numberIn(json, "x_m", {-kMostCoordinate, kMostCoordinate});
        if (!x) return x.failure();
        const auto y = numberIn(json, "y_m", {-kMostCoordinate, kMostCoordinate});
        if (!y) return y.failure();
        return glm::dvec2(*x, *y);
    }
    if (auto unknown = unknownMember(json, {"longitude", "latitude"})) return *unknown;
    if (projection == nullptr)
        return Failure{std::string("a longitude and latitude, but ") +
                       (TERRAY_WITH_PROJ ? "the dataset has no coordinate system"
                                         : "this build cannot convert them (TERRAY_WITH_PROJ is off)") +
                       ": give x_m and y_m in its own metres"};
    const auto longitude = numberIn(json, "longitude", {-180, 180});
    if (!longitude) return longitude.failure();
    const auto latitude = numberIn(json, "latitude", {-90, 90});
    if (!latitude) return latitude.failure();
    const auto plane = projection->plane({*longitude, *latitude});
    if (!plane) return plane.failure();
    if (!(std::abs(plane->x) <= kMostCoordinate && std::abs(plane->y) <= kMostCoordinate))
        return Failure{"the dataset's coordinate system does not reach its longitude and latitude"};
    return *plane;
}

/// A value that is required, or nothing with the failure noted: so that members are read one after the other.
class Members {
  public:
    explicit Members(const Json& json) : json_(json) {}
    double number(std::string_view name, Range range) { return take(numberIn(json_, name, range)); }
    double numberOr(std::string_view name, double otherwise, Range range) {
        return take(terray::numberOr(json_, name, otherwise, range));
    }
    glm::dvec2 place(const Json& json, const Projection* projection) { return take(placeFromJson(json, projection)); }
    void fail(Failure failure) {
        if (!failure_) failure_ = std::move(failure);
    }
    [[nodiscard]] const std::optional<Failure>& failure() const { return failure_; }

  private:
    template <class Value>
    Value take(Result<Value> result) {
        if (result) return *result;
        fail(result.failure());
        return {};
    }
    const Json& json_;
    std::optional<Failure> failure_;
};

Result<TerrainEdit> craterFromJson(const Json& json, const Projection* projection) {
    if (auto unknown = unknownMember(json, {"kind", "at", "radius_m", "depth_m", "rim_m"})) return *unknown;
    const Json* at = json.find("at");
    if (at == nullptr) return Failure{"\"at\" is missing: the place of the crater's centre"};
    Members members(json);
    const glm::dvec2 centre = members.place(*at, projection);
    TerrainEdit crater{.kind = TerrainEdit::Kind::crater,
                       .line = segmentsThrough(std::span(&centre, 1)),
                       .radius = members.number("radius_m", {kLeastRadius, kMostRadius}),
                       .height = members.number("depth_m", {0, kMostMetres}),
                       .rim = members.numberOr("rim_m", 0, {0, kMostMetres})};
    if (members.failure()) return *members.failure();
    return crater;
}

Result<TerrainEdit> strokeFromJson(const Json& json, const std::string& kind, const Projection* projection) {
    const bool level = kind == "level";
    const char* height = level ? "height_m" : "amount_m";
    if (auto unknown = unknownMember(json, {"kind", "along", "radius_m", "full_m", height})) return *unknown;
    const Json* along = json.find("along");
    if (along == nullptr || !along->isArray() || along->array().empty())
        return Failure{"\"along\" is missing or empty: the places that the stroke goes through, at least one"};
    Members members(json);
    std::vector<glm::dvec2> points;
    for (const Json& place : along->array()) points.push_back(members.place(place, projection));
    TerrainEdit stroke{.kind = level ? TerrainEdit::Kind::level : TerrainEdit::Kind::raise,
                       .line = segmentsThrough(points),
                       .radius = members.number("radius_m", {kLeastRadius, kMostRadius})};
    stroke.full = members.numberOr("full_m", stroke.radius / 2, {0, kMostRadius});
    stroke.height = members.number(height, {level ? -kMostMetres : 0, kMostMetres});
    if (kind == "lower") stroke.height = -stroke.height;
    if (!members.failure() && stroke.full >= stroke.radius)
        members.fail({"\"full_m\" is " + Json(stroke.full).dump(0) + ", expected less than \"radius_m\""});
    if (members.failure()) return *members.failure();
    return stroke;
}

Result<TerrainEdit> editFromJson(const Json& json, const Projection* projection) {
    if (!json.isObject()) return Failure{"it is no object"};
    const auto kind = json.stringAt("kind");
    if (!kind) return kind.failure();
    if (*kind == "crater") return craterFromJson(json, projection);
    if (*kind == "raise" || *kind == "lower" || *kind == "level") return strokeFromJson(json, *kind, projection);
    return Failure{"\"kind\" is \"" + *kind + "\", expected crater, raise, lower or level"};
}

}  // namespace

Result<EditList> editsFromJson(const Json& json, const Projection* projection) {
    const auto format = json.stringAt("format");
    if (!format || *format != kFormat)
        return Failure{std::string("no list of edits: expected \"format\": \"") + kFormat + "\""};
    const auto version = json.numberAt("version");
    if (!version) return version.failure();
    if (*version != kVersion)
        return Failure{"edits of format version " + Json(*version).dump(0) + ", this build reads " +
                       std::to_string(kVersion)};
    const Json* items = json.find("edits");
    if (items == nullptr || !items->isArray()) return Failure{"expected \"edits\" to be an array"};

    EditList edits;
    size_t points = 0;
    for (const Json& item : items->array()) {
        auto edit = editFromJson(item, projection);
        if (!edit) return Failure{"edit " + std::to_string(edits.size() + 1) + ": " + edit.failure().message};
        points += edit->line.size();
        if (points > kMostPoints)
            return Failure{"more than " + std::to_string(kMostPoints) + " craters and parts of strokes"};
        edits.push_back(std::move(*edit));
    }
    if (!valid(edits)) return Failure{"together the edits may move ground by more than 10,000 km"};
    return edits;
}

EditList loadEdits(const std::filesystem::path& path, const Projection* projection) {
    const auto refuse = [&path](const std::string& why) {
        return Error(ExitCode::input, "cannot read edits " + path.string() + ": " + why +
                                          "; client/README.md describes and shows such a file");
    };
    std::ifstream file(path, std::ios::binary);
    if (!file) throw refuse("it cannot be opened");
    std::ostringstream text;
    text << file.rdbuf();
    if (!text) throw refuse("it is empty, or reading failed");
    const auto json = Json::parse(text.str());
    if (!json) throw refuse(json.failure().message);
    auto edits = editsFromJson(*json, projection);
    if (!edits) throw refuse(edits.failure().message);
    return std::move(*edits);
}

}  // namespace terray
