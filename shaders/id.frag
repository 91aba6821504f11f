// id.frag: marks the pixels of a node's box for which nothing nearer has been hit (paper 001, section 3.4). The depth test
// decides; depth is not written.
#include "interop.h"

layout(location = TERRAY_UNIFORM_NODE) uniform uint nodeIndex;
layout(location = 0) out uint outId;

void main() { outId = nodeIndex + 1u; }
