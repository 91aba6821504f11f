#include "preprocess/build_heading.h"

#include <algorithm>
#include <map>

#include "common/version.h"

namespace terray {
namespace {

/// Of the journal, all of it: changes when the heading or a block's record does.
constexpr double kJournalVersion = 2;

std::string fileText(const Json& source) {
    const Json* bytes = source.find("bytes");
    const Json* modified = source.find("modifiedSeconds");
    return (bytes != nullptr ? bytes->dump(0) : "unknown") + " bytes, modified at Unix time " +
           (modified != nullptr ? modified->dump(0) : "unknown");
}

/// Files of a dataset by path.
std::map<std::string, std::string> filesOf(const Json& dataset) {
    std::map<std::string, std::string> files;
    const Json* sources = dataset.find("sources");
    if (sources == nullptr || !sources->isArray()) return files;
    for (const Json& source : sources->array())
        if (const auto path = source.stringAt("path"); path.ok()) files[*path] = fileText(source);
    return files;
}

void compareFiles(const Json& begun, const Json& now, std::vector<std::string>& changes) {
    const auto before = filesOf(begun);
    const auto after = filesOf(now);
    const size_t found = changes.size();
    for (const auto& [path, text] : before) {
        const auto same = after.find(path);
        if (same == after.end())
            changes.push_back("\"" + path + "\" is no longer among the inputs");
        else if (same->second != text)
            changes.push_back("\"" + path + "\" has changed: it had " + text + ", and has " + same->second);
    }
    for (const auto& [path, text] : after)
        if (!before.contains(path)) changes.push_back("\"" + path + "\" is a new input");
    if (changes.size() == found) changes.emplace_back("the inputs come in another order");
}

std::string memberText(const Json* member) {
    return member == nullptr ? "absent" : member->dump(0);
}

}  // namespace

BuildHeading makeHeading(const DatasetMetadata& metadata, uint32_t heightDepth, uint32_t imageryDepth) {
    const BuildInfo& info = buildInfo();
    return {.program = std::string(info.version) + ", commit " + std::string(info.commit) +
                       (info.dirty ? ", modified" : "") + ", " + std::string(info.compiler),
            .dataset = toJson(metadata),
            .heightDepth = heightDepth,
            .imageryDepth = imageryDepth};
}

Bytes encodeHeading(const BuildHeading& heading) {
    const Json json(Json::Object{{"journal", kJournalVersion},
                                 {"program", heading.program},
                                 {"dataset", heading.dataset},
                                 {"heightDepth", heading.heightDepth},
                                 {"imageryDepth", heading.imageryDepth}});
    ByteWriter out;
    out.writeText(json.dump(0));
    return out.release();
}

Result<BuildHeading> decodeHeading(ByteView bytes) {
    const auto json = Json::parse({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    if (!json.ok()) return json.failure();
    const auto version = json->numberAt("journal");
    if (!version.ok()) return version.failure();
    if (*version != kJournalVersion)
        return Failure{"its journal has version " + Json(*version).dump(0) + ", this program reads " +
                       Json(kJournalVersion).dump(0)};
    const auto program = json->stringAt("program");
    if (!program.ok()) return program.failure();
    const Json* dataset = json->find("dataset");
    if (dataset == nullptr) return Failure{"its journal does not say what it builds"};
    const auto heightDepth = json->numberAt("heightDepth");
    if (!heightDepth.ok()) return heightDepth.failure();
    const auto imageryDepth = json->numberAt("imageryDepth");
    if (!imageryDepth.ok()) return imageryDepth.failure();
    return BuildHeading{.program = *program,
                        .dataset = *dataset,
                        .heightDepth = static_cast<uint32_t>(*heightDepth),
                        .imageryDepth = static_cast<uint32_t>(*imageryDepth)};
}

std::vector<std::string> changesSince(const BuildHeading& begun, const BuildHeading& now) {
    std::vector<std::string> changes;
    if (begun.program != now.program)
        changes.push_back("it was begun by terray-preprocess " + begun.program + ", and this is " + now.program);
    if (!begun.dataset.isObject() || !now.dataset.isObject()) return changes;
    for (const auto& [name, value] : now.dataset.object()) {
        const Json* before = begun.dataset.find(name);
        if (before != nullptr && *before == value) continue;
        if (name == "sources" && before != nullptr)
            compareFiles(begun.dataset, now.dataset, changes);
        else
            changes.push_back(name + " was " + memberText(before) + ", and is " + value.dump(0));
    }
    return changes;
}

}  // namespace terray
