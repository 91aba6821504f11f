#include "client/render/frame_targets.h"

#include <algorithm>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "common/check.h"
#include "common/error.h"

namespace terray {
namespace {

GlTexture makeTarget(GLenum format, int width, int height) {
    GlTexture texture = makeTexture(GL_TEXTURE_2D);
    glTextureStorage2D(texture.name(), 1, format, width, height);
    // Read by texelFetch only; integers would be incomplete with linear filters.
    glTextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
}

/// A framebuffer of colour attachments 0, 1, ... (those that exist) and perhaps a depth buffer.
GlFramebuffer makeTargetFramebuffer(const char* purpose, std::initializer_list<GLuint> colours, GLuint depth) {
    GlFramebuffer framebuffer = makeFramebuffer();
    std::vector<GLenum> drawBuffers;
    for (const GLuint colour : colours) {
        if (colour == 0) continue;
        drawBuffers.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(drawBuffers.size()));
        glNamedFramebufferTexture(framebuffer.name(), drawBuffers.back(), colour, 0);
    }
    glNamedFramebufferDrawBuffers(framebuffer.name(), static_cast<GLsizei>(drawBuffers.size()), drawBuffers.data());
    if (depth != 0) glNamedFramebufferTexture(framebuffer.name(), GL_DEPTH_ATTACHMENT, depth, 0);
    const GLenum status = glCheckNamedFramebufferStatus(framebuffer.name(), GL_DRAW_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE) {
        throw Error(ExitCode::graphics, std::string("cannot make the framebuffer of the ") + purpose +
                                            " pass: the driver answers status " + std::to_string(status) +
                                            ", expected complete (36053); the GPU lacks memory or a format");
    }
    return framebuffer;
}

/// A texture's cells with the top of the picture first. @param format, type  of one T
template <class T>
Grid<T> readTexture(const GlTexture& texture, GridSize size, GLenum format, GLenum type) {
    TERRAY_CHECK(texture.name() != 0);
    Grid<T> bottomUp(size);
    // Images that shaders wrote are read as well, so their writes must have arrived.
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureImage(texture.name(), 0, format, type, static_cast<GLsizei>(bottomUp.cells().size_bytes()),
                      bottomUp.cells().data());
    Grid<T> topDown(size);
    for (int64_t y = 0; y < size.height; ++y) {
        std::ranges::copy(bottomUp.view().row(size.height - 1 - y), topDown.view().row(y).begin());
    }
    return topDown;
}

}  // namespace

FrameTargets::FrameTargets(int width, int height, const FeatureSet& features, ColourFormat format)
    : width_(width), height_(height), features_(features), format_(format) {
    TERRAY_CHECK_OP(width, >, 0);
    TERRAY_CHECK_OP(height, >, 0);
    features_.linearColour = format == ColourFormat::linearFloat;
    const auto target = [&](GLenum textureFormat, uint64_t texelBytes) {
        bytes_ += static_cast<uint64_t>(GridSize{width, height}.count()) * texelBytes;
        return makeTarget(textureFormat, width, height);
    };
    hit = target(GL_RGBA32F, 16);
    node = target(GL_R32UI, 4);
    colour = format == ColourFormat::srgb8 ? target(GL_RGBA8, 4) : target(GL_RGBA16F, 8);
    if (features.statistics) steps = target(GL_R32UI, 4);
    if (features.normals) normal = target(GL_RGBA32F, 16);
}

const RasterTargets& FrameTargets::raster(bool occlusion) {
    if (raster_ && static_cast<bool>(raster_->id) == occlusion) return *raster_;
    raster_.reset();
    RasterTargets made;
    const auto target = [&](GLenum textureFormat) {
        made.bytes += static_cast<uint64_t>(GridSize{width_, height_}.count()) * 4;
        return makeTarget(textureFormat, width_, height_);
    };
    made.depth = target(GL_DEPTH_COMPONENT32F);
    if (occlusion) {
        made.id = target(GL_R32UI);
        made.idFramebuffer = makeTargetFramebuffer("tile-id", {made.id.name()}, made.depth.name());
    }
    made.marchFramebuffer = makeTargetFramebuffer("ray-cast", {hit.name(), node.name()}, made.depth.name());
    made.resolveFramebuffer = makeTargetFramebuffer("resolve", {colour.name(), normal.name()}, 0);
    raster_ = std::make_unique<RasterTargets>(std::move(made));
    return *raster_;
}

