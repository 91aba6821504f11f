#pragma once

#include <string>
#include <string_view>

namespace terray {

/// Whether a place names a dataset on a web server: it begins with "http://" or "https://".
[[nodiscard]] bool isWebAddress(std::string_view place);

/// Where an archive of a dataset lies. A dataset is named by its folder, as terray-server offers it
/// (http://host/NAME) and a web server a dataset's directory, or by its heights.pmtiles; a query (?...) is kept.
///
/// @param place  isWebAddress()
/// @param file   "heights.pmtiles" or "imagery.pmtiles"
/// Throws Error(usage) for an address without a host, or with a password in it, which would stand in manifests and
/// messages.
[[nodiscard]] std::string archiveAddress(const std::string& place, std::string_view file);

}  // namespace terray
