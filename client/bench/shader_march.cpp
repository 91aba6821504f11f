#include "client/bench/shader_march.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <thread>
#include <type_traits>

#include "client/render/frame_targets.h"
#include "client/render/node_parameters.h"
#include "common/error.h"
#include "common/parallel.h"
#include "shaders/math/precision.h"

namespace terray {
namespace {

/// A ray through a node's tile, mirrored so that it never runs towards smaller x or y: shaders/ray.glsl. Functions are
/// named as there.
template <class Math>
class MarchedRay {
  public:
    using real = typename Math::real;
    using vec2 = typename Math::vec2;
    using vec3 = typename Math::vec3;
    using ivec2 = typename Math::ivec2;
    using Contact = std::optional<real>;

    MarchedRay(const MarchedNode& node, const vec3& direction) : node_(node) {
        vec3 eye(node.eye);
        if (std::is_same_v<real, float>) eye = vec3(onFloatGrid(glm::dvec2(node.eye)), node.eye.z);
        mirrored_ = {direction.x < 0, direction.y < 0};
        direction_ = {std::abs(direction.x), std::abs(direction.y), direction.z};
        eye_ = {mirrored_[0] ? kCore - eye.x : eye.x, mirrored_[1] ? kCore - eye.y : eye.y, eye.z};
        inverse_ = {Math::safeInverse(direction_.x), Math::safeInverse(direction_.y), Math::safeInverse(direction_.z)};
        if (!node.curved) return;
        const auto spacing = static_cast<real>(node.spacing);
        bend_ = Math::earthDrop(vec3(node.bend), direction.x * spacing, -direction.y * spacing) /
                static_cast<real>(node.step);
        lowest_ = Math::lowestTime(direction_.z, bend_);
    }

    /// View depth of the first hit: marchNode() of shaders/march.glsl. @param steps  raised as there
    [[nodiscard]] Contact march(uint32_t& steps) const {
        const auto [boxMin, boxMax] = mirroredBox();
        const auto box = clipped(boxMin, boxMax);
        if (!(box.enter <= box.exit)) return {};
        const ivec2 last(static_cast<int>(std::ceil(boxMax.x)) - 1, static_cast<int>(std::ceil(boxMax.y)) - 1);
        const ivec2 first(static_cast<int>(std::floor(boxMin.x)), static_cast<int>(std::floor(boxMin.y)));
        ivec2 cell(std::clamp(static_cast<int>(std::floor(eye_.x + box.enter * direction_.x)), first.x, last.x),
                   std::clamp(static_cast<int>(std::floor(eye_.y + box.enter * direction_.y)), first.y, last.y));
        const int leaf = node_.bilinear ? 1 : 0;
        int level = node_.startLevel;
        uint32_t count = 0;
        const auto finished = [&](Contact contact) {
            steps += count;
            return contact;
        };
        for (real t = box.enter;; ++count) {
            if (count >= (node_.bilinear ? kMaxPatchSteps : kMaxColumnSteps)) {
                steps |= kOutOfStepsBit;
                return finished({});
            }
            const ivec2 edge = Math::blockEdge(cell, level);
            const vec2 times = Math::edgeTimes(edge, vec2(eye_.x, eye_.y), vec2(inverse_.x, inverse_.y));
            const real leave = std::max(t, std::min({times.x, times.y, box.exit}));
            Contact contact = overBlock(cell, level, t, leave);
            if (contact && level > leaf) {
                t = *contact;
                cell = Math::cellAt(t, cell, edge, vec2(eye_.x, eye_.y), vec2(direction_.x, direction_.y));
                --level;
                continue;
            }
            if (contact && node_.bilinear) contact = overPatches(edge, t, leave, count);
            if (contact) return finished(contact);
            if (leave >= box.exit) return finished({});
            cell = Math::cellAfter(cell, edge, times, vec2(eye_.x, eye_.y), vec2(direction_.x, direction_.y));
            if (cell.x > last.x || cell.y > last.y) return finished({});
            level = std::max(Math::levelAfter(level, node_.startLevel, edge, times), leaf);
            t = leave;
        }
    }

    /// Tile frame, not mirrored: rayPoint() of shaders/nodes.glsl. @param direction  as given to the constructor
    [[nodiscard]] vec3 point(const vec3& direction, real t) const {
        vec3 at = vec3(node_.eye) + t * direction;
        if (node_.curved) at.z += t * t * bend_;
        return at;
    }

  private:
    static constexpr real kCore = kTileCore;
    // kMaxSteps of shaders/march.glsl.
    static constexpr uint32_t kMaxColumnSteps = 1024 + 1032 + 1;
    static constexpr uint32_t kMaxPatchSteps = 1024 + 1032 + 512 * 6 + 1;

    [[nodiscard]] std::pair<vec3, vec3> mirroredBox() const {
        vec3 low(node_.boxMin), high(node_.boxMax);
        if (mirrored_[0]) std::tie(low.x, high.x) = std::pair(kCore - high.x, kCore - low.x);
        if (mirrored_[1]) std::tie(low.y, high.y) = std::pair(kCore - high.y, kCore - low.y);
        return {low, high};
    }

