// What libFuzzer calls. See server/README.md, "Fuzzing".
#include <cstddef>
#include <cstdint>

#include "tests/server/answer_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count) {
    terray::server::answerBytes({reinterpret_cast<const char*>(bytes), count});
    return 0;
}
