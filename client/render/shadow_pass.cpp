#include "client/render/shadow_pass.h"

#include <algorithm>
#include <cmath>

namespace terray {

ShadowPass::ShadowPass(const ShaderLibrary& shaders)
    : rasterPrograms_(shaders, {"screen.vert", "shadow.frag"}),
      computePrograms_(shaders, {"shadow.comp"}),
      parameterBuffer_(makeBuffer()) {
    glNamedBufferStorage(parameterBuffer_.name(), sizeof(interop::ShadowParameters), nullptr, GL_DYNAMIC_STORAGE_BIT);
}

uint64_t ShadowPass::bufferBytes() const {
    return cellCapacity_ * sizeof(interop::ShadowCell) + sizeof(interop::ShadowParameters);
}

void ShadowPass::cast(const CastFrame& frame, ShadowScene scene, const ShadowOptions& options, RasterLaunch* raster) {
    frame.enter(GpuPass::shadow);
    const bool soft = options.sunDiameter > 0;
    scene.parameters.sun = glm::vec4(std::tan(options.sunDiameter / 2), soft ? options.rays : 1, 0, 0);
    if (scene.cells.size() > cellCapacity_) {
        cellCapacity_ = 2 * scene.cells.size();
        cellBuffer_ = makeBuffer();
        glNamedBufferStorage(cellBuffer_.name(), static_cast<GLsizeiptr>(cellCapacity_ * sizeof(interop::ShadowCell)),
                             nullptr, GL_DYNAMIC_STORAGE_BIT);
    }
    glNamedBufferSubData(cellBuffer_.name(), 0,
                         static_cast<GLsizeiptr>(scene.cells.size() * sizeof(interop::ShadowCell)), scene.cells.data());
    glNamedBufferSubData(parameterBuffer_.name(), 0, sizeof(scene.parameters), &scene.parameters);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TERRAY_BUFFER_SHADOW_CELLS, cellBuffer_.name());
    glBindBufferBase(GL_UNIFORM_BUFFER, TERRAY_BUFFER_SHADOW, parameterBuffer_.name());

    const ShadowTargets& targets = frame.targets.shadow();
    FeatureSet features = frame.features.shadowing();
    features.softSun = soft;
    if (frame.features.statistics) {
        glBindImageTexture(TERRAY_IMAGE_SHADOW_STEPS, targets.steps.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32UI);
    }
    if (raster != nullptr) {
        raster->drawScreen(rasterPrograms_.get(features), targets.framebuffer);
    } else {
        glBindImageTexture(TERRAY_IMAGE_SUN_LIGHT, targets.sunLight.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R8);
        ComputeLaunch::dispatchScreen(computePrograms_.get(features), frame.view);
        glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    }
    glBindTextureUnit(TERRAY_UNIT_SUN_LIGHT, targets.sunLight.name());
}

}  // namespace terray
