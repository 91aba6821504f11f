// march_result.glsl: what a method answers for a ray and a node.
#ifndef TERRAY_MARCH_RESULT
#define TERRAY_MARCH_RESULT

struct March {
    bool hit;
    bool exhausted;  // out of steps
    int steps;
    float t;         // view depth of the hit, metres
};

#endif
