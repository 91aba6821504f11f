#include "client/render/gpu_tiles.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>

#include "common/check.h"
#include "common/error.h"
#include "common/imagery_tile.h"
#include "common/tiling.h"

namespace terray {
namespace {

/// Level 0 and nine levels of maxima, 256 x 256 ... 1 x 1.
constexpr int kHeightLevels = 10;
static_assert(kTileCore >> (kHeightLevels - 1) == 1);
static_assert(kHeightTileSide >> (kHeightLevels - 1) == 1, "a full mip chain, as glTextureStorage3D allows");

/// Levels that one dispatch of maxima.comp builds, and source texels along the side of its work group.
constexpr int kLevelsPerDispatch = 5;
constexpr int kGroupTexels = 1 << kLevelsPerDispatch;

constexpr uint64_t heightLevelBytes(int level) {
    const auto side = static_cast<uint64_t>(kHeightTileSide >> level);
    return side * side * sizeof(uint16_t);
}

constexpr uint64_t maximaBytes() {
    uint64_t bytes = 0;
    for (int level = 1; level < kHeightLevels; ++level) bytes += heightLevelBytes(level);
    return bytes;
}

/// Slots of one kind: what the budget pays for, but no more than there are tiles or the driver has layers, and one at
/// least.
uint32_t slotCount(uint64_t budgetBytes, uint64_t slotBytes, uint64_t tiles) {
    GLint layers = 0;
    glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
    const uint64_t most = std::min(tiles, static_cast<uint64_t>(layers));
    return static_cast<uint32_t>(std::clamp<uint64_t>(budgetBytes / slotBytes, 1, std::max<uint64_t>(most, 1)));
}

struct ArrayShape {
    GLenum format = GL_NONE;
    int levels = 1;
    int side = 1;  ///< texels
    uint32_t layers = 1;
    uint64_t layerBytes = 0;
    const char* content = "";  ///< for messages
};

GlTexture makeArray(const ArrayShape& shape) {
    while (glGetError() != GL_NO_ERROR) {  // whoever left these has reported them, or the debug context has
    }
    GlTexture texture = makeTexture(GL_TEXTURE_2D_ARRAY);
    glTextureStorage3D(texture.name(), shape.levels, shape.format, shape.side, shape.side,
                       static_cast<GLsizei>(shape.layers));
    const GLenum error = glGetError();
    if (error == GL_OUT_OF_MEMORY) {
        throw Error(ExitCode::graphics, std::string("cannot allocate ") +
                                            std::to_string((shape.layers * shape.layerBytes) >> 20) +
                                            " MiB of GPU memory for " + std::to_string(shape.layers) + " tiles of " +
                                            shape.content + ": the driver has not that much; lower the GPU budget");
    }
    TERRAY_CHECK_OP(error, ==, GLenum{GL_NO_ERROR});
    glTextureParameteri(texture.name(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture.name(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

GlTexture makeHeightArray(uint32_t slots) {
    GlTexture texture = makeArray({.format = GL_R16UI,
                                   .levels = kHeightLevels,
                                   .side = kHeightTileSide,
                                   .layers = slots,
                                   .layerBytes = heightLevelBytes(0) + maximaBytes(),
                                   .content = "heights"});
    // Integers are never filtered; without this the texture would be incomplete.
    glTextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
    glTextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    // Zero, once and for all, what no dispatch writes: the last columns and rows of the levels whose size is not a
    // power of two.
    const uint16_t zero = 0;
    for (int level = 1; level < kHeightLevels; ++level) {
        const int side = kHeightTileSide >> level;
        const int core = kTileCore >> level;
        if (side == core) continue;
        const auto layers = static_cast<GLsizei>(slots);
        glClearTexSubImage(texture.name(), level, core, 0, 0, side - core, side, layers, GL_RED_INTEGER,
                           GL_UNSIGNED_SHORT, &zero);
        glClearTexSubImage(texture.name(), level, 0, core, 0, core, side - core, layers, GL_RED_INTEGER,
                           GL_UNSIGNED_SHORT, &zero);
    }
    return texture;
}

GlTexture makeImageryArray(uint32_t slots) {
    GlTexture texture = makeArray({.format = GL_COMPRESSED_SRGB_S3TC_DXT1_EXT,
                                   .levels = kImageryMips,
                                   .side = kImageryTileSide,
                                   .layers = slots,
                                   .layerBytes = GpuTiles::imageryUploadBytes(),
                                   .content = "imagery"});
    glTextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    return texture;
}

}  // namespace

GpuTiles::GpuTiles(const ShaderLibrary& shaders, const GpuTilesOptions& options)
    : shaders_(shaders),
      heightSlots_(slotCount(options.heightBudgetBytes, heightLevelBytes(0) + maximaBytes(), options.heightTiles)),
      imagerySlots_(options.imageryTiles == 0
                        ? 0
                        : slotCount(options.imageryBudgetBytes, imageryUploadBytes(), options.imageryTiles)),
      heightTexture_(makeHeightArray(heightSlots_.capacity())),
      maximaProgram_(shaders.require({"maxima.comp"}, {{"TERRAY_HEIGHT_APRON", std::to_string(kHeightApron)},
                                                       {"TERRAY_TILE_CORE", std::to_string(kTileCore)}})),
      methodTiles_(makeMethodTiles(options.method, heightSlots_.capacity(), shaders)),
      measurePreparation_(options.measurePreparation) {
    if (imagerySlots_.capacity() > 0) imageryTexture_ = makeImageryArray(imagerySlots_.capacity());
}

GpuTiles::Upload GpuTiles::uploadHeights(const HeightTile& tile, const EditedTile* edited, GpuTimer* timer) {
    TERRAY_CHECK_OP(tile.codes.width(), ==, kHeightTileSide);
    TERRAY_CHECK_OP(tile.codes.height(), ==, kHeightTileSide);
    const std::optional<SlotTable::Place> place = heightSlots_.place(tile.id);
    if (!place) return {};
    if (place->evicted) residentHeights_.erase(*place->evicted);
    if (edited != nullptr && timer != nullptr) timer->enter(GpuPass::edit);
    residentHeights_[tile.id] = {
        .slot = place->slot,
        .encoding = edited != nullptr ? edited->encoding : tile.encoding,
        .record = edited != nullptr ? edited->record : tile.record,
        .maxima = edited != nullptr ? CodeMaxima(tile, *edited) : CodeMaxima(tile.codes.view())};
    glPixelStorei(GL_UNPACK_ALIGNMENT, alignof(uint16_t));
    glTextureSubImage3D(heightTexture_.name(), 0, 0, 0, static_cast<GLint>(place->slot), kHeightTileSide,
                        kHeightTileSide, 1, GL_RED_INTEGER, GL_UNSIGNED_SHORT, tile.codes.cells().data());
    if (edited != nullptr) edit(place->slot, tile, *edited);
    const ResidentHeights& resident = residentHeights_[tile.id];
    prepare({.id = tile.id,
             .slot = place->slot,
             .heightTexture = heightTexture_.name(),
             .encoding = resident.encoding,
             .record = resident.record,
             .codes = edited != nullptr ? nullptr : &tile.codes});
    if (edited != nullptr && timer != nullptr) timer->enter(GpuPass::upload);
    return {.done = true, .evicted = place->evicted};
}

void GpuTiles::edit(uint32_t slot, const HeightTile& tile, const EditedTile& edited) {
    if (!editor_) editor_ = std::make_unique<TileEditor>(shaders_);
    editor_->apply(heightTexture_.name(), slot, tile.id, tile.encoding, edited);
}

void GpuTiles::evictHeights(const TileId& id) {
    if (heightSlots_.remove(id)) residentHeights_.erase(id);
}

GpuTiles::Upload GpuTiles::uploadImagery(const TileId& id, ByteView chain) {
    TERRAY_CHECK(imageryTexture_.name() != 0);
    TERRAY_CHECK_OP(chain.size(), ==, imageryChainBytes());
    const std::optional<SlotTable::Place> place = imagerySlots_.place(id);
    if (!place) return {};
    for (int mip = 0; mip < kImageryMips; ++mip) {
        const int side = imageryMipSide(mip);
        const ByteView blocks = chain.first(imageryMipBytes(mip));
        glCompressedTextureSubImage3D(imageryTexture_.name(), mip, 0, 0, static_cast<GLint>(place->slot), side, side, 1,
                                      GL_COMPRESSED_SRGB_S3TC_DXT1_EXT, static_cast<GLsizei>(blocks.size()),
                                      blocks.data());
        chain = chain.subspan(blocks.size());
    }
    return {.done = true, .evicted = place->evicted};
}

void GpuTiles::buildMaxima(uint32_t slot) {
    glUseProgram(maximaProgram_.name());
    glBindTextureUnit(0, heightTexture_.name());
    glUniform1i(0, static_cast<GLint>(slot));
    for (int source = 0; source + 1 < kHeightLevels; source += kLevelsPerDispatch) {
        for (int above = 1; above <= kLevelsPerDispatch; ++above) {
            // The last dispatch has fewer levels to build; the shader does not write to a level that is none.
            const int level = std::min(source + above, kHeightLevels - 1);
            glBindImageTexture(static_cast<GLuint>(above - 1), heightTexture_.name(), level, GL_TRUE, 0, GL_WRITE_ONLY,
                               GL_R16UI);
        }
        glUniform1i(1, source);
        const auto groups = static_cast<GLuint>(((kTileCore >> source) + kGroupTexels - 1) / kGroupTexels);
        glDispatchCompute(groups, groups, 1);
        // What was written is fetched by the next dispatch and by the march, and overwritten or read back later.
        glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
    }
}

/// The clock is around glFinish, since a method may work on either processor.
void GpuTiles::prepare(const PreparedTile& tile) {
    const auto timed = [this](double& milliseconds, const auto& work) {
        if (!measurePreparation_) return work();
        glFinish();
        const auto start = std::chrono::steady_clock::now();
        work();
        glFinish();
        milliseconds += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    };
    timed(preparation_.pyramidMs, [&] { buildMaxima(tile.slot); });
    if (methodTiles_) timed(preparation_.methodMs, [&] { methodTiles_->build(tile); });
    preparation_.tiles += measurePreparation_ ? 1 : 0;
}

void GpuTiles::beginFrame() {
    heightSlots_.unpinAll();
    imagerySlots_.unpinAll();
}

void GpuTiles::pinHeights(const TileId& id) {
    TERRAY_CHECK(heightSlots_.pin(id));
}

void GpuTiles::pinImagery(const TileId& id) {
    TERRAY_CHECK(imagerySlots_.pin(id));
}

void GpuTiles::touchHeights(const TileId& id) {
    (void)heightSlots_.touch(id);  // an ancestor that is not resident needs nothing
}

void GpuTiles::touchImagery(const TileId& id) {
    (void)imagerySlots_.touch(id);
}

const ResidentHeights* GpuTiles::heights(const TileId& id) const {
    const auto found = residentHeights_.find(id);
    return found == residentHeights_.end() ? nullptr : &found->second;
}

std::vector<TileId> GpuTiles::heightTiles() const {
    std::vector<TileId> tiles;
    for (const auto& [id, resident] : residentHeights_) tiles.push_back(id);
    std::ranges::sort(tiles);
    return tiles;
}

std::optional<uint32_t> GpuTiles::imagerySlot(const TileId& id) const {
    return imagerySlots_.find(id);
}

GpuTileBytes GpuTiles::allocatedBytes() const {
    return {.heights = heightSlots() * heightLevelBytes(0),
            .maxima = heightSlots() * maximaBytes(),
            .imagery = imagerySlots() * imageryUploadBytes(),
            .method = methodTiles_ ? methodTiles_->bytes() : 0};
}

}  // namespace terray
