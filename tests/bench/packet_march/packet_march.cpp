#include "tests/bench/packet_march/packet_march.h"

#include <algorithm>
#include <array>

#include "common/check.h"

namespace terray {

#if TERRAY_PACKET_AVX2
extern const PacketKernel kAvx2Kernel;  // kernel_avx2.cpp

const PacketKernel* avx2Kernel() {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? &kAvx2Kernel : nullptr;
}
#else
const PacketKernel* avx2Kernel() {
    return nullptr;
}
#endif

const PacketKernel& bestKernel() {
    const PacketKernel* const avx2 = avx2Kernel();
    return avx2 != nullptr ? *avx2 : portableKernel();
}

CastWork& CastWork::operator+=(const CastWork& other) {
    beamSteps += other.beamSteps;
    pyramidSteps += other.pyramidSteps;
    patchSteps += other.patchSteps;
    return *this;
}

namespace {

int tilesAcross(const PictureRays& rays) {
    return (rays.width + kTileWidth - 1) / kTileWidth;
}

}  // namespace

MapRay pixelRay(const PictureRays& rays, int64_t x, int64_t y) {
    return {rays.eye, rays.first + static_cast<float>(x) * rays.right + static_cast<float>(y) * rays.down};
}

int tileCount(const PictureRays& rays) {
    return tilesAcross(rays) * ((rays.height + kTileHeight - 1) / kTileHeight);
}

GridRect tileRect(const PictureRays& rays, int tile) {
    const int64_t left = int64_t{tile % tilesAcross(rays)} * kTileWidth;
    const int64_t top = int64_t{tile / tilesAcross(rays)} * kTileHeight;
    return intersection({left, top, kTileWidth, kTileHeight}, {0, 0, rays.width, rays.height});
}

CastWork castPictureTile(const PacketKernel& kernel, const HeightPyramid& pyramid, const PictureRays& rays, int tile,
                         bool beams, GridView<float> depths) {
    TERRAY_CHECK(depths.size() == (GridSize{rays.width, rays.height}));
    const GridRect inside = tileRect(rays, tile);
    CastWork work;
    std::array<float, static_cast<size_t>(kTileWidth) * kTileHeight> cast;
    kernel.castTile(pyramid.view(), rays, static_cast<int>(inside.x), static_cast<int>(inside.y), beams, cast.data(),
                    work);
    const GridView<const float> rows(cast.data(), {kTileWidth, kTileHeight});
    for (int64_t y = 0; y < inside.height; ++y)
        std::ranges::copy(rows.row(y).first(static_cast<size_t>(inside.width)), depths.window(inside).row(y).begin());
    return work;
}

void castRays(const PacketKernel& kernel, const HeightPyramid& pyramid, std::span<const MapRay> rays,
              std::span<float> t) {
    constexpr size_t kEight = 8;
    TERRAY_CHECK_OP(rays.size(), ==, t.size());
    for (size_t i = 0; i < rays.size(); i += kEight) {
        // The last packet is filled up with its first ray.
        const size_t count = std::min(kEight, rays.size() - i);
        std::array<MapRay, kEight> packet;
        for (size_t lane = 0; lane < kEight; ++lane) packet[lane] = rays[i + (lane < count ? lane : 0)];
        std::array<float, kEight> found;
        kernel.castEight(pyramid.view(), packet.data(), found.data());
        std::copy_n(found.begin(), count, t.begin() + static_cast<std::ptrdiff_t>(i));
    }
}

}  // namespace terray
