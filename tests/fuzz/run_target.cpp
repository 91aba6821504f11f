// What libFuzzer calls: the target of targets.h that TERRAY_FUZZ_TARGET names.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count) {
    terray::fuzz::TERRAY_FUZZ_TARGET(std::as_bytes(std::span(bytes, count)));
    return 0;
}
