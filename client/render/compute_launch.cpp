#include "client/render/compute_launch.h"

#include <algorithm>

#include "client/render/node_parameters.h"

namespace terray {
namespace {

/// Work groups of squares over the picture. 16384 pixels make 2048 groups a side, far below the 65535 that GL promises.
void dispatchOverPicture(const View& view, int squareSide) {
    const auto groups = [&](int64_t pixels) { return static_cast<GLuint>((pixels + squareSide - 1) / squareSide); };
    const GridRect part = view.drawn();
    glDispatchCompute(groups(part.width), groups(part.height), 1);
}

void bindImage(GLuint unit, const GlTexture& texture, GLenum format) {
    glBindImageTexture(unit, texture.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, format);
}

}  // namespace

ComputeLaunch::ComputeLaunch(const ShaderLibrary& shaders)
    : binPrograms_(shaders, {"bin.comp"}),
      marchPrograms_(shaders, {"march.comp"}),
      resolvePrograms_(shaders, {"resolve.comp"}) {}

void ComputeLaunch::Buffer::require(uint64_t needed) {
    if (needed <= bytes && bytes > 0) return;
    bytes = std::max<uint64_t>(needed + needed / 2, 1024);
    object = makeBuffer();
    glNamedBufferStorage(object.name(), static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_STORAGE_BIT);
}

void ComputeLaunch::bin(const CastFrame& frame) {
    boxes_.clear();
    for (const interop::NodeParameters& node : frame.nodes) boxes_.push_back(pixelBounds(node, frame.view));
    const uint64_t boxBytes = boxes_.size() * sizeof(glm::vec4);
    const auto across = [](int64_t pixels) {
        return static_cast<uint64_t>((pixels + TERRAY_BIN_SIDE - 1) / TERRAY_BIN_SIDE);
    };
    const GridRect part = frame.view.drawn();
    const uint64_t bins = across(part.width) * across(part.height);
    boxBuffer_.require(boxBytes);
    binBuffer_.require(bins * ((boxes_.size() + 31) / 32) * sizeof(uint32_t));
    if (boxBytes > 0) {
        glNamedBufferSubData(boxBuffer_.object.name(), 0, static_cast<GLsizeiptr>(boxBytes), boxes_.data());
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TERRAY_BUFFER_BOXES, boxBuffer_.object.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TERRAY_BUFFER_BINS, binBuffer_.object.name());
    glUseProgram(binPrograms_.get({}).name());
    glUniform1ui(TERRAY_UNIFORM_NODE, static_cast<GLuint>(frame.nodes.size()));
    dispatchOverPicture(frame.view, TERRAY_BIN_SIDE);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void ComputeLaunch::dispatchScreen(const GlProgram& program, const View& view) {
    glUseProgram(program.name());
    dispatchOverPicture(view, TERRAY_GROUP_SIDE);
}

void ComputeLaunch::cast(const CastFrame& frame) {
    frame.enter(GpuPass::march);
    bin(frame);
    bindImage(TERRAY_IMAGE_HIT, frame.targets.hit, GL_RGBA32F);
    bindImage(TERRAY_IMAGE_NODE, frame.targets.node, GL_R32UI);
    if (frame.features.statistics) bindImage(TERRAY_IMAGE_STEPS, frame.targets.steps, GL_R32UI);
    glUseProgram(marchPrograms_.get(frame.features.marching()).name());
    glUniform1ui(TERRAY_UNIFORM_NODE, static_cast<GLuint>(frame.nodes.size()));
    dispatchOverPicture(frame.view, TERRAY_GROUP_SIDE);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

void ComputeLaunch::resolve(const CastFrame& frame) {
    frame.enter(GpuPass::resolve);
    const bool linear = frame.features.linearColour;
    bindImage(TERRAY_IMAGE_COLOUR, frame.targets.colour, linear ? GL_RGBA16F : GL_RGBA8);
    if (frame.features.normals) bindImage(TERRAY_IMAGE_NORMAL, frame.targets.normal, GL_RGBA32F);
    dispatchScreen(resolvePrograms_.get(frame.features.resolving()), frame.view);
    // What follows may sample, draw over, copy or read the picture.
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

}  // namespace terray
