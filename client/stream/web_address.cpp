#include "client/stream/web_address.h"

#include <algorithm>

#include "common/dataset_metadata.h"
#include "common/error.h"

namespace terray {
namespace {

[[noreturn]] void refuse(const std::string& place, const std::string& expected) {
    throw Error(ExitCode::usage, "dataset: found the address \"" + place + "\", expected " + expected);
}

}  // namespace

bool isWebAddress(std::string_view place) {
    return place.starts_with("http://") || place.starts_with("https://");
}

std::string archiveAddress(const std::string& place, std::string_view file) {
    const size_t host = place.find("//") + 2;
    const size_t hostEnd = std::min(place.find_first_of("/?#", host), place.size());
    const std::string authority = place.substr(host, hostEnd - host);
    if (authority.find('@') != std::string::npos)
        refuse(authority.substr(authority.rfind('@')), "one without name and password");
    if (authority.empty() || authority.front() == ':') refuse(place, "http(s)://HOST/NAME");

    std::string path = place.substr(0, place.find('#'));
    const size_t question = path.find('?');
    const std::string query = question == std::string::npos ? "" : path.substr(question);
    path.resize(path.size() - query.size());
    if (path.size() > hostEnd && path.ends_with("/" + std::string(kHeightsFile)))
        path.resize(path.size() - std::string_view(kHeightsFile).size());
    while (path.size() > hostEnd && path.back() == '/') path.pop_back();
    return path + "/" + std::string(file) + query;
}

}  // namespace terray
