#pragma once

#include <cstdint>
#include <memory>

#include "client/render/gl_objects.h"
#include "client/render/method.h"
#include "client/render/shader_library.h"
#include "common/height_tile.h"

namespace terray {

/// What a method keeps on the GPU of each resident height tile, beside its heights and their pyramid, and the geometry
/// that it makes of it. GL thread only.
class MethodTiles {
  public:
    virtual ~MethodTiles() = default;
    MethodTiles(const MethodTiles&) = delete;
    MethodTiles& operator=(const MethodTiles&) = delete;

    /// Makes it for a tile whose codes and pyramid lie in a layer of the height array, in place of what the layer had
    /// before. Changes the current program, texture unit 0, image unit 0 and storage buffer 0.
    virtual void build(const HeightTile& tile, uint32_t slot, GLuint heightTexture) = 0;
    /// Binds what the method's programs read beside heights.
    virtual void bind() const = 0;
    /// Draws the triangles that the method has for a node, by the program in use. Nothing for methods without geometry.
    virtual void draw(const interop::NodeParameters& node) const = 0;
    /// Allocated.
    [[nodiscard]] virtual uint64_t bytes() const = 0;

  protected:
    MethodTiles() = default;
};

/// For so many slots; null when the method needs nothing. @param shaders  outlives the object
[[nodiscard]] std::unique_ptr<MethodTiles> makeMethodTiles(const MethodOptions& options, uint32_t slots,
                                                           const ShaderLibrary& shaders);

}  // namespace terray