    [[nodiscard]] real height(real t) const { return Math::bentHeight(eye_.z, direction_.z, bend_, t); }
    [[nodiscard]] real slope(real t) const { return Math::bentSlope(direction_.z, bend_, t); }

    [[nodiscard]] typename Math::Interval clipped(const vec3& boxMin, const vec3& boxMax) const {
        if (!node_.curved) return Math::boxInterval(eye_, inverse_, boxMin, boxMax);
        const real everywhere = 1e30F;
        auto span = Math::boxInterval({eye_.x, eye_.y, 0}, {inverse_.x, inverse_.y, 1},
                                      {boxMin.x, boxMin.y, -everywhere}, {boxMax.x, boxMax.y, everywhere});
        const real above = height(span.enter) - boxMin.z;
        if (above < 0) {
            span.enter += Math::riseTime({bend_, slope(span.enter), above});
        } else if (const Contact sinks = blockContact(boxMin.z, span.enter, span.exit)) {
            span.exit = *sinks;
        }
        return span;
    }

    [[nodiscard]] Contact blockContact(real top, real enter, real leave) const {
        if (node_.curved) {
            if (!Math::bentMeetsColumn(top, eye_.z, direction_.z, bend_, lowest_, enter, leave)) return {};
            return Math::bentColumnTime(top, eye_.z, direction_.z, bend_, enter, leave);
        }
        if (!Math::meetsColumn(top, eye_.z, direction_.z, enter, leave)) return {};
        return Math::columnTime(top, eye_.z, direction_.z, inverse_.z, enter, leave);
    }

    [[nodiscard]] Contact overBlock(const ivec2& cell, int level, real enter, real leave) const {
        const int last = (kTileCore >> level) - 1;
        const ivec2 block(cell.x >> level, cell.y >> level);
        const uint16_t top = node_.tile->blockMaximum(mirrored_[0] ? last - block.x : block.x,
                                                      mirrored_[1] ? last - block.y : block.y, level);
        if (top == kNoSurface) return {};
        return blockContact(top, enter, leave);
    }

    [[nodiscard]] real sampleCode(int x, int y) const {
        return node_.tile->codeAt(mirrored_[0] ? kTileCore - 1 - x : x, mirrored_[1] ? kTileCore - 1 - y : y);
    }

    /// patchContact() of shaders/patches.glsl.
    [[nodiscard]] Contact overPatches(const ivec2& edge, real enter, real leave, uint32_t& steps) const {
        constexpr int kPatchesOfBlock = 5;
        const auto start = [&](real eye, real direction, int end) {
            return std::clamp(static_cast<int>(std::floor(eye + enter * direction - real{0.5F})), end - 3, end - 1);
        };
        ivec2 corner(start(eye_.x, direction_.x, edge.x), start(eye_.y, direction_.y, edge.y));
        for (int i = 0; i < kPatchesOfBlock; ++i, ++steps) {
            const vec2 times((static_cast<real>(corner.x) + real{1.5F} - eye_.x) * inverse_.x,
                             (static_cast<real>(corner.y) + real{1.5F} - eye_.y) * inverse_.y);
            const real exit = std::clamp(std::min(times.x, times.y), enter, leave);
            if (const Contact contact = overPatch(corner, enter, exit)) return contact;
            if (exit >= leave) break;
            (times.x <= times.y ? corner.x : corner.y) += 1;
            enter = exit;
        }
        return {};
    }

    [[nodiscard]] Contact overPatch(const ivec2& corner, real enter, real exit) const {
        const std::array<real, 4> codes{sampleCode(corner.x, corner.y), sampleCode(corner.x + 1, corner.y),
                                        sampleCode(corner.x, corner.y + 1), sampleCode(corner.x + 1, corner.y + 1)};
        const auto count = static_cast<real>(4 - std::count(codes.begin(), codes.end(), real{0}));
        if (count == 0) return {};
        std::array<real, 4> heights = codes;
        std::replace(heights.begin(), heights.end(), real{0}, (codes[0] + codes[1] + codes[2] + codes[3]) / count);
        const auto inside = [](real at) { return std::clamp(at, real{0}, real{1}); };
        const vec3 local(inside(eye_.x + enter * direction_.x - static_cast<real>(corner.x) - real{0.5F}),
                         inside(eye_.y + enter * direction_.y - static_cast<real>(corner.y) - real{0.5F}),
                         height(enter));
        const vec3 direction(direction_.x, direction_.y, slope(enter));
        const auto clearance =
            Math::patchClearance({heights[0], heights[1], heights[2], heights[3]}, local, direction, bend_);
        const real span = exit - enter;
        const real contact = count == 4 ? Math::firstContact(clearance, span)
                                        : quarterContact(clearance, codes, vec2(local.x, local.y), span);
        if (contact < 0) return {};
        return std::min(enter + contact, exit);
    }

