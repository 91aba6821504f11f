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
      hullPrograms_(shaders, {"methods/hull.vert", "methods/hull.frag"}),
      hullSidePrograms_(shaders, {"methods/side.vert", "methods/hull_side.frag"}),
      hullInsidePrograms_(shaders, {"box.vert", "methods/hull_side.frag"}) {}

void GeometryPass::begin(const CastFrame& frame) {
    TERRAY_CHECK(frame.methodTiles != nullptr);
    frame.methodTiles->bind();
    features_ = frame.features.marching();
    features_.occlusion = false;
}

void GeometryPass::drawBox(const GlProgram& program, size_t node, bool inside) {
    glBindVertexArray(boxes_.name());
    glUseProgram(program.name());
    glUniform1ui(TERRAY_UNIFORM_NODE, static_cast<GLuint>(node));
    glUniform1i(TERRAY_UNIFORM_INSIDE, inside ? 1 : 0);
    glCullFace(inside ? GL_FRONT : GL_BACK);
    glDrawElements(GL_TRIANGLES, inside ? kBoxIndices : kSideIndices, GL_UNSIGNED_BYTE, nullptr);
}

void GeometryPass::draw(const CastFrame& frame, size_t node) {
    const interop::NodeParameters& parameters = frame.nodes[node];
    FeatureSet features = features_;
    features.bilinear = (parameters.source.w & TERRAY_BILINEAR_BIT) != 0;
    drawBox(hullSidePrograms_.get(features), node, false);
    if (eyeOver(parameters)) drawBox(hullInsidePrograms_.get(features), node, true);

    const GlProgram& program = hullPrograms_.get(features);
    glUseProgram(program.name());
    glUniform1ui(TERRAY_UNIFORM_NODE, static_cast<GLuint>(node));
    glCullFace(GL_BACK);
    glFrontFace(GL_CCW);
    for (GLenum plane = 0; plane < 4; ++plane) glEnable(GL_CLIP_DISTANCE0 + plane);
    frame.methodTiles->draw(parameters);
    for (GLenum plane = 0; plane < 4; ++plane) glDisable(GL_CLIP_DISTANCE0 + plane);
    glFrontFace(GL_CW);
}

}  // namespace terray
