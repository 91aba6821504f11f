#pragma once

#include <cstdint>
#include <memory>

#include "client/render/gl_objects.h"
#include "client/render/method.h"
#include "client/render/shader_library.h"
#include "common/height_tile.h"
#include "common/tiling.h"

namespace terray {

/// A height tile that lies in a layer of the height array, codes and pyramid, as it is drawn.
struct PreparedTile {
    TileId id;
    uint32_t slot = 0;
    GLuint heightTexture = 0;
    HeightEncoding encoding;
    HeightRecord record;
    const Grid<uint16_t>* codes = nullptr;  ///< null: edited, so only the GPU has them
};

/// What a method keeps on the GPU of each resident height tile, beside its heights and their pyramid, and the geometry
/// that it makes of it. GL thread only.
class MethodTiles {
  public:
    virtual ~MethodTiles() = default;
    MethodTiles(const MethodTiles&) = delete;
    MethodTiles& operator=(const MethodTiles&) = delete;

    /// Makes it for a tile, in place of what its layer had before. Changes the current program, texture unit 0, image
    /// unit 0 and storage buffer 0.
    virtual void build(const PreparedTile& tile) = 0;
    /// Binds what the method's programs read beside heights.
    virtual void bind() const {}
    /// Allocated.
    [[nodiscard]] virtual uint64_t bytes() const = 0;

    // Of methods that rasterise geometry; the others have none.
    /// Draws the triangles of a node by the program in use.
    virtual void draw(const interop::NodeParameters&) const {}
    /// How many draw() draws of a node, or about as many.
    [[nodiscard]] virtual uint64_t triangles(const interop::NodeParameters&) const { return 0; }
    /// Whether draw() has no geometry to make first.
    [[nodiscard]] virtual bool isMade(const interop::NodeParameters&) const { return true; }
    /// That draw() has drawn since it was asked last.
    [[nodiscard]] virtual uint64_t takeTriangles() const { return 0; }
    /// How far a slot's geometry may lie from the ground, codes.
    [[nodiscard]] virtual float slack(uint32_t) const { return 0; }
    /// Over all tiles that it has; 0 before the first.
    [[nodiscard]] virtual double bytesPerTriangle() const { return 0; }

  protected:
    MethodTiles() = default;
};

/// What tiles are prepared for.
struct MethodScene {
    MethodOptions method;
    Tiling tiling;
    double earthBend = 0;  ///< the greatest drop of the earth per squared metre; 0: flat
};

/// For so many slots; null when the method needs nothing. @param shaders  outlives the object
[[nodiscard]] std::unique_ptr<MethodTiles> makeMethodTiles(const MethodScene& scene, uint32_t slots,
                                                           const ShaderLibrary& shaders);

}  // namespace terray
