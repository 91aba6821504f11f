// resolve.frag: from hits to colours over the whole screen, for the raster launch.
#include "resolve.glsl"

layout(location = 0) out vec4 outColour;
#if TERRAY_NORMALS
layout(location = 1) out vec4 outNormal;
#endif

void main() {
    Resolved resolved = resolvePixel(ivec2(gl_FragCoord.xy));
    outColour = vec4(resolved.colour, 1.0);
#if TERRAY_NORMALS
    outNormal = vec4(resolved.normal, 0.0);
#endif
}
