#include "client/render/screen.h"

#include <algorithm>

#include "common/check.h"

namespace terray {

Screen::Screen() : framebuffer_(makeFramebuffer()) {}

void Screen::show(const FrameTargets& targets, int width, int height) {
    show(targets.colour, {targets.width(), targets.height()}, {width, height});
}

void Screen::keep(const FrameTargets& targets) {
    kept_ = {makeTexture(GL_TEXTURE_2D), targets.width(), targets.height()};
    glTextureStorage2D(kept_.colour.name(), 1, GL_RGBA8, kept_.width, kept_.height);
    glCopyImageSubData(targets.colour.name(), GL_TEXTURE_2D, 0, 0, 0, 0, kept_.colour.name(), GL_TEXTURE_2D, 0, 0, 0, 0,
                       kept_.width, kept_.height, 1);
}

void Screen::showKept(int width, int height) {
    TERRAY_CHECK(kept_.colour.name() != 0);
    show(kept_.colour, {kept_.width, kept_.height}, {width, height});
}

void Screen::show(const GlTexture& colour, glm::ivec2 size, glm::ivec2 window) {
    glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, colour.name(), 0);
    glDisable(GL_FRAMEBUFFER_SRGB);  // bytes are copied as they are
    glDisable(GL_SCISSOR_TEST);
    glBlitNamedFramebuffer(framebuffer_.name(), 0, 0, 0, size.x, size.y, 0, 0, window.x, window.y, GL_COLOR_BUFFER_BIT,
                           size == window ? GL_NEAREST : GL_LINEAR);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);  // what is drawn over the picture goes there too
}

Grid<Rgba> readScreen(int width, int height) {
    Grid<Rgba> rows({width, height});
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rows.cells().data());
    Grid<Rgba> picture({width, height});
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            picture.at(column, row) = rows.at(column, height - 1 - row);
            picture.at(column, row)[3] = 255;
        }
    return picture;
}

}  // namespace terray
