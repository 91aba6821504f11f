#pragma once

#include <glm/vec2.hpp>

#include "client/render/frame_targets.h"
#include "common/grid.h"
#include "common/rgba.h"

namespace terray {

/// Brings pictures to the window of the current context. GL thread only.
class Screen {
  public:
    Screen();

    /// Fills the window's back buffer with a picture, scaled bilinearly where their sizes differ. The picture's bytes
    /// are sRGB already (ColourFormat::srgb8). @param width, height  of the window, pixels
    void show(const FrameTargets& targets, int width, int height);

    /// Keeps a copy of a picture, which showKept() shows however the targets change, until forget().
    void keep(const FrameTargets& targets);
    void showKept(int width, int height);
    void forget() { kept_ = {}; }

  private:
    struct Kept {
        GlTexture colour;
        int width = 1;
        int height = 1;
    };
    void show(const GlTexture& colour, glm::ivec2 size, glm::ivec2 window);

    GlFramebuffer framebuffer_;
    Kept kept_;
};

/// What the window's back buffer holds, row 0 at the top, alpha 255: before buffers are swapped.
[[nodiscard]] Grid<Rgba> readScreen(int width, int height);

}  // namespace terray
