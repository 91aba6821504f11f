#include "client/render/overlay_pass.h"

#include <cstddef>

#include <glm/gtc/type_ptr.hpp>

namespace terray {
namespace {

static_assert(sizeof(OverlayVertex) == 36);

GlBuffer uploaded(const void* data, size_t bytes) {
    GlBuffer buffer = makeBuffer();
    glNamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(bytes), data, 0);
    return buffer;
}

}  // namespace

OverlayPass::OverlayPass(const ShaderLibrary& shaders)
    : programs_(shaders, {"overlay.vert", "overlay.frag"}), vertexArray_(makeVertexArray()) {
    const auto attribute = [&](GLuint location, size_t offset) {
        glEnableVertexArrayAttrib(vertexArray_.name(), location);
        glVertexArrayAttribFormat(vertexArray_.name(), location, 3, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offset));
        glVertexArrayAttribBinding(vertexArray_.name(), location, 0);
    };
    attribute(0, offsetof(OverlayVertex, anchor));
    attribute(1, offsetof(OverlayVertex, offset));
    attribute(2, offsetof(OverlayVertex, normal));
}

void OverlayPass::setMeshes(std::span<const OverlayMesh> meshes) {
    meshes_.clear();
    bytes_ = 0;
    for (const OverlayMesh& mesh : meshes) {
        if (mesh.indices.empty()) continue;
        const size_t vertexBytes = mesh.vertices.size() * sizeof(OverlayVertex);
        const size_t indexBytes = mesh.indices.size() * sizeof(uint32_t);
        meshes_.push_back({.origin = mesh.origin,
                           .colour = mesh.colour,
                           .size = mesh.size,
                           .leastPixels = mesh.leastPixels,
                           .vertices = uploaded(mesh.vertices.data(), vertexBytes),
                           .indices = uploaded(mesh.indices.data(), indexBytes),
                           .count = static_cast<GLsizei>(mesh.indices.size())});
        bytes_ += vertexBytes + indexBytes;
    }
}

void OverlayPass::draw(const Mesh& mesh, const View& view) const {
    // The difference in double: what is near the eye is exact however far both are from the world's origin.
    const glm::dvec3 seen(mesh.origin.x, mesh.origin.y, mesh.origin.z * view.exaggeration);
    const glm::vec4 origin(glm::vec3(seen - view.eye), static_cast<float>(view.exaggeration));
    const double growth = mesh.leastPixels / (mesh.size * view.focalPixels());
    glUniform4fv(TERRAY_UNIFORM_ORIGIN, 1, glm::value_ptr(origin));
    glUniform1f(TERRAY_UNIFORM_GROWTH, static_cast<float>(growth));
    glUniform3fv(TERRAY_UNIFORM_COLOUR, 1, glm::value_ptr(mesh.colour));
    glVertexArrayVertexBuffer(vertexArray_.name(), 0, mesh.vertices.name(), 0, sizeof(OverlayVertex));
    glVertexArrayElementBuffer(vertexArray_.name(), mesh.indices.name());
    glDrawElements(GL_TRIANGLES, mesh.count, GL_UNSIGNED_INT, nullptr);
}

void OverlayPass::draw(const CastFrame& frame) {
    frame.enter(GpuPass::overlay);
    const OverlayTargets& targets = frame.targets.overlay();
    const float infinitelyFar = 0;
    glDepthMask(GL_TRUE);
    glClearNamedFramebufferfv(targets.framebuffer.name(), GL_DEPTH, 0, &infinitelyFar);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, targets.framebuffer.name());
    glUseProgram(programs_.get(frame.features.overlaying()).name());
    glBindVertexArray(vertexArray_.name());
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
    glFrontFace(GL_CCW);
    for (const Mesh& mesh : meshes_) draw(mesh, frame.view);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_TEST);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
}

}  // namespace terray
