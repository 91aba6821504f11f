// The march for every processor.
#define TERRAY_LANES lanes_portable
#define TERRAY_LANES_AVX2 0
#include "tests/bench/packet_march/kernel.h"

namespace terray {

const PacketKernel& portableKernel() {
    static constexpr PacketKernel kKernel = {"portable", lanes_portable::castTile, lanes_portable::castEight};
    return kKernel;
}

}  // namespace terray