    /// quarterContact() of shaders/patches.glsl.
    [[nodiscard]] real quarterContact(const typename Math::Clearance& clearance, const std::array<real, 4>& codes,
                                      const vec2& at, real span) const {
        ivec2 quarter(at.x >= real{0.5F} ? 1 : 0, at.y >= real{0.5F} ? 1 : 0);
        real s = 0;
        for (int i = 0; i < 3; ++i) {
            const auto crossing = [&](real from, real direction, int where) {
                return where == 1 ? span : (real{0.5F} - from) / std::max(direction, real{1e-30F});
            };
            const vec2 ends(crossing(at.x, direction_.x, quarter.x), crossing(at.y, direction_.y, quarter.y));
            const real end = std::clamp(std::min(ends.x, ends.y), s, span);
            if (codes[static_cast<size_t>(quarter.x + 2 * quarter.y)] > 0) {
                const real contact = Math::firstContact(
                    {clearance.bend, clearance.slope + 2 * clearance.bend * s, Math::clearanceAt(clearance, s)},
                    end - s);
                if (contact >= 0) return s + contact;
            }
            if (end >= span) break;
            (ends.x <= ends.y ? quarter.x : quarter.y) = 1;
            s = end;
        }
        return -1;
    }

    const MarchedNode& node_;
    vec3 eye_;
    vec3 direction_;
    vec3 inverse_;
    std::array<bool, 2> mirrored_;
    real bend_ = 0;
    real lowest_ = 0;
};

/// What a pixel shows: rayDirection() of shaders/nodes.glsl, then node after node until the first hit.
template <class Math>
DrawnPixel drawPixel(const std::vector<DrawNode>& drawn, const std::vector<MarchedNode>& nodes, const Tiling& tiling,
                     const View& view, const glm::ivec2& pixel, uint32_t& steps) {
    using real = typename Math::real;
    using vec3 = typename Math::vec3;
    // gl_FragCoord counts rows from the bottom.
    const real x = 2 * (static_cast<real>(pixel.x) + real{0.5F}) / static_cast<real>(view.width) - 1;
    const real y = 2 * (static_cast<real>(view.height - 1 - pixel.y) + real{0.5F}) / static_cast<real>(view.height) - 1;
    for (size_t n = 0; n < nodes.size(); ++n) {
        const MarchedNode& node = nodes[n];
        const vec3 direction = vec3(node.forward) + x * vec3(node.right) + y * vec3(node.up);
        const MarchedRay<Math> ray(node, direction);
        const std::optional<real> t = ray.march(steps);
        if (!t) continue;
        return {.ground = true,
                .depth = *t,
                .place = worldFromTile(drawn[n].heightTile, node.tile->stored.encoding, tiling,
                                       glm::dvec3(ray.point(direction, *t)))};
    }
    return {};
}

}  // namespace

std::vector<DrawnPixel> ShaderMarch::draw(const std::vector<DrawNode>& nodes, const View& view, Surface surface,
                                          Precision precision, std::span<const glm::ivec2> pixels,
                                          std::span<uint32_t> steps) {
    TERRAY_CHECK(steps.empty() || steps.size() == pixels.size());
    constexpr size_t kAtATime = 256;
    const Tiling& tiling = source_.metadata().tiling;
    std::vector<MarchedNode> marched;
    marched.reserve(nodes.size());
    for (const DrawNode& node : nodes) marched.emplace_back(node, tile(node.heightTile), tiling, view, surface);
    std::vector<DrawnPixel> drawn(pixels.size());
    const std::atomic<bool> never = false;
    const auto cores = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
    const auto one = precision == Precision::single ? drawPixel<math::Single> : drawPixel<math::Double>;
    forEachParallel((pixels.size() + kAtATime - 1) / kAtATime, cores, never, [&](int, size_t part) {
        const size_t end = std::min((part + 1) * kAtATime, pixels.size());
        for (size_t n = part * kAtATime; n < end; ++n) {
            uint32_t taken = 0;
            drawn[n] = one(nodes, marched, tiling, view, pixels[n], taken);
            if (!steps.empty()) steps[n] = taken;
        }
    });
    return drawn;
}

const MarchedTile& ShaderMarch::tile(const TileId& id) {
    std::unique_ptr<const MarchedTile>& known = tiles_[id];
    if (known) return *known;
    const Result<Bytes> payload = source_.read(TileLayer::heights, id);
    Result<HeightTile> decoded = payload ? decodeHeightTile(*payload, id) : Result<HeightTile>(payload.failure());
    if (!decoded)
        throw Error(ExitCode::dataset, "cannot march height tile " + toString(id) + ": " + decoded.failure().message +
                                           " (terray-preprocess verify lists all damaged tiles)");
    known = std::make_unique<const MarchedTile>(std::move(*decoded));
    return *known;
}

}  // namespace terray
