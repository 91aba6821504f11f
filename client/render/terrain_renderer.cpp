#include "client/render/terrain_renderer.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <glm/geometric.hpp>

#include "client/render/node_parameters.h"
#include "common/check.h"
#include "common/imagery_tile.h"
#include "shaders/interop.h"

namespace terray {
namespace {

float linearFromSrgb(uint8_t value) {
    const double c = value / 255.0;
    return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

interop::FrameParameters frameParameters(const View& view, const RenderOptions& options) {
    const auto pack = [](const glm::dvec3& v, double w) { return glm::vec4(glm::vec3(v), static_cast<float>(w)); };
    interop::FrameParameters out;
    out.right = pack(view.right * view.tanHalfWidth(), view.width);
    out.up = pack(view.up * view.tanHalfHeight, view.height);
    out.forward = pack(view.forward, options.nearMetres);
    out.sun = pack(glm::normalize(options.sunDirection), 0);
    const double wide = view.tanHalfWidth();
    out.viewScale = glm::vec4(1 / (wide * wide), 1 / (view.tanHalfHeight * view.tanHalfHeight), options.anisotropy, 0);
    out.ground = glm::vec4(linearFromSrgb(kNeutralGround[0]), linearFromSrgb(kNeutralGround[1]),
                           linearFromSrgb(kNeutralGround[2]), 1);
    const EarthCurvature earth = view.earth.value_or(EarthCurvature());
    out.bend = pack({earth.xx, earth.xy, earth.yy}, 0);
    const GridRect part = view.drawn();
    const glm::dvec2 corner(part.x, view.height - part.y - part.height), size(part.width, part.height);
    const glm::dvec2 whole(view.width, view.height);
    out.part = glm::vec4(corner, size);
    out.partClip = glm::vec4(whole / size, (whole - 2.0 * corner) / size - 1.0);
    out.air = glm::vec4(options.visualRange.value_or(Metres(0)).value(), view.eye.z / view.exaggeration,
                        1 / view.exaggeration, 0);
    return out;
}

/// Whether the current context draws on the CPU. Mesa 22.3's llvmpipe filters anisotropically by weighing every texel
/// of an ellipse: 400 ms a frame of 1280 x 720 where probes take about 40 (2 cores).
bool isSoftwareRasteriser() {
    const std::string_view renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    return renderer.find("llvmpipe") != std::string_view::npos || renderer.find("softpipe") != std::string_view::npos;
}

}  // namespace

std::string_view name(Launch launch) {
    switch (launch) {
        case Launch::automatic:
            return "auto";
        case Launch::raster:
            return "raster";
        case Launch::compute:
            return "compute";
    }
    return "";
}

TerrainRenderer::TerrainRenderer(const ShaderLibrary& shaders, const Tiling& tiling)
    : shaders_(shaders),
      tiling_(tiling),
      softwareRasteriser_(isSoftwareRasteriser()),
      rasterLaunch_(shaders),
      computeLaunch_(shaders),
      nodeBuffer_(makeBuffer()),
      frameBuffer_(makeBuffer()),
      photoSampler_(makeSampler()) {
    glNamedBufferStorage(frameBuffer_.name(), sizeof(interop::FrameParameters), nullptr, GL_DYNAMIC_STORAGE_BIT);
    glSamplerParameteri(photoSampler_.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glSamplerParameteri(photoSampler_.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glSamplerParameteri(photoSampler_.name(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glSamplerParameteri(photoSampler_.name(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

void TerrainRenderer::describeNodes(const View& view, std::span<const DrawNode> nodes, const GpuTiles& tiles,
                                    const RenderOptions& options) {
    for (const DrawNode& node : nodes) {
        const ResidentHeights* heights = tiles.heights(node.heightTile);
        TERRAY_CHECK(heights != nullptr);
        NodeSource source{.heights = *heights};
        if (node.imageryTile) {
            const auto slot = tiles.imagerySlot(*node.imageryTile);
            TERRAY_CHECK(slot.has_value());
            source.photoSlot = *slot;
        }
        source.bilinear = options.surface == Surface::bilinear ||
                          (options.surface == Surface::automatic && magnified(node, tiling_, view));
        source.pyramid = options.method.method != Method::march;
        source.castsShadow = options.shadows.has_value();
        drawn_.push_back(node);
        nodes_.push_back(nodeParameters(node, source, tiling_, view));
    }
}

void TerrainRenderer::uploadFrame(const View& view, const RenderOptions& options) {
    if (nodes_.size() > nodeCapacity_ || nodeCapacity_ == 0) {
        nodeCapacity_ = std::max<uint64_t>(2 * nodes_.size(), 64);
        nodeBuffer_ = makeBuffer();
        glNamedBufferStorage(nodeBuffer_.name(),
                             static_cast<GLsizeiptr>(nodeCapacity_ * sizeof(interop::NodeParameters)), nullptr,
                             GL_DYNAMIC_STORAGE_BIT);
    }
    if (!nodes_.empty()) {
        glNamedBufferSubData(nodeBuffer_.name(), 0,
                             static_cast<GLsizeiptr>(nodes_.size() * sizeof(interop::NodeParameters)), nodes_.data());
    }
    const interop::FrameParameters frame = frameParameters(view, options);
    glNamedBufferSubData(frameBuffer_.name(), 0, sizeof(frame), &frame);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TERRAY_BUFFER_NODES, nodeBuffer_.name());
    glBindBufferBase(GL_UNIFORM_BUFFER, TERRAY_BUFFER_FRAME, frameBuffer_.name());
}

/// Before anything else of the frame is bound: the table's passes use the same places.
void TerrainRenderer::makeSky(const View& view, const RenderOptions& options) {
    if (!options.sky) {
        sky_.reset();
        return;
    }
    SkyTable::Options wanted{.airlight = options.visualRange.has_value()};
    wanted.visualRange = options.visualRange.value_or(wanted.visualRange);
    if (!sky_ || sky_->options() != wanted) sky_ = std::make_unique<SkyTable>(shaders_, wanted);
    const double sunSine = std::clamp(glm::normalize(options.sunDirection).z, -1.0, 1.0);
    sky_->update({.eyeHeight = Metres(view.eye.z / view.exaggeration), .sunElevation = Radians(std::asin(sunSine))});
}

void TerrainRenderer::bindTextures(const FrameTargets& targets, const GpuTiles& tiles, float anisotropy) {
    glBindTextureUnit(TERRAY_UNIT_HEIGHTS, tiles.heightTexture());
    glBindTextureUnit(TERRAY_UNIT_HIT, targets.hit.name());
    glBindTextureUnit(TERRAY_UNIT_NODE, targets.node.name());
    if (targets.features().imagery) {
        glSamplerParameterf(photoSampler_.name(), GL_TEXTURE_MAX_ANISOTROPY_EXT, anisotropy);
        glBindTextureUnit(TERRAY_UNIT_PHOTO, tiles.imageryTexture());
        glBindSampler(TERRAY_UNIT_PHOTO, photoSampler_.name());
    }
    if (sky_) sky_->bind();
}

void TerrainRenderer::bindShading(const RenderOptions& options) {
    const ShadingOptions& shading = options.shading;
    if (!needsOf(shading.mode).measures) return;
    const glm::dvec4 measures(shading.lowest.value(), shading.highest.value(), shading.contourInterval.value(),
                              shading.tolerance.value());
    const interop::ShadingParameters parameters{.heights = glm::vec4(measures)};
    if (!shadingBuffer_) {
        shadingBuffer_ = makeBuffer();
        glNamedBufferStorage(shadingBuffer_.name(), sizeof(parameters), nullptr, GL_DYNAMIC_STORAGE_BIT);
    }
    glNamedBufferSubData(shadingBuffer_.name(), 0, sizeof(parameters), &parameters);
    glBindBufferBase(GL_UNIFORM_BUFFER, TERRAY_BUFFER_SHADING, shadingBuffer_.name());
}

void TerrainRenderer::chooseRasterised(const View& view, std::span<const DrawNode> nodes, const GpuTiles& tiles,
                                       const RenderOptions& options) {
    rasterised_.assign(nodes.size(), entryOf(options.method.method).geometry ? 1 : 0);
    if (options.method.method != Method::hybrid) return;
    TERRAY_CHECK(options.drawCosts.has_value());
    std::vector<NodeWork> work;
    const MethodTiles& meshes = *tiles.methodTiles();
    for (const interop::NodeParameters& node : nodes_)
        work.push_back(workOf(node, view, meshes.triangles(node), meshes.isMade(node)));
    rasterised_ = choice_.choose(nodes, work, *options.drawCosts);
}

size_t TerrainRenderer::rasterisedNodes() const {
    return static_cast<size_t>(std::ranges::count(rasterised_, 1));
}

void TerrainRenderer::bindMethod(const MethodOptions& options, const GpuTiles& tiles) {
    if (entryOf(options.method).define.empty()) return;
    if (tiles.methodTiles() != nullptr) tiles.methodTiles()->bind();
    const interop::MethodParameters parameters = methodParameters(options);
    if (!methodBuffer_) {
        methodBuffer_ = makeBuffer();
        glNamedBufferStorage(methodBuffer_.name(), sizeof(parameters), nullptr, GL_DYNAMIC_STORAGE_BIT);
    }
    glNamedBufferSubData(methodBuffer_.name(), 0, sizeof(parameters), &parameters);
    glBindBufferBase(GL_UNIFORM_BUFFER, TERRAY_BUFFER_METHOD, methodBuffer_.name());
}

/// Steps that were counted into images, as a texture for the resolve pass.
void bindSteps(const CastFrame& frame) {
    const ShadingNeeds needs = needsOf(frame.features.shading);
    if (!needs.steps && !(needs.shadowSteps && frame.features.shadows)) return;
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    glBindTextureUnit(TERRAY_UNIT_STEPS,
                      needs.steps ? frame.targets.steps.name() : frame.targets.shadow().steps.name());
}

void TerrainRenderer::draw(const CastFrame& frame, Launch launch) {
    const bool raster = launch != Launch::compute;
    if (raster) {
        rasterLaunch_.cast(frame);
    } else {
        computeLaunch_.cast(frame);
    }
    if (frame.features.shadows) {
        ShadowScene scene = shadowScene(drawn_, nodes_, tiling_, frame.view);
        shadowPass_->cast(frame, std::move(scene), shadowOptions_, raster ? &rasterLaunch_ : nullptr);
    }
    bindSteps(frame);
    if (raster) {
        rasterLaunch_.resolve(frame);
    } else {
        computeLaunch_.resolve(frame);
    }
}

/// Wall clock around glFinish, which also counts what the driver does on the CPU for hundreds of draws.
void TerrainRenderer::calibrate(CastFrame frame, bool occlusion) {
    frame.timer = nullptr;
    const auto medianMs = [&](Launch launch) {
        frame.features.occlusion = occlusion && launch == Launch::raster;
        std::vector<double> times;
        for (int i = 0; i < kCalibrationFrames; ++i) {
            glFinish();
            const auto start = std::chrono::steady_clock::now();
            draw(frame, launch);
            glFinish();
            times.push_back(
                std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        }
        times.erase(times.begin());  // it compiled programs
        std::ranges::sort(times);
        return times[times.size() / 2];
    };
    Calibration result{.rasterMs = medianMs(Launch::raster), .computeMs = medianMs(Launch::compute)};
    result.chosen = result.computeMs < result.rasterMs ? Launch::compute : Launch::raster;
    calibration_ = result;
}

/// The launch that draws a frame: for geometry the raster launch, whatever was asked for.
Launch TerrainRenderer::launchOf(const CastFrame& frame, const RenderOptions& options) {
    if (entryOf(options.method.method).geometry) return Launch::raster;
    if (options.launch != Launch::automatic) return options.launch;
    if (!calibration_) calibrate(frame, options.occlusion);
    return calibration_->chosen;
}

void TerrainRenderer::setOverlay(std::span<const OverlayMesh> meshes) {
    if (meshes.empty()) {
        overlay_.reset();
        return;
    }
    if (!overlay_) overlay_ = std::make_unique<OverlayPass>(shaders_);
    overlay_->setMeshes(meshes);
}

void TerrainRenderer::render(const View& view, std::span<const DrawNode> nodes, std::span<const DrawNode> casters,
                             const GpuTiles& tiles, const RenderOptions& options, FrameTargets& targets,
                             GpuTimer* timer) {
    const GridRect part = view.drawn();
    TERRAY_CHECK_OP(part.width, ==, targets.width());
    TERRAY_CHECK_OP(part.height, ==, targets.height());
    if (timer != nullptr && options.sky) timer->enter(GpuPass::resolve);
    makeSky(view, options);
    drawn_.clear();
    nodes_.clear();
    describeNodes(view, nodes, tiles, options);
    const auto inPicture = std::span(nodes_).first(nodes.size());
    bilinearNodes_ = static_cast<size_t>(std::ranges::count_if(
        inPicture, [](const interop::NodeParameters& node) { return (node.source.w & TERRAY_BILINEAR_BIT) != 0; }));
    if (options.shadows) describeNodes(view, casters, tiles, options);
    uploadFrame(view, options);

    FeatureSet features = targets.features();
    features.photoProbes = features.imagery && options.photoFilter != PhotoFilter::hardware &&
                           (options.photoFilter == PhotoFilter::probes || softwareRasteriser_);
    features.bilinear = bilinearNodes_ > 0;
    features.curved = view.earth.has_value();
    features.sky = options.sky;
    features.air = options.visualRange.has_value();
    features.shading = options.shading.mode;
    features.method = options.method.method;
    const ShadingNeeds needs = needsOf(features.shading);
    TERRAY_CHECK(features.statistics || !(needs.steps || needs.shadowSteps));
    TERRAY_CHECK(features.shading != Shading::contours || options.shading.contourInterval > Metres(0));
    // Below the horizon the sun lights nothing, and no ray finds out more.
    features.shadows = options.shadows.has_value() && options.sunDirection.z > 0;
    if (features.shadows) {
        shadowOptions_ = *options.shadows;
        if (!shadowPass_) shadowPass_ = std::make_unique<ShadowPass>(shaders_);
    } else {
        targets.dropShadow();
    }
    chooseRasterised(view, nodes, tiles, options);
    glViewport(0, 0, targets.width(), targets.height());
    bindShading(options);
    bindMethod(options.method, tiles);
    bindTextures(targets, tiles, features.photoProbes ? 1 : options.anisotropy);

    CastFrame frame{.view = view,
                    .nodes = std::span(nodes_).first(nodes.size()),
                    .features = features,
                    .targets = targets,
                    .timer = timer,
                    .methodTiles = tiles.methodTiles(),
                    .rasterised = rasterised_};
    const Launch launch = launchOf(frame, options);
    if (launch == Launch::compute) targets.dropRaster();
    // The ID pass is for rays.
    const bool rays = !entryOf(options.method.method).geometry || options.method.method == Method::hybrid;
    frame.features.occlusion = options.occlusion && launch == Launch::raster && rays;
    draw(frame, launch);
    if (overlay_) overlay_->draw(frame);

    glBindSampler(TERRAY_UNIT_PHOTO, 0);
    glBindSampler(TERRAY_UNIT_SKY, 0);
    glBindSampler(TERRAY_UNIT_AIR, 0);
    if (features.statistics) glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
}

uint64_t TerrainRenderer::bufferBytes() const {
    return nodeCapacity_ * sizeof(interop::NodeParameters) + sizeof(interop::FrameParameters) +
           RasterLaunch::bufferBytes() + computeLaunch_.bufferBytes() + (sky_ ? sky_->bytes() : 0) +
           (shadowPass_ ? shadowPass_->bufferBytes() : 0) + (shadingBuffer_ ? sizeof(interop::ShadingParameters) : 0) +
           (methodBuffer_ ? sizeof(interop::MethodParameters) : 0) + (overlay_ ? overlay_->bytes() : 0);
}

}  // namespace terray
