#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace terray::server {

/// A request's target, taken apart. Segments are only ever compared with names in tables: none becomes part of a file's
/// name, so no target, whatever it is, leads out of the datasets.
struct RequestTarget {
    std::vector<std::string> segments;   ///< between the slashes, unescaped; none for "/"
    std::optional<std::string> version;  ///< value of the query's first "v", unescaped
};

/// Takes "/a/b?v=1", "http://host/a/b?v=1" (any client may send it, RFC 9112, 3.2.2) or "*" (no segments).
/// @return  none for anything else, and where an escape is not "%" and two hexadecimal digits
[[nodiscard]] std::optional<RequestTarget> parseTarget(std::string_view target);

}  // namespace terray::server
