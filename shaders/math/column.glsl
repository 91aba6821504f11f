// math/column.glsl: ray against a column, a solid prism over one cell that reaches from -infinity to its top.
// Frame: tile; heights in codes. t: view depth in metres.
// Source: Dick, Krueger, Westermann 2009, section 3.1 and figure 4.
#ifndef TERRAY_MATH_COLUMN
#define TERRAY_MATH_COLUMN
#include "math/portable.glsl"

// Whether the ray is at or below `top` anywhere in [enter, exit]: for a rising ray its entry decides, else its exit.
MATH_FUNCTION bool meetsColumn(real top, real eyeZ, real directionZ, real enter, real exit) {
    return eyeZ + (directionZ < REAL(0.0) ? exit : enter) * directionZ <= top;
}

// t of the meeting, once meetsColumn holds: at the entry (through the side, or from within), or later on the top.
// Never before `enter` and never after `exit`, whatever the rounding.
MATH_FUNCTION real columnTime(real top, real eyeZ, real directionZ, real inverseZ, real enter, real exit) {
    if (directionZ >= REAL(0.0)) return enter;
    return max(enter, min((top - eyeZ) * inverseZ, exit));
}

#endif
