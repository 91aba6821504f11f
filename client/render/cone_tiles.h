#pragma once

#include "client/render/method_tiles.h"

namespace terray {

/// Of each height tile a relaxed cone over each of `side` x `side` blocks of samples (Policarpo and Oliveira 2007,
/// "Relaxed Cone Stepping for Relief Mapping", GPU Gems 3, chapter 18): the widest with its apex on the block's highest
/// sample in which a ray from above meets the ground at most once. With 512 a block is a sample, as theirs; the work
/// grows with the square of blocks and of `reach`.
class ConeTiles final : public MethodTiles {
  public:
    /// @param side   a power of two, 32 .. 512. @param reach  how far ground is looked at, blocks
    ConeTiles(int side, int reach, uint32_t slots, const ShaderLibrary& shaders);
    void build(const PreparedTile& tile) override;
    void bind() const override;
    [[nodiscard]] uint64_t bytes() const override;

    /// R16F, side^2 texels a slot: widths of cones, texels a code.
    [[nodiscard]] GLuint texture() const { return cones_.name(); }

  private:
    int side_;
    int reach_;
    uint32_t slots_;
    GlTexture cones_;
    GlProgram program_;
};

}  // namespace terray
