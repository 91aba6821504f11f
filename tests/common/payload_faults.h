#pragma once
// Damages a payload in every way that a decoder must notice.

#include <functional>

#include "common/bytes.h"

namespace terray::test {

/// Whether the decoder under test accepts these bytes.
using Accepts = std::function<bool(ByteView)>;

/// Expects that the decoder accepts the whole payload and no shorter beginning of it, each in a buffer of its own so
/// that a sanitizer sees an overread. Beyond the first `every` bytes and before the last, only each 251st length is
/// tried.
void expectRefusesTruncations(const Bytes& payload, const Accepts& accepts, size_t every = 4096);

/// Expects that bytes after the end are noticed.
void expectRefusesExtraBytes(const Bytes& payload, const Accepts& accepts);

/// Expects that any one flipped bit is noticed: all of the first `every` bytes, then `random` bits further on.
void expectRefusesBitFlips(const Bytes& payload, const Accepts& accepts, size_t every = 512, size_t random = 500);

/// The payload with another value at a byte position, its header checksum made to match (the checksum's place is
/// given), so that the check behind the checksum is what answers.
[[nodiscard]] Bytes resealed(Bytes payload, size_t position, std::byte value, size_t checksumPosition);

}  // namespace terray::test
