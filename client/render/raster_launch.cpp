#include "client/render/raster_launch.h"

#include <algorithm>
#include <cstdint>

namespace terray {
namespace {

/// The 12 triangles of a box, those of its sides first. Corner n lies at x = n & 1, y = n >> 1 & 1, z = n >> 2;
/// counter-clockwise from outside in the tile frame, hence clockwise on the ground, whose y runs the other way.
constexpr std::array<uint8_t, 36> kBoxIndices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                                 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};

}  // namespace

RasterLaunch::RasterLaunch(const ShaderLibrary& shaders)
    : idPrograms_(shaders, {"box.vert", "id.frag"}),
      marchPrograms_(shaders, {"box.vert", "march.frag"}),
      resolvePrograms_(shaders, {"screen.vert", "resolve.frag"}),
      boxIndices_(makeBuffer()),
      vertexArray_(makeVertexArray()),
      shaders_(shaders) {
    glNamedBufferStorage(boxIndices_.name(), sizeof(kBoxIndices), kBoxIndices.data(), 0);
    glVertexArrayElementBuffer(vertexArray_.name(), boxIndices_.name());
}

uint64_t RasterLaunch::bufferBytes() {
    return sizeof(kBoxIndices);
}

void RasterLaunch::draw(const GlProgram& program, const GlFramebuffer& framebuffer, size_t node) {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer.name());
    glUseProgram(program.name());
    glUniform1ui(TERRAY_UNIFORM_NODE, static_cast<GLuint>(node));
    glDrawElements(GL_TRIANGLES, kBoxIndices.size(), GL_UNSIGNED_BYTE, nullptr);
}

void RasterLaunch::cast(const CastFrame& frame) {
    const bool occlusion = frame.features.occlusion;
    const RasterTargets& targets = frame.targets.raster(occlusion);
    const GLuint noNode[4] = {0, 0, 0, 0};
    const float infinitelyFar = 0;
    glDepthMask(GL_TRUE);
    glClearNamedFramebufferuiv(targets.marchFramebuffer.name(), GL_COLOR, 1, noNode);
    glClearNamedFramebufferfv(targets.marchFramebuffer.name(), GL_DEPTH, 0, &infinitelyFar);
    if (occlusion) {
        glClearNamedFramebufferuiv(targets.idFramebuffer.name(), GL_COLOR, 0, noNode);
        glBindTextureUnit(TERRAY_UNIT_ID, targets.id.name());
    }
    if (frame.features.statistics) {
        glClearTexImage(frame.targets.steps.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, noNode);
        glBindImageTexture(TERRAY_IMAGE_STEPS, frame.targets.steps.name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
    }

    glBindVertexArray(vertexArray_.name());
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_DEPTH_CLAMP);  // a box that ends before the depth of value 1 is in the picture all the same
    glEnable(GL_CULL_FACE);
    glFrontFace(GL_CW);
    glDepthFunc(GL_GREATER);
    if (std::ranges::count(frame.rasterised, 1) > 0) {
        if (!geometry_) geometry_ = std::make_unique<GeometryPass>(shaders_, vertexArray_);
        geometry_->begin(frame);
    }
    for (size_t node = 0; node < frame.nodes.size(); ++node) {
        if (frame.rasterised[node] != 0) {
            drawGeometry(frame, targets, node);
        } else {
            castRays(frame, targets, node);
        }
    }
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_CLAMP);
    glDisable(GL_DEPTH_TEST);
}

void RasterLaunch::castRays(const CastFrame& frame, const RasterTargets& targets, size_t node) {
    glCullFace(GL_FRONT);
    if (frame.features.occlusion) {
        FeatureSet placing;
        placing.curved = frame.features.curved;
        frame.enter(GpuPass::id);
        glDepthFunc(GL_GREATER);
        glDepthMask(GL_FALSE);
        draw(idPrograms_.get(placing), targets.idFramebuffer, node);
        glDepthFunc(GL_ALWAYS);
        glDepthMask(GL_TRUE);
    }
    frame.enter(GpuPass::march);
    // Nodes of columns are drawn by a program that knows of no patches.
    FeatureSet marching = frame.features.marching();
    marching.bilinear = (frame.nodes[node].source.w & TERRAY_BILINEAR_BIT) != 0;
    draw(marchPrograms_.get(marching), targets.marchFramebuffer, node);
}

void RasterLaunch::drawGeometry(const CastFrame& frame, const RasterTargets& targets, size_t node) {
    frame.enter(GpuPass::march);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, targets.marchFramebuffer.name());
    glDepthFunc(GL_GREATER);
    geometry_->draw(frame, node);
    glBindVertexArray(vertexArray_.name());
}

void RasterLaunch::resolve(const CastFrame& frame) {
    frame.enter(GpuPass::resolve);
    drawScreen(resolvePrograms_.get(frame.features.resolving()),
               frame.targets.raster(frame.features.occlusion).resolveFramebuffer);
}

void RasterLaunch::drawScreen(const GlProgram& program, const GlFramebuffer& framebuffer) {
    glBindVertexArray(vertexArray_.name());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer.name());
    glUseProgram(program.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
}

}  // namespace terray
