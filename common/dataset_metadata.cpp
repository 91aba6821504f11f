#include "common/dataset_metadata.h"

#include <cmath>
#include <utility>

namespace terray {
namespace {

constexpr const char* kEverywhere = "everywhere";
constexpr const char* kAtSamples = "at samples";
constexpr double kExactIntegers = 9007199254740992.0;  // 2^53: JSON numbers are doubles

Json toJson(const std::optional<GroundRect>& rect) {
    if (!rect) return {};
    return Json::Array{rect->west, rect->south, rect->east, rect->north};
}

/// Reads members of nested objects and keeps the first complaint, with the path of the member that caused it.
class FieldReader {
  public:
    explicit FieldReader(const Json& object) : object_(&object) {}

    [[nodiscard]] const std::optional<Failure>& failure() const { return failure_; }
    /// Notes a complaint about a member unless the condition holds.
    void require(bool condition, const std::string& name, const std::string& expected) {
        if (!condition && !failure_) failure_ = Failure{"metadata: \"" + path_ + name + "\" must be " + expected};
    }

    double number(const std::string& name) { return take(object_->numberAt(name)); }
    double numberAbove(const std::string& name, double bound) {
        const double value = number(name);
        require(value > bound, name, "above " + Json(bound).dump());
        return value;
    }
    /// A whole number from least to most, both exact in a double.
    double whole(const std::string& name, double least, double most) {
        const double value = number(name);
        const bool fits = value == std::trunc(value) && value >= least && value <= most;
        require(fits, name, "a whole number from " + Json(least).dump() + " to " + Json(most).dump());
        return fits ? value : least;
    }
    uint64_t count(const std::string& name) { return static_cast<uint64_t>(whole(name, 0, kExactIntegers)); }
    uint32_t level(const std::string& name) { return static_cast<uint32_t>(whole(name, 0, kMaxTileLevel)); }
    std::string string(const std::string& name) { return take(object_->stringAt(name)); }

    /// An array of numbers; `size` of them unless that is 0.
    std::vector<double> numbers(const std::string& name, size_t size) {
        std::vector<double> values;
        for (const Json& item : array(name)) {
            require(item.isNumber(), name, "an array of numbers");
            values.push_back(item.isNumber() ? item.number() : 0);
        }
        require(size == 0 || values.size() == size, name, "an array of " + std::to_string(size) + " numbers");
        values.resize(size == 0 ? values.size() : size);
        return values;
    }
    const Json::Array& array(const std::string& name) {
        static const Json::Array kNone;
        const Json* found = object_->find(name);
        require(found != nullptr && found->isArray(), name, "an array");
        return found != nullptr && found->isArray() ? found->array() : kNone;
    }
    /// West, south, east, north, or null.
    std::optional<GroundRect> rect(const std::string& name) {
        if (isNull(name)) return {};
        const auto values = numbers(name, 4);
        require(values[1] <= values[3], name, "west, south, east, north with south below north");
        return GroundRect{values[0], values[1], values[2], values[3]};
    }
    [[nodiscard]] bool has(const std::string& name) const { return object_->find(name) != nullptr; }
    /// Whether the member is there and null.
    [[nodiscard]] bool isNull(const std::string& name) const {
        const Json* found = object_->find(name);
        return found != nullptr && found->isNull();
    }
    /// Reads the members of a member object.
    template <class Read>
    void within(const std::string& name, Read read) {
        const Json* found = object_->find(name);
        require(found != nullptr && found->isObject(), name, "an object");
        if (found != nullptr) descend(*found, path_ + name + ".", read);
    }
    /// Reads the members of each object in an array.
    template <class Read>
    void forEach(const std::string& name, Read read) {
        const Json::Array& items = array(name);
        for (size_t i = 0; i < items.size(); ++i)
            descend(items[i], path_ + name + "[" + std::to_string(i) + "].", read);
    }

  private:
    template <class T>
    T take(const Result<T>& result) {
        if (result.ok()) return *result;
        if (!failure_) failure_ = Failure{"metadata: " + (path_.empty() ? "" : path_ + " ") + result.failure().message};
        return T{};
    }
    template <class Read>
    void descend(const Json& object, std::string path, Read read) {
        const Json* const outerObject = std::exchange(object_, &object);
        const std::string outerPath = std::exchange(path_, std::move(path));
        read();
        object_ = outerObject;
        path_ = outerPath;
    }

