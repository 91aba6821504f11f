#pragma once

#include <cstdint>

#include "client/render/gl_objects.h"
#include "client/render/shader_library.h"
#include "common/edited_ground.h"

namespace terray {

/// Applies edits to the codes of a height tile on the GPU. GL thread only.
///
/// The shader computes in double what editedHeight() does: an edited code is the nearest to the height that the closed
/// form gives for the stored sample, but where that lies within 2^-40 of the heights involved of halfway between two.
class TileEditor {
  public:
    explicit TileEditor(const ShaderLibrary& shaders);

    /// Edits level 0 of a layer that holds the tile's stored codes. Changes the current program, image unit 0, uniform
    /// buffer 0 and storage buffers 0 and 1; what is fetched from the texture afterwards sees the edited codes.
    /// @param stored  the tile's own encoding
    void apply(GLuint heightTexture, uint32_t slot, const TileId& id, const HeightEncoding& stored,
               const EditedTile& edited);

    /// Allocated.
    [[nodiscard]] uint64_t bufferBytes() const;

  private:
    GlProgram program_;
    GlBuffer tileBuffer_;
    GlBuffer editBuffer_;
    GlBuffer segmentBuffer_;
    uint64_t editCapacity_ = 0;
    uint64_t segmentCapacity_ = 0;
};

}  // namespace terray
