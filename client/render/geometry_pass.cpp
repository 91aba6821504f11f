#include "client/render/geometry_pass.h"

#include "client/render/method_tiles.h"

namespace terray {
namespace {

constexpr GLsizei kSideIndices = 24;
constexpr GLsizei kBoxIndices = 36;

/// Whether the eye lies over or in a node's cell.
bool eyeOver(const interop::NodeParameters& node) {
    return node.eye.x >= node.boxMin.x && node.eye.x <= node.boxMax.x && node.eye.y >= node.boxMin.y &&
           node.eye.y <= node.boxMax.y;
}

}  // namespace

GeometryPass::GeometryPass(const ShaderLibrary& shaders, const GlVertexArray& boxes)
    : boxes_(boxes),
      hull_{.surface = {shaders, {"methods/hull.vert", "methods/hull.frag"}},
            .sides = {shaders, {"methods/side.vert", "methods/hull_side.frag"}}},
      mesh_{.surface = {shaders, {"methods/mesh.vert", "methods/mesh.frag"}},
            .sides = {shaders, {"methods/side.vert", "methods/mesh_side.frag"}}},
      hullInside_(shaders, {"box.vert", "methods/hull_side.frag"}) {}

void GeometryPass::begin(const CastFrame& frame) {
    TERRAY_CHECK(frame.methodTiles != nullptr);
    features_ = frame.features.marching();
    features_.occlusion = false;
}

void GeometryPass::drawSides(const CastFrame& frame, const GlProgram& program, size_t node) {
    glBindVertexArray(boxes_.name());
    glUseProgram(program.name());
    glUniform1ui(TERRAY_UNIFORM_NODE, static_cast<GLuint>(node));
    if (features_.method == Method::hull) {
        glUniform1i(TERRAY_UNIFORM_INSIDE, 0);
    } else {
        glUniform1f(TERRAY_UNIFORM_SLACK, frame.methodTiles->slack(frame.nodes[node].source.x));
    }
    glCullFace(GL_BACK);
    glDrawElements(GL_TRIANGLES, kSideIndices, GL_UNSIGNED_BYTE, nullptr);
}

void GeometryPass::drawInside(const GlProgram& program, size_t node) {
    glBindVertexArray(boxes_.name());
    glUseProgram(program.name());
    glUniform1ui(TERRAY_UNIFORM_NODE, static_cast<GLuint>(node));
    glUniform1i(TERRAY_UNIFORM_INSIDE, 1);
    glCullFace(GL_FRONT);
    glDrawElements(GL_TRIANGLES, kBoxIndices, GL_UNSIGNED_BYTE, nullptr);
}

void GeometryPass::drawSurface(const CastFrame& frame, const GlProgram& program, size_t node) {
    glUseProgram(program.name());
    glUniform1ui(TERRAY_UNIFORM_NODE, static_cast<GLuint>(node));
    glCullFace(GL_BACK);
    glFrontFace(GL_CCW);
    for (GLenum plane = 0; plane < 4; ++plane) glEnable(GL_CLIP_DISTANCE0 + plane);
    frame.methodTiles->draw(frame.nodes[node]);
    for (GLenum plane = 0; plane < 4; ++plane) glDisable(GL_CLIP_DISTANCE0 + plane);
    glFrontFace(GL_CW);
}

void GeometryPass::draw(const CastFrame& frame, size_t node) {
    const interop::NodeParameters& parameters = frame.nodes[node];
    FeatureSet features = features_;
    features.bilinear = (parameters.source.w & TERRAY_BILINEAR_BIT) != 0;
    Programs& programs = features_.method == Method::hull ? hull_ : mesh_;
    // Triangles first: what they hide of the sides is not shaded.
    drawSurface(frame, programs.surface.get(features), node);
    drawSides(frame, programs.sides.get(features), node);
    if (features_.method == Method::hull && eyeOver(parameters)) drawInside(hullInside_.get(features), node);
}

}  // namespace terray
