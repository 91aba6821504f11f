// Data that C++ writes and shaders read: one file, compiled by both. Every struct is std430/std140-clean: vec4 and
// uvec4 only, or dvec4 only.
#ifndef TERRAY_INTEROP_H
#define TERRAY_INTEROP_H

#ifdef __cplusplus
#include <cstdint>

#include <glm/vec4.hpp>
namespace terray::interop {
using vec4 = glm::vec4;
using uvec4 = glm::uvec4;
using dvec4 = glm::dvec4;
#endif

// Bindings. Textures: GL texture units. Buffers: indexed binding points.
#define TERRAY_UNIT_HEIGHTS 0         // usampler2DArray: codes and maximum mipmap, see GpuTiles
#define TERRAY_UNIT_PHOTO 1           // sampler2DArray: BC1 sRGB
#define TERRAY_UNIT_ID 2              // usampler2D: node last found in front, by the ID pass
#define TERRAY_UNIT_HIT 3             // sampler2D: hit in the tile frame, view depth
#define TERRAY_UNIT_NODE 4            // usampler2D: node index + 1
#define TERRAY_UNIT_SKY 5             // sampler2D: the sky by direction, see SkyTable
#define TERRAY_UNIT_AIR 6             // sampler3D: the air by direction and distance, see SkyTable
#define TERRAY_UNIT_SUN_LIGHT 7       // sampler2D: part of the sun that the ground sees
#define TERRAY_UNIT_STEPS 8           // usampler2D: steps of each pixel's ray, or of its shadow rays
#define TERRAY_UNIT_METHOD 9          // what a method keeps of each tile (MethodTiles)
#define TERRAY_IMAGE_STEPS 0          // uimage2D r32ui
#define TERRAY_IMAGE_HIT 1            // image2D rgba32f, compute launch
#define TERRAY_IMAGE_NODE 2           // uimage2D r32ui, compute launch
#define TERRAY_IMAGE_COLOUR 3         // image2D rgba8 (sRGB bytes) or rgba16f (linear), compute launch
#define TERRAY_IMAGE_NORMAL 4         // image2D rgba32f, compute launch
#define TERRAY_IMAGE_SUN_LIGHT 5      // image2D r8, compute launch
#define TERRAY_IMAGE_SHADOW_STEPS 6   // uimage2D r32ui
#define TERRAY_BUFFER_NODES 0         // SSBO: NodeParameters[]
#define TERRAY_BUFFER_FRAME 1         // UBO: FrameParameters
#define TERRAY_BUFFER_BOXES 2         // SSBO: vec4[], of each node the pixels that its box covers; compute launch
#define TERRAY_BUFFER_BINS 3          // SSBO: uint[], of each square of pixels a bit for each node; compute launch
#define TERRAY_BUFFER_SKY 6           // SSBO: SkyParameters
#define TERRAY_BUFFER_SHADOW_CELLS 4  // SSBO: ShadowCell[]
#define TERRAY_BUFFER_SHADOW 5        // UBO: ShadowParameters
#define TERRAY_BUFFER_SHADING 7       // UBO: ShadingParameters
#define TERRAY_BUFFER_METHOD 8        // UBO: MethodParameters
#define TERRAY_UNIFORM_NODE 0         // location of the node index (raster), of the number of nodes (compute)
#define TERRAY_UNIFORM_GEOMETRY 1     // locations of methods that rasterise geometry (GeometryPass)
#define TERRAY_UNIFORM_INSIDE 2
#define TERRAY_UNIFORM_SLACK 2
#define TERRAY_UNIFORM_HOLED 1
#define TERRAY_UNIFORM_ORIGIN 0  // locations of overlays, see overlay.vert and overlay.frag
#define TERRAY_UNIFORM_GROWTH 1
#define TERRAY_UNIFORM_COLOUR 2

// Compute launch: pixels along the side of a work group, and of the square of pixels that nodes are binned to.
#define TERRAY_GROUP_SIDE 8
#define TERRAY_BIN_SIDE 32

// NodeParameters::source.w: the pyramid level to start at in the low bits, and whether the surface is bilinear. For
// shading modes: whether ancestors stand in for tiles that are not resident, and level and hash of the height source;
// the two lowest bits of the hash are the tile's quadrant, so that neighbours differ.
#define TERRAY_START_LEVEL_MASK 0xffu
#define TERRAY_BILINEAR_BIT 0x100u
#define TERRAY_HEIGHT_STAND_IN_BIT 0x200u
#define TERRAY_PHOTO_STAND_IN_BIT 0x400u
#define TERRAY_TILE_LEVEL_SHIFT 11
#define TERRAY_TILE_LEVEL_MASK 0x1fu
#define TERRAY_TILE_HASH_SHIFT 16

// Within the programs that make the sky (SkyTable): tables of the air, and SkyInput, UBO.
#define TERRAY_SKY_UNIT_TRANSMITTANCE 0
#define TERRAY_SKY_UNIT_ECHO 1
#define TERRAY_BUFFER_SKY_INPUT 2
// Heights for which light on the ground is known: evenly from sea level to the top one, metres.
#define TERRAY_SKY_LIGHTS 32
#define TERRAY_SKY_TOP_LIGHT 9000.0

// Within the program that edits tiles (TileEditor).
#define TERRAY_IMAGE_EDITED_CODES 0    // uimage2DArray r16ui: level 0 of the height array
#define TERRAY_BUFFER_EDITED_TILE 0    // UBO: EditedTileParameters
#define TERRAY_BUFFER_EDITS 0          // SSBO: EditParameters[]
#define TERRAY_BUFFER_EDIT_SEGMENTS 1  // SSBO: dvec4[], of each segment of a line its two ends
#define TERRAY_EDIT_CRATER 0
#define TERRAY_EDIT_RAISE 1
#define TERRAY_EDIT_LEVEL 2

// A slot that is none: NodeParameters::source.y of a node without photo.
#define TERRAY_NO_SLOT 0xffffffffu
// A draw node that is none: ShadowCell::source.x of a cell that is split.
#define TERRAY_NO_NODE 0xffffffffu

// One draw node. "Tile frame": of the node's height source tile, x east and y south in its texels (0..512 over the
// core), z in its height codes, so that a column's top is exactly its code.
struct NodeParameters {
    vec4 eye;      // xyz: the eye in the tile frame; w: metres per texel
    vec4 right;    // xyz: half the picture's width at view depth 1 m, in the tile frame; w: metres per code, drawn
    vec4 up;       // xyz: half the picture's height at view depth 1 m, in the tile frame; w: raster margin, metres
    vec4 forward;  // xyz: the view axis, 1 m, in the tile frame; w: geometric error of the height source, metres
    vec4 boxMin;   // xyz: the cell's box in the tile frame; w: curved earth: what the seen box needs more, metres down
    vec4 boxMax;   // likewise; w: metres up
    vec4 photo;    // xy: offset, z: scale from tile-frame texels to texels of the photo tile's core
    uvec4 source;  // x: height slot, y: photo slot or TERRAY_NO_SLOT, z: level of the cell, w: see above
};

// One frame.
struct FrameParameters {
    vec4 right;    // xyz: half the picture's width at view depth 1 m, world (metres, east north up); w: width in pixels
    vec4 up;       // xyz: half the picture's height, likewise; w: height in pixels
    vec4 forward;  // xyz: the view axis, unit; w: view depth that depth value 1 stands for, metres
    vec4 sun;      // xyz: towards the sun, unit, world
    vec4 viewScale;  // x: 1 / length of right, y: 1 / length of up, squared; z: most probes of a photo sample
    vec4 ground;     // rgb: linear colour of ground without photo
    vec4 bend;       // curved earth: height gained per squared metre, xyz: east east, east north, north north
    vec4 air;        // x: visual range at sea level, y: the eye's height above the sea, metres; z: height over world z
    vec4 part;       // what is drawn of the picture: x, y: its lower left corner, z: width, w: height, pixels
    vec4 partClip;   // from clip coordinates of the picture to those of the part: xy: scale, zw: shift, of w
};

// What a sky is made for.
struct SkyInput {
    vec4 air;   // x: visual range at sea level, metres
    vec4 view;  // x: sine of the sun's elevation; y: the eye's height above the sea, metres
};

// The sky of a moment, beside its table. Colours linear, as they are shown.
struct SkyParameters {
    vec4 shown;                        // rgb: per unit of sunlight above the air; w: elevation of the horizon, radians
    vec4 disc;                         // rgb: the sun's disc at its centre
    vec4 night;                        // rgb: radiance of the night sky, per unit of sunlight above the air
    vec4 sunLight[TERRAY_SKY_LIGHTS];  // rgb: on ground that faces the sun, at each height
    vec4 skyLight[TERRAY_SKY_LIGHTS];  // rgb: on level ground
};

// One cell of the tree that shadow rays walk; the first is the root.
struct ShadowCell {
    uvec4 children;  // cells: north-west, north-east, south-west, south-east; 0: nothing there
    uvec4 source;    // x: draw node of a leaf, or TERRAY_NO_NODE
    vec4 bounds;     // x: the highest of its ground, metres above the eye
};

// The shadow rays of one frame. Finest cell: of the deepest level among the draw nodes.
struct ShadowParameters {
    uvec4 grid;  // xy: column and row of the finest cell that the eye is in, two's complement; z: levels below the root
    vec4 place;  // xy: the eye within that cell, 0 .. 1, x east, y south; z: its side, metres; w: the highest of all
                 // ground, metres above the eye
    vec4 sun;    // x: tangent of half the sun's angular diameter; y: rays for each pixel
};

// What shading modes measure by.
struct ShadingParameters {
    vec4 heights;  // x: lowest, y: highest of the dataset, z: between contour lines, metres; w: tolerance of errors,
                   // pixels
};

// What methods other than the pyramid's search by (MethodOptions); each reads its own.
struct MethodParameters {
    vec4 linear;    // x: least, y: most samples of a ray's way through a box; z: halvings
    vec4 hull;      // x: steps, y: more and longer steps; z: stride, in tiles, < 0: exponential; w: secant steps
    vec4 hullMore;  // x: length of the longer steps, in strides
    vec4 cones;     // x: steps, y: reach in blocks, z: halvings
};

// In double, so that a sample's height depends on its place in the dataset and not on the tile that holds it.
#if defined(__cplusplus) || defined(TERRAY_EDITS)
// One edit, see common/terrain_edit.h.
struct EditParameters {
    dvec4 shape;  // x: radius, y: full, z: height, w: rim; metres
    dvec4 line;   // x: TERRAY_EDIT_..., y: its first segment, z: one past its last, w: its reach, metres
};

// The tile that is edited.
struct EditedTileParameters {
    dvec4 samples;  // xy: column and row of texel (0, 0) in the grid of its level, z: metres between samples, w: slot
    dvec4 ground;   // xy: the root square's west and north, metres; z: number of edits
    dvec4 codes;    // xy: offset and metres per code as stored; zw: as edited
};
#endif

#ifdef __cplusplus
static_assert(sizeof(EditParameters) == 2 * 32);
static_assert(sizeof(EditedTileParameters) == 3 * 32);
static_assert(sizeof(ShadingParameters) == 16);
static_assert(sizeof(MethodParameters) == 4 * 16);
static_assert(sizeof(SkyParameters) == (3 + 2 * TERRAY_SKY_LIGHTS) * 16);
static_assert(sizeof(ShadowCell) == 3 * 16);
static_assert(sizeof(ShadowParameters) == 3 * 16);
static_assert(sizeof(NodeParameters) == 8 * 16);
static_assert(sizeof(FrameParameters) == 10 * 16);
}  // namespace terray::interop
#endif

#endif
