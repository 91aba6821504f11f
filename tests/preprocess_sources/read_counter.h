#pragma once

#include <cstdint>
#include <string>

namespace terray::test {

/// The name by which GDAL opens `file` through a layer that counts what is read.
[[nodiscard]] std::string countedName(const std::string& file);
/// Bytes read under all counted names since the last call.
[[nodiscard]] uint64_t takeBytesRead();

}  // namespace terray::test
