#include "server/catalogue.h"

#include <algorithm>
#include <fstream>
#include <utility>

#include "common/error.h"
#include "common/json.h"
#include "common/version.h"

namespace terray::server {
namespace {

bool isName(std::string_view text) {
    const auto isPlain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    };
    constexpr size_t kMostBytes = 64;
    return !text.empty() && text.size() <= kMostBytes && isPlain(text.front()) && text != "health" &&
           text != "metrics" && std::all_of(text.begin(), text.end(), [&](char c) {
               return isPlain(c) || c == '.' || c == '_' || c == '-';
           });
}

DatasetSpec parseSpec(const std::string& word) {
    const size_t equals = word.find('=');
    if (equals == std::string::npos || equals + 1 == word.size())
        throw Error(ExitCode::usage,
                    "\"" + word + "\" names no dataset to serve; expected NAME=DIR, such as alps=/data/alps");
    const std::string name = word.substr(0, equals);
    if (!isName(name))
        throw Error(ExitCode::usage,
                    "\"" + name +
                        "\" cannot be a dataset's name in addresses; expected up to 64 letters, "
                        "digits, '.', '_' or '-', a letter or digit first, and not \"health\" or \"metrics\"");
    return {name, word.substr(equals + 1)};
}

std::vector<std::string> wordsIn(const std::string& list) {
    std::ifstream file(list);
    if (!file)
        throw Error(ExitCode::input,
                    "cannot read the list of datasets " + list + "; expected a file of NAME=DIR lines");
    std::vector<std::string> words;
    for (std::string line; std::getline(file, line);) {
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.pop_back();
        if (!line.empty() && line.front() != '#') words.push_back(line);
    }
    return words;
}

Json boundsJson(const GroundRect& bounds) {
    return Json::Array{bounds.west, bounds.south, bounds.east, bounds.north};
}

Json entryOf(const ServedDataset& dataset) {
    const auto address = [&](const std::string& file) { return dataset.name + "/" + file + "?v=" + dataset.version; };
    const auto levels = [](const std::shared_ptr<const ServedArchive>& archive) {
        return archive ? Json(archive->finestLevel() + 1) : Json();
    };
    Json json;
    json.set("name", dataset.name);
    json.set("version", dataset.version);
    json.set("crs", dataset.metadata.crsName);
    json.set("bounds", boundsJson(dataset.metadata.groundBounds()));
    const auto& lonLat = dataset.metadata.lonLatBounds;
    json.set("lonLatBounds", lonLat ? boundsJson(*lonLat) : Json());
    json.set("heightLevels", levels(dataset.heights));
    json.set("imageryLevels", levels(dataset.imagery));
    Json links;
    links.set("metadata", address("metadata.json"));
    links.set("heights", address("heights/{z}/{x}/{y}"));
    links.set("heightsArchive", address(kHeightsFile));
    if (dataset.imagery) {
        links.set("imagery", address("imagery/{z}/{x}/{y}"));
        links.set("imageryArchive", address(kImageryFile));
    }
    json.set("links", std::move(links));
    return json;
}

}  // namespace

std::vector<DatasetSpec> parseSpecs(const std::vector<std::string>& words) {
    std::vector<DatasetSpec> specs;
    const auto add = [&](const std::string& word) {
        DatasetSpec spec = parseSpec(word);
        for (const DatasetSpec& other : specs)
            if (other.name == spec.name)
                throw Error(ExitCode::usage,
                            "two datasets are named \"" + spec.name + "\"; give one of them another name");
        specs.push_back(std::move(spec));
    };
    for (const std::string& word : words) {
        if (!word.starts_with('@')) {
            add(word);
            continue;
        }
        for (const std::string& listed : wordsIn(word.substr(1))) add(listed);
    }
    return specs;
}

Catalogue::Catalogue(Datasets datasets) : datasets_(std::move(datasets)) {
    std::sort(datasets_.begin(), datasets_.end(), [](const auto& a, const auto& b) { return a->name < b->name; });
    Json entries = Json::Array{};
    for (const auto& dataset : datasets_) entries.push(entryOf(*dataset));
    Json json;
    json.set("server", "terray-server " + std::string(buildInfo().version));
    json.set("datasets", std::move(entries));
    json_ = json.dump() + "\n";
}

const ServedDataset* Catalogue::find(std::string_view name) const {
    const auto found =
        std::lower_bound(datasets_.begin(), datasets_.end(), name,
                         [](const auto& dataset, std::string_view text) { return dataset->name < text; });
    return found != datasets_.end() && (*found)->name == name ? found->get() : nullptr;
}

std::shared_ptr<const Catalogue> openCatalogue(const std::vector<DatasetSpec>& specs) {
    Catalogue::Datasets datasets;
    for (const DatasetSpec& spec : specs) {
        auto dataset = openServedDataset(spec.name, spec.directory);
        if (!dataset) throw Error(ExitCode::dataset, dataset.failure().message);
        datasets.push_back(*dataset);
    }
    return std::make_shared<const Catalogue>(std::move(datasets));
}

std::shared_ptr<const Catalogue> reloadCatalogue(const std::vector<DatasetSpec>& specs, const Catalogue& previous,
                                                 const std::function<void(const std::string&)>& complain) {
    Catalogue::Datasets datasets;
    for (const DatasetSpec& spec : specs) {
        const auto isNamed = [&](const auto& dataset) { return dataset->name == spec.name; };
        const auto old = std::find_if(previous.datasets().begin(), previous.datasets().end(), isNamed);
        const bool isOld = old != previous.datasets().end();
        const auto opened = openServedDataset(spec.name, spec.directory);
        if (!opened)
            complain(opened.failure().message + (isOld ? "; what was there before is served on" : "; it is left out"));
        if (opened && !(isOld && (*old)->version == (*opened)->version))
            datasets.push_back(*opened);
        else if (isOld)
            datasets.push_back(*old);
    }
    return std::make_shared<const Catalogue>(std::move(datasets));
}

}  // namespace terray::server
