#include "server/responder.h"

#include <charconv>
#include <utility>
#include <vector>

#include "server/preconditions.h"
#include "server/request_target.h"

namespace terray::server {
namespace {

constexpr const char* kJsonType = "application/json";
constexpr const char* kAllowed = "GET, HEAD, OPTIONS";
constexpr const char* kImmutable = "public, max-age=31536000, immutable";
constexpr const char* kRevalidate = "public, max-age=0, must-revalidate";

/// Something that can be fetched, before the request's conditions and ranges have been looked at.
struct Resource {
    std::string type;  ///< media type; empty: there is no content (204)
    Body body;
    std::string tag;           ///< strong entity tag without quotes; empty: changes by the moment, not to be stored
    bool isImmutable = false;  ///< the address names this very version
    bool hasRanges = false;
};
using Found = std::variant<Resource, Response>;  // a Response says why there is none

Response notFound(const std::string& what) {
    return refusal(404, what);
}

std::optional<uint32_t> parseIndex(std::string_view text) {
    uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool isCanonical = text == "0" || !text.starts_with('0');  // one address for each tile
    if (error != std::errc() || end != text.data() + text.size() || !isCanonical) return {};
    return value;
}

/// The layer that a path's segment names, with the media type of its tiles.
struct Layer {
    const char* name;
    const char* file;
    const char* tileType;
    std::shared_ptr<const ServedArchive> ServedDataset::*archive;
};
constexpr Layer kLayers[] = {
    {"heights", kHeightsFile, "application/vnd.terray.heights", &ServedDataset::heights},
    {"imagery", kImageryFile, "application/vnd.terray.imagery", &ServedDataset::imagery},
};

Found findTile(const ServedDataset& dataset, const Layer& layer, const std::vector<std::string>& segments) {
    const auto& archive = dataset.*layer.archive;
    const auto level = parseIndex(segments[2]), x = parseIndex(segments[3]), y = parseIndex(segments[4]);
    if (!level || !x || !y) return notFound("a tile's address ends in {z}/{x}/{y}, three whole numbers");
    const TileId id{*level, *x, *y};
    if (!id.valid() || *level > archive->finestLevel())
        return notFound(dataset.name + " has " + layer.name + " of the levels 0 to " +
                        std::to_string(archive->finestLevel()) + " with 2^level tiles a side");
    const auto range = archive->reader().locate(id);
    if (!range) return refusal(500, "the archive cannot be read; the server's operator should verify the dataset");
    if (!*range) return Resource{.tag = dataset.version};
    return Resource{
        .type = layer.tileType, .body = ArchiveSlice{archive, **range, id}, .tag = dataset.version, .hasRanges = true};
}

Found findInLayer(const ServedDataset& dataset, const Layer& layer, const std::vector<std::string>& segments) {
    const auto& archive = dataset.*layer.archive;
    if (!archive) return notFound(dataset.name + " has no " + layer.name);
    if (segments.size() == 5) return findTile(dataset, layer, segments);
    if (segments.size() == 2 && segments[1] == layer.file)
        return Resource{.type = "application/vnd.pmtiles",
                        .body = ArchiveSlice{.archive = archive, .range = {0, archive->size()}},
                        .tag = dataset.version,
                        .hasRanges = true};
    return notFound("tiles lie at /" + dataset.name + "/" + layer.name + "/{z}/{x}/{y}");
}

Found findInDataset(const ServedDataset& dataset, const std::vector<std::string>& segments) {
    if (segments.size() == 2 && segments[1] == "metadata.json")
        return Resource{
            .type = kJsonType, .body = dataset.metadataJson, .tag = contentTag(dataset.version + dataset.metadataJson)};
    for (const Layer& layer : kLayers)
        if (segments.size() >= 2 && (segments[1] == layer.name || segments[1] == layer.file))
            return findInLayer(dataset, layer, segments);
    return notFound("see /" + dataset.name + "/metadata.json for what the dataset offers");
}

Found find(const RequestTarget& target, const Catalogue& catalogue, const Metrics& metrics) {
    const auto& segments = target.segments;
    if (segments.empty())
        return Resource{.type = kJsonType, .body = catalogue.json(), .tag = contentTag(catalogue.json())};
    if (segments.size() == 1 && segments[0] == "health")
        return Resource{.type = kJsonType, .body = "{\"status\": \"ok\"}\n"};
    if (segments.size() == 1 && segments[0] == "metrics")
        return Resource{.type = "text/plain; version=0.0.4; charset=utf-8",
                        .body = prometheusText(metrics, catalogue.datasets().size())};
    const ServedDataset* dataset = catalogue.find(segments[0]);
    if (dataset == nullptr) return notFound("there is no such dataset; / lists those that there are");
    Found found = findInDataset(*dataset, segments);
    if (auto* resource = std::get_if<Resource>(&found)) resource->isImmutable = target.version == dataset->version;
    return found;
}

/// Fields that an answer has with and without content: a 304 repeats them (RFC 9110, 15.4.5).
void addCommonFields(Response& response, const Resource& resource) {
    constexpr size_t kUsualBytes = 512;  // of all fields together
    response.fields.reserve(kUsualBytes);
    response.addField("Access-Control-Allow-Origin", "*");
    response.addField("Access-Control-Expose-Headers",
                      "Accept-Ranges, Content-Length, Content-Range, ETag, Retry-After");
    if (resource.tag.empty()) {
        response.addField("Cache-Control", "no-store");
        return;
    }
    response.addField("Cache-Control", resource.isImmutable ? kImmutable : kRevalidate);
    response.addField("ETag", "\"" + resource.tag + "\"");
}

/// The part that a GET asks for, where the resource and If-Range allow parts.
std::variant<std::monostate, ByteRange, Unsatisfiable> rangeOf(const Request& request, const Resource& resource,
                                                               const std::string& tag) {
    const bool sameVersion = !request.ifRange || *request.ifRange == tag;  // a date never is: there is no Last-Modified
    if (request.method != "GET" || !resource.hasRanges || !sameVersion) return {};
    return parseRange(request.range, lengthOf(resource.body));
}

/// Conditions first, then the range, as RFC 9110, 13.2.2 orders them.
Response answerWith(const Request& request, Resource resource) {
    const std::string tag = "\"" + resource.tag + "\"";
    const bool hasTag = !resource.tag.empty();
    if (hasTag && request.ifMatch && !namesTag(*request.ifMatch, tag, false))
        return refusal(412, "what is here has the entity tag " + tag);
    Response response;
    addCommonFields(response, resource);
    if (hasTag && request.ifNoneMatch && namesTag(*request.ifNoneMatch, tag, true)) {
        response.status = 304;
        return response;
    }
    if (resource.type.empty()) {
        response.status = 204;
        return response;
    }
    const uint64_t size = lengthOf(resource.body);
    const auto range = rangeOf(request, resource, tag);
    if (std::holds_alternative<Unsatisfiable>(range)) {
        Response unsatisfiable = refusal(416, "there are " + std::to_string(size) + " bytes");
        unsatisfiable.addField("Content-Range", "bytes */" + std::to_string(size));
        return unsatisfiable;
    }
    if (resource.hasRanges) response.addField("Accept-Ranges", "bytes");
    response.addField("Content-Type", resource.type);
    response.addField("X-Content-Type-Options", "nosniff");
    response.body = std::move(resource.body);
    if (const auto* part = std::get_if<ByteRange>(&range)) {
        response.status = 206;
        response.addField("Content-Range", "bytes " + std::to_string(part->offset) + "-" +
                                               std::to_string(part->offset + part->length - 1) + "/" +
                                               std::to_string(size));
        auto& slice = std::get<ArchiveSlice>(response.body);
        slice.range = {slice.range.offset + part->offset, part->length};
        slice.tile.reset();
    }
    return response;
}

/// What a browser asks before a request to another site.
Response preflight() {
    Response response{.status = 204};
    response.addField("Allow", kAllowed);
    response.addField("Access-Control-Allow-Origin", "*");
    response.addField("Access-Control-Allow-Methods", kAllowed);
    response.addField("Access-Control-Allow-Headers", "If-Match, If-None-Match, If-Range, Range");
    response.addField("Access-Control-Max-Age", "86400");
    return response;
}

Response unknownMethod(const std::string& method) {
    for (const char* known : {"POST", "PUT", "DELETE", "PATCH", "TRACE", "CONNECT"}) {
        if (method != known) continue;
        Response response = refusal(405, "datasets can only be read");
        response.addField("Allow", kAllowed);
        return response;
    }
    return refusal(501, std::string("this server knows the methods ") + kAllowed);
}

Response respondToHead(const Request& request, const Catalogue& catalogue, const Metrics& metrics) {
    const bool isRead = request.method == "GET" || request.method == "HEAD";
    if (!isRead && request.method != "OPTIONS") return unknownMethod(request.method);
    if (isRead && request.hasBody) return refusal(413, "this server takes no request bodies");
    const auto target = parseTarget(request.target);
    if (!target || (isRead && request.target == "*")) return refusal(400, "the request's target is no path");
    if (!isRead) return preflight();
    Found found = find(*target, catalogue, metrics);
    if (auto* reason = std::get_if<Response>(&found)) return std::move(*reason);
    return answerWith(request, std::get<Resource>(std::move(found)));
}

}  // namespace

Response respond(const Request& request, const Catalogue& catalogue, const Metrics& metrics) {
    Response response = respondToHead(request, catalogue, metrics);
    response.isHead = request.method == "HEAD";
    response.closes = request.hasBody || !request.keepAlive;
    return response;
}

}  // namespace terray::server
