#pragma once

#include <utility>

#include <epoxy/gl.h>

namespace terray {

/// Owner of one GL object name; movable, deleted with it. Make with the functions below; needs a current context.
template <void (*destroy)(GLuint)>
class GlObject {
  public:
    GlObject() = default;
    explicit GlObject(GLuint name) : name_(name) {}
    GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    ~GlObject() {
        if (name_ != 0) destroy(name_);
    }
    [[nodiscard]] GLuint name() const { return name_; }
    explicit operator bool() const { return name_ != 0; }

  private:
    GLuint name_ = 0;
};

namespace detail {
void destroyTexture(GLuint name);
void destroyBuffer(GLuint name);
void destroyFramebuffer(GLuint name);
void destroyVertexArray(GLuint name);
void destroyShader(GLuint name);
void destroyProgram(GLuint name);
void destroySampler(GLuint name);
void destroyQuery(GLuint name);
}  // namespace detail

using GlTexture = GlObject<detail::destroyTexture>;
using GlBuffer = GlObject<detail::destroyBuffer>;
using GlFramebuffer = GlObject<detail::destroyFramebuffer>;
using GlVertexArray = GlObject<detail::destroyVertexArray>;
using GlShader = GlObject<detail::destroyShader>;    ///< of glCreateShader
using GlProgram = GlObject<detail::destroyProgram>;  ///< of glCreateProgram; see ShaderLibrary
using GlSampler = GlObject<detail::destroySampler>;
using GlQuery = GlObject<detail::destroyQuery>;

[[nodiscard]] GlTexture makeTexture(GLenum target);
[[nodiscard]] GlBuffer makeBuffer();
[[nodiscard]] GlFramebuffer makeFramebuffer();
[[nodiscard]] GlVertexArray makeVertexArray();
[[nodiscard]] GlSampler makeSampler();
[[nodiscard]] GlQuery makeQuery(GLenum target);

}  // namespace terray
