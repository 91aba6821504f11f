#include "client/render/cone_tiles.h"

#include "common/tiling.h"

namespace terray {
namespace {

constexpr int kGroupSide = 8;  // of cones.comp

}  // namespace

ConeTiles::ConeTiles(int side, int reach, uint32_t slots, const ShaderLibrary& shaders)
    : side_(side),
      reach_(reach),
      slots_(slots),
      cones_(makeTexture(GL_TEXTURE_2D_ARRAY)),
      program_(shaders.require({"methods/cones.comp"}, {})) {
    glTextureStorage3D(cones_.name(), 1, GL_R16F, side, side, static_cast<GLsizei>(slots));
    glTextureParameteri(cones_.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(cones_.name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void ConeTiles::build(const PreparedTile& tile) {
    glUseProgram(program_.name());
    glBindTextureUnit(TERRAY_UNIT_HEIGHTS, tile.heightTexture);
    glBindImageTexture(0, cones_.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R16F);
    glUniform3i(0, static_cast<GLint>(tile.slot), side_, reach_);
    const auto groups = static_cast<GLuint>(side_ / kGroupSide);
    glDispatchCompute(groups, groups, 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

void ConeTiles::bind() const {
    glBindTextureUnit(TERRAY_UNIT_METHOD, cones_.name());
}

uint64_t ConeTiles::bytes() const {
    return sizeof(uint16_t) * slots_ * static_cast<uint64_t>(side_) * static_cast<uint64_t>(side_);
}

}  // namespace terray
