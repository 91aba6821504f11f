#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "client/render/code_maxima.h"
#include "client/render/gl_objects.h"
#include "client/render/gpu_timer.h"
#include "client/render/method_tiles.h"
#include "client/render/shader_library.h"
#include "client/render/slot_table.h"
#include "client/render/tile_editor.h"
#include "common/bytes.h"
#include "common/height_tile.h"
#include "common/imagery_tile.h"
#include "common/tile_id.h"

namespace terray {

/// How much GPU memory tiles may take. Slots are allocated once, as layers of texture arrays.
struct GpuTilesOptions {
    uint64_t heightBudgetBytes = 256ull << 20;
    uint64_t imageryBudgetBytes = 256ull << 20;
    /// Upper bounds from the dataset: no more slots than it has tiles. 0 imagery tiles: no imagery texture exists at
    /// all.
    uint64_t heightTiles = 0;
    uint64_t imageryTiles = 0;
    MethodScene method;  ///< what is kept of each height tile beside its pyramid
    /// Measure Preparation; uploads then wait for the GPU.
    bool measurePreparation = false;
};

/// Time that it took to prepare height tiles for drawing, from codes that the GPU has.
struct Preparation {
    uint64_t tiles = 0;
    double pyramidMs = 0;  ///< the maximum mipmaps of all of these
    double methodMs = 0;   ///< what the method makes of them
};

/// GPU bytes by kind.
struct GpuTileBytes {
    uint64_t heights = 0;  ///< level 0 of the height array: 516 x 516 codes a slot
    uint64_t maxima = 0;   ///< its mip levels 1..9, the maximum mipmap
    uint64_t imagery = 0;  ///< BC1 with its 4 mips
    uint64_t method = 0;   ///< what the method keeps
};

/// What the renderer must know of a resident height tile, as it is drawn: of an edited one, edited.
struct ResidentHeights {
    uint32_t slot = 0;  ///< layer of the array
    HeightEncoding encoding;
    HeightRecord record;
    CodeMaxima maxima;
};

/// The tiles that live on the GPU, in slots of two texture arrays, least recently used first out.
///
/// Heights: R16UI, 516 x 516, 10 levels. Level 0 holds the codes with their apron. Level l = 1..9 holds in its texels
/// [0, 512 >> l)^2 the maximum of the 2^l x 2^l core codes beneath and of the ring of codes around them (0 where there
/// is no surface), built by compute shader on arrival: the maximum mipmap of paper 001, section 3.2, widened so that it
/// bounds the bilinear surface too, in one texture, since mip sizes 258, 129, 64 ... 1 of the apron texture are large
/// enough for it.
/// Imagery: BC1 sRGB, 576 x 576, 4 levels.
///
/// GL thread only. Never more than the budgets, except that there is at least one slot of each kind that is used.
/// Throws Error(graphics) when the driver has less memory than that. Uploads change the current program, texture unit 0
/// and image units 0..4, by some methods storage buffer 0, those of edited tiles also uniform buffer 0 and storage
/// buffers 0 and 1.
class GpuTiles {
  public:
    /// @param shaders  outlives this object
    GpuTiles(const ShaderLibrary& shaders, const GpuTilesOptions& options);

    /// Uploads a tile and builds its pyramid, evicting the least recently used tile that is not pinned by the current
    /// frame when all slots are taken. A resident tile is replaced where it is. The tile is not pinned by this.
    /// @return done, with the evicted tile's id if one had to go; not done when every slot is pinned
    struct Upload {
        bool done = false;
        std::optional<TileId> evicted;
    };
    /// @param edited  what edits make of the tile; null: nothing. The first edited tile compiles the shader for it.
    /// @param timer   told when an edited tile is made, from its upload to its pyramid; may be null
    Upload uploadHeights(const HeightTile& tile, const EditedTile* edited = nullptr, GpuTimer* timer = nullptr);
    /// @param chain  gatherMipChain's bytes
    Upload uploadImagery(const TileId& id, ByteView chain);

    /// Frees a tile's slot, pinned or not; a tile that is not resident is left alone.
    void evictHeights(const TileId& id);

    /// Starts a frame: nothing is pinned any more.
    void beginFrame();
    /// Marks a tile as used by this frame: most recently used, and not evictable until the next beginFrame().
    /// It must be resident.
    void pinHeights(const TileId& id);
    void pinImagery(const TileId& id);
    /// Marks as recently used without pinning (ancestors of what is drawn); a tile that is not resident is left alone.
    void touchHeights(const TileId& id);
    void touchImagery(const TileId& id);

    [[nodiscard]] const ResidentHeights* heights(const TileId& id) const;
    /// The resident height tiles, in the order of their ids.
    [[nodiscard]] std::vector<TileId> heightTiles() const;
    [[nodiscard]] std::optional<uint32_t> imagerySlot(const TileId& id) const;

    [[nodiscard]] GLuint heightTexture() const { return heightTexture_.name(); }
    /// 0 when the dataset has no imagery.
    [[nodiscard]] GLuint imageryTexture() const { return imageryTexture_.name(); }
    [[nodiscard]] uint32_t heightSlots() const { return heightSlots_.capacity(); }
    [[nodiscard]] uint32_t imagerySlots() const { return imagerySlots_.capacity(); }
    [[nodiscard]] size_t residentHeights() const { return heightSlots_.size(); }
    [[nodiscard]] size_t residentImagery() const { return imagerySlots_.size(); }
    /// Null for methods that keep nothing of a tile.
    [[nodiscard]] const MethodTiles* methodTiles() const { return methodTiles_.get(); }
    /// Of all uploads so far; zeros unless it was asked for.
    [[nodiscard]] const Preparation& preparation() const { return preparation_; }
    /// Allocated, whether or not filled.
    [[nodiscard]] GpuTileBytes allocatedBytes() const;
    /// Allocated for edits; 0 while no tile has been edited.
    [[nodiscard]] uint64_t editBufferBytes() const { return editor_ ? editor_->bufferBytes() : 0; }
    /// Bytes one upload moves, for upload budgets.
    [[nodiscard]] static constexpr uint64_t heightUploadBytes() {
        return uint64_t{kHeightTileSide} * kHeightTileSide * 2;
    }
    [[nodiscard]] static constexpr uint64_t imageryUploadBytes() { return imageryChainBytes(); }

  private:
    void edit(uint32_t slot, const HeightTile& tile, const EditedTile& edited);
    void buildMaxima(uint32_t slot);
    void prepare(const PreparedTile& tile);

    const ShaderLibrary& shaders_;
    SlotTable heightSlots_;
    SlotTable imagerySlots_;
    std::unordered_map<TileId, ResidentHeights> residentHeights_;
    GlTexture heightTexture_;
    GlTexture imageryTexture_;
    GlProgram maximaProgram_;
    std::unique_ptr<MethodTiles> methodTiles_;
    bool measurePreparation_;
    Preparation preparation_;
    std::unique_ptr<TileEditor> editor_;  ///< from the first edited tile on
};

}  // namespace terray
