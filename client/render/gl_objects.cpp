#include "client/render/gl_objects.h"

namespace terray {

namespace detail {

void destroyTexture(GLuint name) {
    glDeleteTextures(1, &name);
}
void destroyBuffer(GLuint name) {
    glDeleteBuffers(1, &name);
}
void destroyFramebuffer(GLuint name) {
    glDeleteFramebuffers(1, &name);
}
void destroyVertexArray(GLuint name) {
    glDeleteVertexArrays(1, &name);
}
void destroyShader(GLuint name) {
    glDeleteShader(name);
}
void destroyProgram(GLuint name) {
    glDeleteProgram(name);
}
void destroySampler(GLuint name) {
    glDeleteSamplers(1, &name);
}
void destroyQuery(GLuint name) {
    glDeleteQueries(1, &name);
}

}  // namespace detail

GlTexture makeTexture(GLenum target) {
    GLuint name = 0;
    glCreateTextures(target, 1, &name);
    return GlTexture(name);
}

GlBuffer makeBuffer() {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    return GlBuffer(name);
}

GlFramebuffer makeFramebuffer() {
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    return GlFramebuffer(name);
}

GlVertexArray makeVertexArray() {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    return GlVertexArray(name);
}

GlSampler makeSampler() {
    GLuint name = 0;
    glCreateSamplers(1, &name);
    return GlSampler(name);
}

GlQuery makeQuery(GLenum target) {
    GLuint name = 0;
    glCreateQueries(target, 1, &name);
    return GlQuery(name);
}

}  // namespace terray
