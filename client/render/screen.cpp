#include "client/render/screen.h"

#include <algorithm>

namespace terray {

Screen::Screen() : framebuffer_(makeFramebuffer()) {}

void Screen::show(const FrameTargets& targets, int width, int height) {
    const bool sameSize = targets.width() == width && targets.height() == height;
    glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, targets.colour.name(), 0);
    glDisable(GL_FRAMEBUFFER_SRGB);  // bytes are copied as they are
    glDisable(GL_SCISSOR_TEST);
    glBlitNamedFramebuffer(framebuffer_.name(), 0, 0, 0, targets.width(), targets.height(), 0, 0, width, height,
                           GL_COLOR_BUFFER_BIT, sameSize ? GL_NEAREST : GL_LINEAR);
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
