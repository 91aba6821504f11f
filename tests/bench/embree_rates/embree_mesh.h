#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <embree3/rtcore.h>

#include "tests/bench/embree_rates/ground.h"
#include "tests/bench/packet_march/picture_rays.h"

namespace terray {

/// How Embree is set up for a mesh; what is not named here is fixed to its fastest: high build quality, one grid.
struct EmbreeSetup {
    std::string isa;      ///< "" takes the best that this machine has; "avx2"
    bool robust = false;  ///< watertight at a cost
    int threads = 2;      ///< for the build
};

/// How rays are handed to Embree.
struct EmbreeCall {
    int width = 8;         ///< rays a call: 1, 8 or 16
    bool coherent = true;  ///< says that they run alike
};

/// A ground as Embree's grid geometry: each cell is two triangles, which meet the bilinear surface at the cell's border
/// and differ from it by up to a quarter of the cell's twist within.
class EmbreeMesh {
  public:
    /// Builds. Throws Error(internal) with Embree's own words when that fails.
    EmbreeMesh(const Ground& ground, const EmbreeSetup& setup);
    ~EmbreeMesh();
    EmbreeMesh(const EmbreeMesh&) = delete;
    EmbreeMesh& operator=(const EmbreeMesh&) = delete;

    [[nodiscard]] const EmbreeSetup& setup() const { return setup_; }
    [[nodiscard]] double buildSeconds() const { return buildSeconds_; }
    /// What Embree allocated for the scene, by its own account: at the end, and at most while it built.
    [[nodiscard]] int64_t bytes() const { return bytes_; }
    [[nodiscard]] int64_t peakBytes() const { return peakBytes_; }
    /// The vertices, which it reads where they are and goes on needing.
    [[nodiscard]] int64_t vertexBytes() const;

    /// Casts a tile of a picture (as castPictureTile): packets of 4 x 2 or 4 x 4 pixels. rays: in the world.
    void castTile(const EmbreeCall& call, const PictureRays& rays, int tile, GridView<float> depths) const;

  private:
    static bool countBytes(void* mesh, ssize_t bytes, bool post);

    EmbreeSetup setup_;
    std::vector<float> vertices_;
    std::atomic<int64_t> bytes_ = 0;
    std::atomic<int64_t> peakBytes_ = 0;
    double buildSeconds_ = 0;
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
};

}  // namespace terray
