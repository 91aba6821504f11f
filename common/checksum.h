#pragma once

#include <cstdint>

#include "common/bytes.h"

namespace terray {

/// CRC-32C (Castagnoli polynomial 0x1EDC6F41, reflected, initial and final value 0xFFFFFFFF) of some bytes.
///
/// Detects every error burst of up to 32 bits, so every single flipped bit; other damage goes unseen once in 2^32.
/// Our own because common may not depend on zlib (bench-minimal builds without it) and zstd exports none.
/// @param previous  the checksum of what came before, to continue over several pieces; 0 to start
/// @return          crc32c("123456789") = 0xE3069283 (RFC 3720, appendix B.4, and every catalogue of CRCs)
[[nodiscard]] uint32_t crc32c(ByteView bytes, uint32_t previous = 0);

}  // namespace terray
