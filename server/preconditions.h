#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "common/pmtiles.h"

namespace terray::server {

/// Whether an If-None-Match or If-Match field ("*", or a list of entity tags) names this tag, itself in quotes.
/// @param weakly  "W/" is overlooked, as If-None-Match asks for; otherwise a weak tag never matches
[[nodiscard]] bool namesTag(std::string_view field, std::string_view tag, bool weakly);

/// There is no such part: to be answered with 416.
struct Unsatisfiable {};

/// What a Range field asks for of `size` bytes. (RFC 9110, 14)
///
/// @return  one part, clipped to the size; Unsatisfiable where it begins beyond the end; or nothing, which means the
///          whole: no field, another unit, bad syntax, or several parts (a server may answer those with the whole)
[[nodiscard]] std::variant<std::monostate, ByteRange, Unsatisfiable> parseRange(const std::optional<std::string>& field,
                                                                                uint64_t size);

}  // namespace terray::server
