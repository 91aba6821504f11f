#include "client/render/terrain_renderer.h"

#include <cmath>
#include <string_view>

#include <glm/geometric.hpp>

#include "client/render/node_parameters.h"
#include "common/check.h"
#include "common/imagery_tile.h"
#include "shaders/interop.h"

namespace terray {
namespace {

/// The 12 triangles of a box whose corner n lies at x = n & 1, y = n >> 1 & 1, z = n >> 2; counter-clockwise from
/// outside in the tile frame, hence clockwise on the ground, whose y runs the other way.
constexpr std::array<uint8_t, 36> kBoxIndices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                                 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};

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
    return out;
}

/// Whether the current context draws on the CPU. Mesa 22.3's llvmpipe filters anisotropically by weighing every texel
/// of an ellipse: 400 ms a frame of 1280 x 720 where probes take about 40 (2 cores).
bool isSoftwareRasteriser() {
    const std::string_view renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    return renderer.find("llvmpipe") != std::string_view::npos || renderer.find("softpipe") != std::string_view::npos;
}

}  // namespace

struct TerrainRenderer::Programs {
    GlProgram id;  ///< none without occlusion
    GlProgram march;
    GlProgram resolve;
};

TerrainRenderer::TerrainRenderer(const ShaderLibrary& shaders, const Tiling& tiling)
    : shaders_(shaders),
      tiling_(tiling),
      softwareRasteriser_(isSoftwareRasteriser()),
      nodeBuffer_(makeBuffer()),
      frameBuffer_(makeBuffer()),
      boxIndices_(makeBuffer()),
      vertexArray_(makeVertexArray()),
      photoSampler_(makeSampler()) {
    glNamedBufferStorage(boxIndices_.name(), sizeof(kBoxIndices), kBoxIndices.data(), 0);
    glNamedBufferStorage(frameBuffer_.name(), sizeof(interop::FrameParameters), nullptr, GL_DYNAMIC_STORAGE_BIT);
    glVertexArrayElementBuffer(vertexArray_.name(), boxIndices_.name());
    glSamplerParameteri(photoSampler_.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glSamplerParameteri(photoSampler_.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glSamplerParameteri(photoSampler_.name(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glSamplerParameteri(photoSampler_.name(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

TerrainRenderer::~TerrainRenderer() = default;

TerrainRenderer::Programs& TerrainRenderer::programsFor(const Variant& variant) {
    auto& programs = programs_[variant];
    if (!programs) {
        ShaderDefines defines = variant.features.defines();
        defines["TERRAY_OCCLUSION"] = variant.occlusion ? "1" : "0";
        defines["TERRAY_PHOTO_PROBES"] = variant.photoProbes ? "1" : "0";
        programs = std::make_unique<Programs>();
        if (variant.occlusion) programs->id = shaders_.require({"box.vert", "id.frag"}, defines);
        programs->march = shaders_.require({"box.vert", "march.frag"}, defines);
        programs->resolve = shaders_.require({"screen.vert", "resolve.frag"}, defines);
    }
    return *programs;
}

void TerrainRenderer::uploadFrame(const View& view, std::span<const DrawNode> nodes, const GpuTiles& tiles,
                                  const RenderOptions& options) {
    std::vector<interop::NodeParameters> parameters;
    parameters.reserve(nodes.size());
    for (const DrawNode& node : nodes) {
        const ResidentHeights* heights = tiles.heights(node.heightTile);
        TERRAY_CHECK(heights != nullptr);
        uint32_t photoSlot = TERRAY_NO_SLOT;
        if (node.imageryTile) {
            const auto slot = tiles.imagerySlot(*node.imageryTile);
            TERRAY_CHECK(slot.has_value());
            photoSlot = *slot;
        }
        parameters.push_back(nodeParameters(node, *heights, photoSlot, tiling_, view));
    }
    if (parameters.size() > nodeCapacity_ || nodeCapacity_ == 0) {
        nodeCapacity_ = std::max<uint64_t>(2 * parameters.size(), 64);
        nodeBuffer_ = makeBuffer();
        glNamedBufferStorage(nodeBuffer_.name(),
                             static_cast<GLsizeiptr>(nodeCapacity_ * sizeof(interop::NodeParameters)), nullptr,
                             GL_DYNAMIC_STORAGE_BIT);
    }
    if (!parameters.empty()) {
        glNamedBufferSubData(nodeBuffer_.name(), 0,
                             static_cast<GLsizeiptr>(parameters.size() * sizeof(interop::NodeParameters)),
                             parameters.data());
    }
    const interop::FrameParameters frame = frameParameters(view, options);
    glNamedBufferSubData(frameBuffer_.name(), 0, sizeof(frame), &frame);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TERRAY_BUFFER_NODES, nodeBuffer_.name());
    glBindBufferBase(GL_UNIFORM_BUFFER, TERRAY_BUFFER_FRAME, frameBuffer_.name());
}

/// Paper 001, section 3.4: node by node, first an ID pass with the depth test on and depth writes off, then the march
/// with the test set to pass and writes on. Without the ID pass the depth test itself keeps the nearest hit.
void TerrainRenderer::castNodes(size_t count, const Programs& programs, const FrameTargets& targets, GpuTimer* timer) {
    const auto draw = [&](GpuPass pass, const GlProgram& program, const GlFramebuffer& framebuffer, size_t node) {
        if (timer != nullptr) timer->enter(pass);
        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer.name());
        glUseProgram(program.name());
        glUniform1ui(TERRAY_UNIFORM_NODE, static_cast<GLuint>(node));
        glDrawElements(GL_TRIANGLES, kBoxIndices.size(), GL_UNSIGNED_BYTE, nullptr);
    };
    const bool occlusion = static_cast<bool>(programs.id);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_CULL_FACE);
    glFrontFace(GL_CW);
    glCullFace(GL_FRONT);
    for (size_t node = 0; node < count; ++node) {
        if (occlusion) {
            glDepthFunc(GL_GREATER);
            glDepthMask(GL_FALSE);
            draw(GpuPass::id, programs.id, targets.idFramebuffer, node);
            glDepthFunc(GL_ALWAYS);
            glDepthMask(GL_TRUE);
        } else {
            glDepthFunc(GL_GREATER);
        }
        draw(GpuPass::march, programs.march, targets.marchFramebuffer, node);
    }
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_TEST);
}

void TerrainRenderer::resolve(const Programs& programs, const GpuTiles& tiles, float anisotropy,
                              const FrameTargets& targets) {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, targets.resolveFramebuffer.name());
    glUseProgram(programs.resolve.name());
    glBindTextureUnit(TERRAY_UNIT_HIT, targets.hit.name());
    glBindTextureUnit(TERRAY_UNIT_NODE, targets.node.name());
    if (targets.features().imagery) {
        glSamplerParameterf(photoSampler_.name(), GL_TEXTURE_MAX_ANISOTROPY_EXT, anisotropy);
        glBindTextureUnit(TERRAY_UNIT_PHOTO, tiles.imageryTexture());
        glBindSampler(TERRAY_UNIT_PHOTO, photoSampler_.name());
    }
    glEnable(GL_FRAMEBUFFER_SRGB);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glBindSampler(TERRAY_UNIT_PHOTO, 0);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
}

void TerrainRenderer::render(const View& view, std::span<const DrawNode> nodes, const GpuTiles& tiles,
                             const RenderOptions& options, FrameTargets& targets, GpuTimer* timer) {
    TERRAY_CHECK_OP(view.width, ==, targets.width());
    TERRAY_CHECK_OP(view.height, ==, targets.height());
    const bool probes = targets.features().imagery && options.photoFilter != PhotoFilter::hardware &&
                        (options.photoFilter == PhotoFilter::probes || softwareRasteriser_);
    const Programs& programs =
        programsFor({.features = targets.features(), .occlusion = options.occlusion, .photoProbes = probes});
    uploadFrame(view, nodes, tiles, options);

    glViewport(0, 0, view.width, view.height);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glDepthMask(GL_TRUE);
    glBindVertexArray(vertexArray_.name());
    const GLuint noNode[4] = {0, 0, 0, 0};
    const float infinitelyFar = 0;
    glClearNamedFramebufferuiv(targets.idFramebuffer.name(), GL_COLOR, 0, noNode);
    glClearNamedFramebufferuiv(targets.marchFramebuffer.name(), GL_COLOR, 1, noNode);
    glClearNamedFramebufferfv(targets.marchFramebuffer.name(), GL_DEPTH, 0, &infinitelyFar);
    if (targets.features().statistics) {
        glClearTexImage(targets.steps.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, noNode);
        glBindImageTexture(TERRAY_IMAGE_STEPS, targets.steps.name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
    }
    glBindTextureUnit(TERRAY_UNIT_HEIGHTS, tiles.heightTexture());
    glBindTextureUnit(TERRAY_UNIT_ID, targets.id.name());

    castNodes(nodes.size(), programs, targets, timer);
    if (timer != nullptr) timer->enter(GpuPass::resolve);
    resolve(programs, tiles, probes ? 1 : options.anisotropy, targets);
    if (targets.features().statistics) glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
}

uint64_t TerrainRenderer::bufferBytes() const {
    return nodeCapacity_ * sizeof(interop::NodeParameters) + sizeof(interop::FrameParameters) + sizeof(kBoxIndices);
}

}  // namespace terray
