// The march for AVX2 and FMA; compiled with both. Only avx2Kernel() in packet_march.cpp, which asks the processor
// first, may hand it out.
#define TERRAY_LANES lanes_avx2
#define TERRAY_LANES_AVX2 1
#include "tests/bench/packet_march/kernel.h"

namespace terray {

extern const PacketKernel kAvx2Kernel;
const PacketKernel kAvx2Kernel = {"AVX2", lanes_avx2::castTile, lanes_avx2::castEight};

}  // namespace terray