    const Json* object_;
    std::string path_;
    std::optional<Failure> failure_;
};

void readGrid(FieldReader& in, DatasetMetadata& metadata) {
    metadata.tiling.finestLevel = in.level("finestLevel");
    const auto transform = in.numbers("transform", 6);
    metadata.tiling.west = transform[0];
    metadata.tiling.finestSpacing = transform[1];
    metadata.tiling.north = transform[3];
    const bool northUp = transform[2] == 0 && transform[4] == 0 && transform[5] == -transform[1] && transform[1] > 0;
    in.require(northUp, "transform", "[west, spacing, 0, north, 0, -spacing] with a positive spacing");

    const auto most = static_cast<double>(int64_t{kTileCore} << metadata.tiling.finestLevel);
    metadata.samples.width = static_cast<int64_t>(in.whole("columns", 1, most));
    metadata.samples.height = static_cast<int64_t>(in.whole("rows", 1, most));
}

void readHeights(FieldReader& in, DatasetMetadata& metadata) {
    metadata.quantum = in.numberAbove("quantum", 0);
    metadata.minHeight = in.number("min");
    metadata.maxHeight = in.number("max");
    in.require(metadata.minHeight <= metadata.maxHeight, "max", "no less than min");
    metadata.verticalUnit = in.string("unit");
    in.require(metadata.verticalUnit == "metre", "unit", "\"metre\"");
    metadata.verticalDatum = in.string("datum");
    metadata.nodataPolicy = in.string("nodataPolicy");
    metadata.holeSamples = in.count("holeSamples");
    metadata.heightTiles = in.count("tiles");
    metadata.levelErrors = in.numbers("levelErrors", metadata.tiling.finestLevel + 1);
    for (const double error : metadata.levelErrors) in.require(error >= 0, "levelErrors", "without negative numbers");
    const std::string errorsHold = in.has("errorsHold") ? in.string("errorsHold") : kAtSamples;
    metadata.errorsHoldEverywhere = errorsHold == kEverywhere;
    in.require(metadata.errorsHoldEverywhere || errorsHold == kAtSamples, "errorsHold",
               "\"everywhere\" or \"at samples\"");
    metadata.errorBound = in.has("errorBound") ? in.number("errorBound") : metadata.levelErrors.back();
    in.require(metadata.errorBound >= 0, "errorBound", "no less than 0");
}

void readImagery(FieldReader& in, DatasetMetadata& metadata) {
    if (!in.isNull("finestLevel")) metadata.imageryLevel = in.level("finestLevel");
    metadata.imageryBounds = in.rect("bounds");
    metadata.imageryTiles = in.count("tiles");
}

}  // namespace

GroundRect DatasetMetadata::groundBounds() const {
    const double spacing = tiling.finestSpacing;
    return {tiling.west, tiling.north - static_cast<double>(samples.height) * spacing,
            tiling.west + static_cast<double>(samples.width) * spacing, tiling.north};
}

Json toJson(const DatasetMetadata& metadata) {
    const Tiling& tiling = metadata.tiling;
    Json grid;
    grid.set("transform", Json::Array{tiling.west, tiling.finestSpacing, 0, tiling.north, 0, -tiling.finestSpacing});
    grid.set("finestLevel", tiling.finestLevel);
    grid.set("columns", metadata.samples.width);
    grid.set("rows", metadata.samples.height);

    Json heights;
    heights.set("quantum", metadata.quantum);
    heights.set("min", metadata.minHeight);
    heights.set("max", metadata.maxHeight);
    heights.set("unit", metadata.verticalUnit);
    heights.set("datum", metadata.verticalDatum);
    heights.set("nodataPolicy", metadata.nodataPolicy);
    heights.set("holeSamples", metadata.holeSamples);
    heights.set("tiles", metadata.heightTiles);
    heights.set("levelErrors", Json::Array(metadata.levelErrors.begin(), metadata.levelErrors.end()));
    heights.set("errorsHold", metadata.errorsHoldEverywhere ? kEverywhere : kAtSamples);
    heights.set("errorBound", metadata.errorBound);

    Json imagery;
    imagery.set("finestLevel", metadata.imageryLevel ? Json(*metadata.imageryLevel) : Json());
    imagery.set("bounds", toJson(metadata.imageryBounds));
    imagery.set("tiles", metadata.imageryTiles);

    Json crs;
    crs.set("name", metadata.crsName);
    crs.set("wkt", metadata.crsWkt);

    Json sources = Json::Array{};
    for (const SourceFile& source : metadata.sources) {
        Json entry;
        entry.set("path", source.path);
        entry.set("bytes", source.bytes);
        entry.set("modifiedSeconds", source.modifiedSeconds);
        sources.push(std::move(entry));
    }

    Json json;
    json.set("format", kDatasetFormat);
    json.set("tool", metadata.tool);
    json.set("options", metadata.options);
    json.set("crs", std::move(crs));
    json.set("lonLatBounds", toJson(metadata.lonLatBounds));
    json.set("grid", std::move(grid));
    json.set("heights", std::move(heights));
    json.set("imagery", std::move(imagery));
    json.set("sources", std::move(sources));
    return json;
}

Result<DatasetMetadata> metadataFromJson(const Json& json) {
    if (!json.isObject()) return Failure{"metadata: expected a JSON object"};
    FieldReader in(json);
    // The version first: the meaning of everything else hangs on it.
    const double format = in.number("format");
    if (in.failure()) return Failure{in.failure()->message + " (this archive was not written by terray-preprocess)"};
    if (format != kDatasetFormat)
        return Failure{"metadata: the dataset has format " + Json(format).dump() + ", this build reads format " +
                       std::to_string(kDatasetFormat) + " (build the dataset again, or update this program)"};

    DatasetMetadata metadata;
    metadata.tool = in.string("tool");
    metadata.options = in.string("options");
    in.within("crs", [&] {
        metadata.crsName = in.string("name");
        metadata.crsWkt = in.string("wkt");
    });
    metadata.lonLatBounds = in.rect("lonLatBounds");
    in.within("grid", [&] { readGrid(in, metadata); });
    in.within("heights", [&] { readHeights(in, metadata); });
    in.within("imagery", [&] { readImagery(in, metadata); });
    in.forEach("sources", [&] {
        SourceFile source;
        source.path = in.string("path");
        source.bytes = in.count("bytes");
        source.modifiedSeconds = static_cast<int64_t>(in.whole("modifiedSeconds", -kExactIntegers, kExactIntegers));
        metadata.sources.push_back(std::move(source));
    });
    if (in.failure()) return *in.failure();
    return metadata;
}

}  // namespace terray
