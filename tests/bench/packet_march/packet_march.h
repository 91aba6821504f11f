#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "common/grid.h"
#include "tests/bench/packet_march/height_pyramid.h"
#include "tests/bench/packet_march/picture_rays.h"

namespace terray {

/// A ray in the map frame (height_pyramid.h): P(t) = eye + t * direction, t >= 0; the direction needs no unit length.
struct MapRay {
    glm::vec3 eye;
    glm::vec3 direction;
};

/// Pixels that are cast in one call: eight beams of 8 x 8, four side by side.
inline constexpr int kTileWidth = 32;
inline constexpr int kTileHeight = 16;

/// What casting did, in steps of eight lanes each.
struct CastWork {
    int64_t beamSteps = 0;
    int64_t pyramidSteps = 0;
    int64_t patchSteps = 0;

    CastWork& operator+=(const CastWork& other);
};

/// The march over eight rays at a time, compiled for one instruction set.
///
/// Finds the first contact with the bilinear surface of a HeightPyramid, as shaders/march.glsl does: by its maxima, in
/// the frame that is mirrored for each ray, cells as integers, solid ground (a ray that enters the map below the
/// surface hits where it enters; one that runs along the map's border only may hit or miss). Depths are t of the hit,
/// infinity without. All functions may run in many threads at once.
struct PacketKernel {
    const char* name;
    /// Depths of a picture's tile whose upper left pixel is (x, y), into kTileHeight rows of kTileWidth. It may reach
    /// beyond the picture; rays are cast there all the same.
    /// @param beams  skip what is empty for 8 x 8 rays together (beams.h); else each ray starts at the eye
    void (*castTile)(const PyramidView& pyramid, const PictureRays& rays, int x, int y, bool beams, float* depths,
                     CastWork& work);
    /// t of eight rays that need have nothing in common.
    void (*castEight)(const PyramidView& pyramid, const MapRay* rays, float* t);
};

/// For every processor.
[[nodiscard]] const PacketKernel& portableKernel();
/// For AVX2 and FMA; null when this machine, or the compiler that built this, has none.
[[nodiscard]] const PacketKernel* avx2Kernel();
/// The fastest that runs here.
[[nodiscard]] const PacketKernel& bestKernel();

/// The ray of pixel (x, y) as the kernels make it, but for rounding.
[[nodiscard]] MapRay pixelRay(const PictureRays& rays, int64_t x, int64_t y);
/// Tiles of a picture, row by row.
[[nodiscard]] int tileCount(const PictureRays& rays);
/// The pixels of tile 0 .. tileCount - 1 that the picture has.
[[nodiscard]] GridRect tileRect(const PictureRays& rays, int tile);
/// Casts a tile into its part of a picture of depths.
CastWork castPictureTile(const PacketKernel& kernel, const HeightPyramid& pyramid, const PictureRays& rays, int tile,
                         bool beams, GridView<float> depths);
/// Casts any number of rays, `t` of the same number.
void castRays(const PacketKernel& kernel, const HeightPyramid& pyramid, std::span<const MapRay> rays,
              std::span<float> t);

}  // namespace terray
