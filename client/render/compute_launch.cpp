#include "client/render/compute_launch.h"

#include <algorithm>

#include "client/render/node_parameters.h"

namespace terray {
namespace {

/// One thread for each pixel. A picture of 16384 pixels makes 2048 groups a side, far below the 65535 that GL promises.
void dispatchOverPicture(const View& view) {
    const auto groups = [](int pixels) {
        return static_cast<GLuint>((pixels + TERRAY_GROUP_SIDE - 1) / TERRAY_GROUP_SIDE);
    };
    glDispatchCompute(groups(view.width), groups(view.height), 1);
}

void bindImage(GLuint unit, const GlTexture& texture, GLenum format) {
    glBindImageTexture(unit, texture.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, format);
}

}  // namespace

ComputeLaunch::ComputeLaunch(const ShaderLibrary& shaders)
    : marchPrograms_(shaders, {"march.comp"}), resolvePrograms_(shaders, {"resolve.comp"}) {}

void ComputeLaunch::uploadBoxes(const CastFrame& frame) {
    boxes_.clear();
    for (const interop::NodeParameters& node : frame.nodes) boxes_.push_back(pixelBounds(node, frame.view));
    if (capacity_ < boxes_.size() || capacity_ == 0) {
        capacity_ = std::max<uint64_t>(2 * boxes_.size(), 64);
        boxBuffer_ = makeBuffer();
        glNamedBufferStorage(boxBuffer_.name(), static_cast<GLsizeiptr>(bufferBytes()), nullptr,
                             GL_DYNAMIC_STORAGE_BIT);
    }
    if (!boxes_.empty()) {
        glNamedBufferSubData(boxBuffer_.name(), 0, static_cast<GLsizeiptr>(boxes_.size() * sizeof(glm::vec4)),
                             boxes_.data());
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TERRAY_BUFFER_BOXES, boxBuffer_.name());
}

void ComputeLaunch::cast(const CastFrame& frame) {
    frame.enter(GpuPass::march);
    uploadBoxes(frame);
    bindImage(TERRAY_IMAGE_HIT, frame.targets.hit, GL_RGBA32F);
    bindImage(TERRAY_IMAGE_NODE, frame.targets.node, GL_R32UI);
    if (frame.features.statistics) bindImage(TERRAY_IMAGE_STEPS, frame.targets.steps, GL_R32UI);
    glUseProgram(marchPrograms_.get(frame.features.marching()).name());
    glUniform1ui(TERRAY_UNIFORM_NODE, static_cast<GLuint>(frame.nodes.size()));
    dispatchOverPicture(frame.view);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

void ComputeLaunch::resolve(const CastFrame& frame) {
    frame.enter(GpuPass::resolve);
    const bool linear = frame.features.linearColour;
    bindImage(TERRAY_IMAGE_COLOUR, frame.targets.colour, linear ? GL_RGBA16F : GL_RGBA8);
    if (frame.features.normals) bindImage(TERRAY_IMAGE_NORMAL, frame.targets.normal, GL_RGBA32F);
    glUseProgram(resolvePrograms_.get(frame.features.resolving()).name());
    dispatchOverPicture(frame.view);
    // What follows may sample, draw over, copy or read the picture.
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

}  // namespace terray