const ShadowTargets& FrameTargets::shadow() {
    if (shadow_) return *shadow_;
    const auto pixels = static_cast<uint64_t>(GridSize{width_, height_}.count());
    ShadowTargets made;
    made.sunLight = makeTarget(GL_R8, width_, height_);
    made.bytes = pixels;
    if (features_.statistics) {
        made.steps = makeTarget(GL_R32UI, width_, height_);
        made.bytes += 4 * pixels;
    }
    made.framebuffer = makeTargetFramebuffer("shadow", {made.sunLight.name()}, 0);
    shadow_ = std::make_unique<ShadowTargets>(std::move(made));
    return *shadow_;
}

const OverlayTargets& FrameTargets::overlay() {
    if (overlay_) return *overlay_;
    OverlayTargets made;
    made.depth = makeTarget(GL_DEPTH_COMPONENT32F, width_, height_);
    made.bytes = static_cast<uint64_t>(GridSize{width_, height_}.count()) * 4;
    made.framebuffer = makeTargetFramebuffer("overlay", {colour.name()}, made.depth.name());
    overlay_ = std::make_unique<OverlayTargets>(std::move(made));
    return *overlay_;
}

Grid<std::array<uint8_t, 4>> FrameTargets::readSrgb() const {
    TERRAY_CHECK(format_ == ColourFormat::srgb8);
    auto colours = readTexture<std::array<uint8_t, 4>>(colour, {width_, height_}, GL_RGBA, GL_UNSIGNED_BYTE);
    for (std::array<uint8_t, 4>& texel : colours.cells()) texel[3] = 255;
    return colours;
}

Grid<glm::vec4> FrameTargets::readLinear() const {
    TERRAY_CHECK(format_ == ColourFormat::linearFloat);
    return readTexture<glm::vec4>(colour, {width_, height_}, GL_RGBA, GL_FLOAT);
}

Grid<glm::vec4> FrameTargets::readHits() const {
    return readTexture<glm::vec4>(hit, {width_, height_}, GL_RGBA, GL_FLOAT);
}

Grid<uint32_t> FrameTargets::readNodes() const {
    return readTexture<uint32_t>(node, {width_, height_}, GL_RED_INTEGER, GL_UNSIGNED_INT);
}

glm::vec4 FrameTargets::readHit(int column, int row) const {
    glm::vec4 texel(0);
    glGetTextureSubImage(hit.name(), 0, column, height_ - 1 - row, 0, 1, 1, 1, GL_RGBA, GL_FLOAT, sizeof(texel),
                         &texel);
    return texel;
}

uint32_t FrameTargets::readNode(int column, int row) const {
    uint32_t texel = 0;
    glGetTextureSubImage(node.name(), 0, column, height_ - 1 - row, 0, 1, 1, 1, GL_RED_INTEGER, GL_UNSIGNED_INT,
                         sizeof(texel), &texel);
    return texel;
}

Grid<uint32_t> FrameTargets::readSteps() const {
    return readTexture<uint32_t>(steps, {width_, height_}, GL_RED_INTEGER, GL_UNSIGNED_INT);
}

Grid<uint32_t> FrameTargets::readShadowSteps() const {
    TERRAY_CHECK(shadow_ != nullptr);
    return readTexture<uint32_t>(shadow_->steps, {width_, height_}, GL_RED_INTEGER, GL_UNSIGNED_INT);
}

Grid<float> FrameTargets::readSunLight() const {
    TERRAY_CHECK(shadow_ != nullptr);
    return readTexture<float>(shadow_->sunLight, {width_, height_}, GL_RED, GL_FLOAT);
}

Grid<glm::vec3> FrameTargets::readNormals() const {
    return readTexture<glm::vec3>(normal, {width_, height_}, GL_RGB, GL_FLOAT);
}

}  // namespace terray
