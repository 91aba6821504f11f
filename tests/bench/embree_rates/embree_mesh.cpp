#include "tests/bench/embree_rates/embree_mesh.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>

#include <immintrin.h>

#include "common/check.h"
#include "common/error.h"
#include "tests/bench/packet_march/packet_march.h"

namespace terray {
namespace {

void throwOnError(RTCDevice device, const char* attempt) {
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE)
        throw Error(ExitCode::internal, std::string("Embree cannot ") + attempt + ": error " + std::to_string(error));
}

std::vector<float> worldVertices(const Ground& ground) {
    std::vector<float> vertices;
    vertices.reserve(3 * static_cast<size_t>(ground.codes.size().count()) + 1);
    for (int64_t y = 0; y < ground.codes.height(); ++y)
        for (int64_t x = 0; x < ground.codes.width(); ++x) {
            const glm::dvec3 place = ground.worldFromMap(
                {static_cast<double>(x), static_cast<double>(y), static_cast<double>(ground.codes.at(x, y))});
            for (int axis = 0; axis < 3; ++axis) vertices.push_back(static_cast<float>(place[axis]));
        }
    vertices.push_back(0);  // Embree reads vertices 16 bytes at a time
    return vertices;
}

/// Embree asks for both; they are settings of a thread.
void flushDenormals() {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}

/// Rays through the pixels of a rectangle whose upper left one is (left, top), in Embree's layout for Columns * Rows.
template <int Columns, int Rows>
RTCRayHitNt<Columns * Rows> packetThrough(const PictureRays& rays, int64_t left, int64_t top) {
    RTCRayHitNt<Columns * Rows> packet;
    for (int lane = 0; lane < Columns * Rows; ++lane) {
        const auto x = static_cast<float>(left + lane % Columns);
        const auto y = static_cast<float>(top + lane / Columns);
        packet.ray.org_x[lane] = rays.eye.x;
        packet.ray.org_y[lane] = rays.eye.y;
        packet.ray.org_z[lane] = rays.eye.z;
        packet.ray.tnear[lane] = 0;
        packet.ray.dir_x[lane] = rays.first.x + x * rays.right.x + y * rays.down.x;
        packet.ray.dir_y[lane] = rays.first.y + x * rays.right.y + y * rays.down.y;
        packet.ray.dir_z[lane] = rays.first.z + x * rays.right.z + y * rays.down.z;
        packet.ray.time[lane] = 0;
        packet.ray.tfar[lane] = std::numeric_limits<float>::infinity();
        packet.ray.mask[lane] = ~0U;
        packet.ray.id[lane] = 0;
        packet.ray.flags[lane] = 0;
        packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    return packet;
}

/// Casts the pixels of `inside` in packets; intersect(valid, packet) asks Embree.
template <int Columns, int Rows, class Intersect>
void castPackets(const PictureRays& rays, const GridRect& inside, GridView<float> depths, Intersect intersect) {
    const int64_t right = inside.x + inside.width;
    const int64_t bottom = inside.y + inside.height;
    for (int64_t top = inside.y; top < bottom; top += Rows)
        for (int64_t left = inside.x; left < right; left += Columns) {
            alignas(64) RTCRayHitNt<Columns* Rows> packet = packetThrough<Columns, Rows>(rays, left, top);
            alignas(64) std::array<int, static_cast<size_t>(Columns) * Rows> valid;
            for (int lane = 0; lane < Columns * Rows; ++lane)
                valid[lane] = left + lane % Columns < right && top + lane / Columns < bottom ? -1 : 0;
            intersect(valid.data(), &packet);
            for (int row = 0; row < Rows && top + row < bottom; ++row) {
                const auto out = depths.row(top + row).subspan(left, std::min<int64_t>(Columns, right - left));
                std::copy_n(packet.ray.tfar + static_cast<ptrdiff_t>(row) * Columns, out.size(), out.begin());
            }
        }
}

}  // namespace

bool EmbreeMesh::countBytes(void* mesh, ssize_t bytes, bool) {
    auto& self = *static_cast<EmbreeMesh*>(mesh);
    const int64_t now = self.bytes_ += bytes;
    int64_t peak = self.peakBytes_;
    while (now > peak && !self.peakBytes_.compare_exchange_weak(peak, now)) {
    }
    return true;
}

EmbreeMesh::EmbreeMesh(const Ground& ground, const EmbreeSetup& setup)
    : setup_(setup), vertices_(worldVertices(ground)) {
    std::string config = "threads=" + std::to_string(setup.threads);
    if (!setup.isa.empty()) config += ",isa=" + setup.isa;
    device_ = rtcNewDevice(config.c_str());
    if (device_ == nullptr) throwOnError(nullptr, "open a device");
    rtcSetDeviceMemoryMonitorFunction(device_, countBytes, this);

    scene_ = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(scene_, setup.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    const RTCGeometry grid = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_GRID);
    const GridSize size = ground.codes.size();
    rtcSetSharedGeometryBuffer(grid, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_.data(), 0,
                               3 * sizeof(float), static_cast<size_t>(size.count()));
    auto* const description = static_cast<RTCGrid*>(
        rtcSetNewGeometryBuffer(grid, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof(RTCGrid), 1));
    throwOnError(device_, "make a grid");
    *description = {0, static_cast<unsigned>(size.width), static_cast<uint16_t>(size.width),
                    static_cast<uint16_t>(size.height)};
    const auto begin = std::chrono::steady_clock::now();
    rtcCommitGeometry(grid);
    rtcAttachGeometry(scene_, grid);
    rtcReleaseGeometry(grid);
    rtcCommitScene(scene_);
    buildSeconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    throwOnError(device_, "build the scene");
}

EmbreeMesh::~EmbreeMesh() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

int64_t EmbreeMesh::vertexBytes() const {
    return static_cast<int64_t>(vertices_.size() * sizeof(float));
}

void EmbreeMesh::castTile(const EmbreeCall& call, const PictureRays& rays, int tile, GridView<float> depths) const {
    flushDenormals();
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = call.coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    const GridRect inside = tileRect(rays, tile);
    switch (call.width) {
        case 16:
            return castPackets<4, 4>(rays, inside, depths, [&](const int* valid, void* packet) {
                rtcIntersect16(valid, scene_, &context, static_cast<RTCRayHit16*>(packet));
            });
        case 8:
            return castPackets<4, 2>(rays, inside, depths, [&](const int* valid, void* packet) {
                rtcIntersect8(valid, scene_, &context, static_cast<RTCRayHit8*>(packet));
            });
        default:
            TERRAY_CHECK_OP(call.width, ==, 1);
            return castPackets<1, 1>(rays, inside, depths, [&](const int*, void* packet) {
                rtcIntersect1(scene_, &context, static_cast<RTCRayHit*>(packet));
            });
    }
}

}  // namespace terray
