#include "client/render/draw_costs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include "client/render/node_parameters.h"
#include "common/check.h"

namespace terray {
namespace {

/// Steps of a ray through a node's box. It goes down from the start level once, and then climbs and goes down again in
/// proportion to the logarithm of the samples that it passes over (paper 000, section 2), of which a ray through the
/// box's middle stands for all.
double expectedSteps(const interop::NodeParameters& node) {
    const glm::dvec3 least(node.boxMin), most(node.boxMax);
    const glm::dvec3 toMiddle = 0.5 * (least + most) - glm::dvec3(node.eye);
    const double along = std::hypot(toMiddle.x, toMiddle.y);
    const double side = most.x - least.x;
    const double fall = std::abs(toMiddle.z);
    const double samples = fall > 0 ? std::min(side, (most.z - least.z) * along / fall) : side;
    const auto start = static_cast<double>(node.source.w & TERRAY_START_LEVEL_MASK);
    return 1 + start + 2 * std::log2(1 + samples);
}

/// A weighed sample of one way: features and the time that they took.
struct Equation {
    glm::dvec3 features;
    double milliseconds;  ///< of the node
    double weight;        ///< one over the whole frame's
};

/// Squares of relative errors.
double misfit(std::span<const Equation> equations, const glm::dvec3& costs) {
    double sum = 0;
    for (const Equation& e : equations) {
        const double error = e.weight * (glm::dot(e.features, costs) - e.milliseconds);
        sum += error * error;
    }
    return sum;
}

/// Least squares over the features of a mask alone; the others cost nothing.
glm::dvec3 solved(std::span<const Equation> equations, unsigned mask) {
    glm::dmat3 matrix(0);
    glm::dvec3 right(0);
    for (int i = 0; i < 3; ++i) {
        if ((mask >> i & 1) == 0) matrix[i][i] = 1;
    }
    for (const Equation& e : equations) {
        glm::dvec3 row = e.weight * e.features;
        for (int i = 0; i < 3; ++i)
            if ((mask >> i & 1) == 0) row[i] = 0;
        matrix += glm::outerProduct(row, row);
        right += e.weight * e.milliseconds * row;
    }
    return glm::inverse(matrix) * right;
}

/// With three costs all sets of those that are not zero can be tried.
glm::dvec3 fitted(std::span<const Equation> equations) {
    glm::dvec3 best(0);
    double least = std::numeric_limits<double>::infinity();
    for (unsigned mask = 1; mask < 8; ++mask) {
        const glm::dvec3 costs = solved(equations, mask);
        if (!(costs.x >= 0 && costs.y >= 0 && costs.z >= 0)) continue;  // NaN where features do not tell them apart
        const double sum = misfit(equations, costs);
        if (sum < least) {
            least = sum;
            best = costs;
        }
    }
    return best;
}

}  // namespace

NodeWork workOf(const interop::NodeParameters& node, const View& view, uint64_t triangles, bool isMade) {
    return {.pixels = coveredPixels(node, view),
            .steps = expectedSteps(node),
            .triangles = static_cast<double>(triangles),
            .isMade = isMade};
}

DrawCosts fittedCosts(std::span<const CostSample> samples) {
    TERRAY_CHECK(!samples.empty());
    std::vector<Equation> cast, mesh;
    double makeMs = 0;
    for (const CostSample& sample : samples) {
        const NodeWork& work = sample.work;
        const auto equation = [&](const glm::dvec3& features, double milliseconds) {
            return Equation{features, milliseconds - sample.emptyMs, 1 / milliseconds};
        };
        cast.push_back(equation({1, work.pixels, work.pixels * work.steps}, sample.castMs));
        mesh.push_back(equation({1, work.pixels, work.triangles}, sample.meshMs));
        makeMs += sample.makeMs;
    }
    const glm::dvec3 rays = fitted(cast), triangles = fitted(mesh);
    return {.castNode = rays.x,
            .castPixel = rays.y,
            .castStep = rays.z,
            .meshNode = triangles.x,
            .meshPixel = triangles.y,
            .meshTriangle = triangles.z,
            .meshMake = makeMs / static_cast<double>(samples.size())};
}

std::vector<uint8_t> HybridChoice::choose(std::span<const DrawNode> nodes, std::span<const NodeWork> work,
                                          const DrawCosts& costs) {
    TERRAY_CHECK_OP(nodes.size(), ==, work.size());
    std::vector<uint8_t> choice(nodes.size());
    std::unordered_map<TileId, bool> chosen;
    for (size_t n = 0; n < nodes.size(); ++n) {
        const double cast = costs.castMs(work[n]), mesh = costs.meshMs(work[n]);
        const auto found = rasterised_.find(nodes[n].cell);
        const bool before = found != rasterised_.end() && found->second;
        bool rasterised = before ? !(cast < kWorthAChange * mesh) : mesh < kWorthAChange * cast;
        if (!work[n].isMade) {
            double& sum = missed_[nodes[n].heightTile];
            if (rasterised) sum += cast - mesh;
            rasterised = rasterised && sum >= costs.meshMake;
        } else {
            missed_.erase(nodes[n].heightTile);
        }
        choice[n] = rasterised ? 1 : 0;
        chosen.emplace(nodes[n].cell, rasterised);
    }
    rasterised_ = std::move(chosen);
    if (missed_.size() > kMostMissed) missed_.clear();
    return choice;
}

}  // namespace terray
