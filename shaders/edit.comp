// Craters and brush strokes on the codes of one height tile, in place, apron included: the closed forms of
// common/terrain_edit.h at the centre of each sample, from its stored code to that of the tile's edited encoding. A hole
// stays a hole. Frame: the dataset's plane, metres, in double.
#define TERRAY_EDITS
#include "interop.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = TERRAY_IMAGE_EDITED_CODES, r16ui) uniform uimage2DArray heightCodes;
layout(std140, binding = TERRAY_BUFFER_EDITED_TILE) uniform TileBuffer { EditedTileParameters tile; };
layout(std430, binding = TERRAY_BUFFER_EDITS) readonly buffer EditBuffer { EditParameters edits[]; };
layout(std430, binding = TERRAY_BUFFER_EDIT_SEGMENTS) readonly buffer SegmentBuffer { dvec4 segments[]; };

double distanceToSegment(dvec2 place, dvec4 segment) {
    dvec2 along = segment.zw - segment.xy;
    dvec2 offset = place - segment.xy;
    double squared = dot(along, along);
    double share = squared > 0.0LF ? clamp(dot(offset, along) / squared, 0.0LF, 1.0LF) : 0.0LF;
    dvec2 away = offset - share * along;
    return sqrt(dot(away, away));
}

double distanceToLine(dvec2 place, uint first, uint end) {
    double nearest = distanceToSegment(place, segments[first]);
    for (uint n = first + 1u; n < end; ++n) nearest = min(nearest, distanceToSegment(place, segments[n]));
    return nearest;
}

double craterChange(EditParameters crater, double distanceHere) {
    double depth = crater.shape.z;
    double rim = crater.shape.w;
    double r = distanceHere / crater.shape.x;
    return r <= 1.0LF ? (depth + rim) * (r * r) - depth : rim * ((2.0LF - r) * (2.0LF - r));
}

double strokeWeight(EditParameters stroke, double distanceHere) {
    double full = stroke.shape.y;
    double t = clamp((distanceHere - full) / (stroke.shape.x - full), 0.0LF, 1.0LF);
    return 1.0LF - t * t * (3.0LF - 2.0LF * t);
}

double editedHeight(double height, dvec2 place) {
    uint count = uint(tile.ground.z);
    for (uint n = 0u; n < count; ++n) {
        EditParameters edit = edits[n];
        double distanceHere = distanceToLine(place, uint(edit.line.y), uint(edit.line.z));
        if (distanceHere >= edit.line.w) continue;
        int kind = int(edit.line.x);
        if (kind == TERRAY_EDIT_CRATER) {
            height += craterChange(edit, distanceHere);
        } else {
            double weight = strokeWeight(edit, distanceHere);
            double kept = kind == TERRAY_EDIT_LEVEL ? 1.0LF - weight : 1.0LF;
            height = kept * height + weight * edit.shape.z;
        }
    }
    return height;
}

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, imageSize(heightCodes).xy))) return;
    ivec3 where = ivec3(texel, int(tile.samples.w));
    uint code = imageLoad(heightCodes, where).r;
    if (code == 0u) return;
    dvec2 sampleCentre = tile.samples.xy + dvec2(texel) + 0.5LF;
    dvec2 place = dvec2(tile.ground.x + sampleCentre.x * tile.samples.z, tile.ground.y - sampleCentre.y * tile.samples.z);
    double height = editedHeight((tile.codes.x + double(code)) * tile.codes.y, place);
    double edited = floor(height / tile.codes.w + 0.5LF) - tile.codes.z;
    imageStore(heightCodes, where, uvec4(uint(clamp(edited, 1.0LF, 65535.0LF))));
}
