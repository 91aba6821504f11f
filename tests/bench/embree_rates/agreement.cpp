#include "tests/bench/embree_rates/agreement.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/glm.hpp>

#include "tests/bench/packet_march/brute_force.h"

namespace terray {
namespace {

Errors errorsOf(std::vector<double> values) {
    if (values.empty()) return {};
    std::ranges::sort(values);
    return {values[values.size() / 2], values[values.size() * 99 / 100], values.back()};
}

/// Where a depth lies in the map frame, and the ground there.
struct HitPlace {
    double residual;  ///< metres above the bilinear surface
    double twist;     ///< metres: how far the cell's corners are from one plane
};

HitPlace hitPlace(const Ground& ground, glm::dvec3 eye, glm::dvec3 direction, double t) {
    const glm::dvec3 place = eye + t * direction;
    const auto codes = ground.codes.view();
    const auto x = std::clamp<int64_t>(static_cast<int64_t>(std::floor(place.x)), 0, codes.width() - 2);
    const auto y = std::clamp<int64_t>(static_cast<int64_t>(std::floor(place.y)), 0, codes.height() - 2);
    const int twist = codes.at(x, y) - codes.at(x + 1, y) - codes.at(x, y + 1) + codes.at(x + 1, y + 1);
    return {ground.quantum * (place.z - bilinearHeight(codes, place.x, place.y)), ground.quantum * std::abs(twist)};
}

}  // namespace

Agreement compareDepths(const Ground& ground, const View& view, GridView<const float> march,
                        GridView<const float> mesh) {
    constexpr double kRounding = 0.01;  // metres
    const AxisFrame frame = ground.mapFrame();
    const glm::dvec3 eye = (view.eye - frame.origin) * frame.scale;
    Agreement agreement;
    std::vector<double> depth;
    std::vector<double> marchResidual;
    std::vector<double> meshResidual;
    for (int64_t y = 0; y < march.height(); ++y)
        for (int64_t x = 0; x < march.width(); ++x) {
            ++agreement.pixels;
            const double a = march.at(x, y);
            const double b = mesh.at(x, y);
            agreement.onlyMarchHits += std::isfinite(a) && !std::isfinite(b) ? 1 : 0;
            agreement.onlyMeshHits += std::isfinite(b) && !std::isfinite(a) ? 1 : 0;
            if (!std::isfinite(a) || !std::isfinite(b)) continue;
            ++agreement.bothHit;
            depth.push_back(std::abs(a - b));
            const glm::dvec3 direction =
                view.direction(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5) * frame.scale;
            marchResidual.push_back(std::abs(hitPlace(ground, eye, direction, a).residual));
            const HitPlace place = hitPlace(ground, eye, direction, b);
            meshResidual.push_back(std::abs(place.residual));
            if (std::abs(place.residual) > place.twist / 4 + kRounding) ++agreement.unexplained;
        }
    agreement.depth = errorsOf(std::move(depth));
    agreement.marchResidual = errorsOf(std::move(marchResidual));
    agreement.meshResidual = errorsOf(std::move(meshResidual));
    return agreement;
}

Truth compareWithTruth(const Ground& ground, const View& view, GridView<const float> depths, int64_t count) {
    const PictureRays rays = pictureRays(view, ground.mapFrame());
    const int64_t pixels = depths.size().count();
    Truth truth;
    std::vector<double> depth;
    for (int64_t i = 0; i < count; ++i) {
        const int64_t pixel = i * pixels / count;
        const int64_t x = pixel % depths.width();
        const int64_t y = pixel / depths.width();
        const double exact = bruteForceHit(ground.codes.view(), pixelRay(rays, x, y));
        const double found = depths.at(x, y);
        ++truth.rays;
        if (std::isfinite(exact) != std::isfinite(found)) {
            ++truth.disagreements;
        } else if (std::isfinite(exact)) {
            depth.push_back(std::abs(found - exact));
        }
    }
    truth.depth = errorsOf(std::move(depth));
    return truth;
}

}  // namespace terray
