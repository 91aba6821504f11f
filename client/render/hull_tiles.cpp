#include "client/render/hull_tiles.h"

#include <algorithm>
#include <cmath>

#include "common/tiling.h"

namespace terray {
namespace {

constexpr int kGroupSide = 8;  // of hull.comp

GLuint groupsOver(int texels) {
    return static_cast<GLuint>((texels + kGroupSide - 1) / kGroupSide);
}

}  // namespace

HullTiles::HullTiles(int side, uint32_t slots, const ShaderLibrary& shaders)
    : side_(side),
      slots_(slots),
      hulls_(makeTexture(GL_TEXTURE_2D_ARRAY)),
      pushes_(makeBuffer()),
      program_(shaders.require({"methods/hull.comp"}, {})) {
    glTextureStorage3D(hulls_.name(), 1, GL_R32F, side + 1, side + 1, static_cast<GLsizei>(slots));
    glTextureParameteri(hulls_.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(hulls_.name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glNamedBufferStorage(pushes_.name(), static_cast<GLsizeiptr>(sizeof(float)) * side * side, nullptr, 0);
}

void HullTiles::build(const PreparedTile& tile) {
    glUseProgram(program_.name());
    glBindTextureUnit(TERRAY_UNIT_HEIGHTS, tile.heightTexture);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, pushes_.name());
    glBindImageTexture(0, hulls_.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R32F);
    glUniform2i(0, static_cast<GLint>(tile.slot), side_);
    glUniform1i(1, 0);  // steps one and two: quads
    glDispatchCompute(groupsOver(side_), groupsOver(side_), 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    glUniform1i(1, 1);  // step three: vertices
    glDispatchCompute(groupsOver(side_ + 1), groupsOver(side_ + 1), 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

void HullTiles::bind() const {
    glBindTextureUnit(TERRAY_UNIT_METHOD, hulls_.name());
}

/// Clip distances cut off what lies beyond the cell.
HullTiles::Quads HullTiles::quadsOf(const interop::NodeParameters& node) const {
    const float quad = static_cast<float>(kTileCore) / static_cast<float>(side_);
    const auto first = [&](float from) { return static_cast<GLint>(std::floor(from / quad)); };
    const auto last = [&](float to) { return static_cast<GLint>(std::ceil(to / quad)); };
    const GLint column = first(node.boxMin.x), row = first(node.boxMin.y);
    return {.column = column, .row = row, .columns = last(node.boxMax.x) - column, .rows = last(node.boxMax.y) - row};
}

uint64_t HullTiles::triangles(const interop::NodeParameters& node) const {
    const Quads quads = quadsOf(node);
    return 2 * static_cast<uint64_t>(quads.columns) * static_cast<uint64_t>(quads.rows);
}

void HullTiles::draw(const interop::NodeParameters& node) const {
    const Quads quads = quadsOf(node);
    glUniform3i(TERRAY_UNIFORM_GEOMETRY, quads.column, quads.row, side_);
    triangles_ += triangles(node);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 2 * (quads.columns + 1), quads.rows);
}

uint64_t HullTiles::bytes() const {
    const auto vertices = static_cast<uint64_t>(side_ + 1) * static_cast<uint64_t>(side_ + 1);
    return sizeof(float) * (slots_ * vertices + static_cast<uint64_t>(side_) * static_cast<uint64_t>(side_));
}

double HullTiles::bytesPerTriangle() const {
    const auto triangles = 2 * slots_ * static_cast<uint64_t>(side_) * static_cast<uint64_t>(side_);
    return static_cast<double>(bytes()) / static_cast<double>(triangles);
}

}  // namespace terray
