#include "client/render/tile_editor.h"

#include <algorithm>
#include <vector>

#include "common/tiling.h"
#include "shaders/interop.h"

namespace terray {
namespace {

constexpr int kGroupSide = 8;  // of edit.comp

double kindOf(const TerrainEdit& edit) {
    switch (edit.kind) {
        case TerrainEdit::Kind::crater:
            return TERRAY_EDIT_CRATER;
        case TerrainEdit::Kind::raise:
            return TERRAY_EDIT_RAISE;
        case TerrainEdit::Kind::level:
            break;
    }
    return TERRAY_EDIT_LEVEL;
}

interop::EditedTileParameters parametersOf(uint32_t slot, const TileId& id, const HeightEncoding& stored,
                                           const EditedTile& edited) {
    const GridRect core = Tiling::coreSamples(id);
    return {.samples = {static_cast<double>(core.x - kHeightApron), static_cast<double>(core.y - kHeightApron),
                        edited.spacing, slot},
            .ground = {edited.corner, static_cast<double>(edited.edits.size()), 0},
            .codes = {static_cast<double>(stored.offset), stored.metresPerCode(),
                      static_cast<double>(edited.encoding.offset), edited.encoding.metresPerCode()}};
}

/// Puts values into a buffer, a larger one if need be.
template <class Value>
void fill(GlBuffer& buffer, uint64_t& capacity, const std::vector<Value>& values) {
    if (values.size() > capacity) {
        capacity = 2 * values.size();
        buffer = makeBuffer();
        glNamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(capacity * sizeof(Value)), nullptr,
                             GL_DYNAMIC_STORAGE_BIT);
    }
    glNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(values.size() * sizeof(Value)), values.data());
}

}  // namespace

TileEditor::TileEditor(const ShaderLibrary& shaders)
    : program_(shaders.require({"edit.comp"}, {})), tileBuffer_(makeBuffer()) {
    glNamedBufferStorage(tileBuffer_.name(), sizeof(interop::EditedTileParameters), nullptr, GL_DYNAMIC_STORAGE_BIT);
}

void TileEditor::apply(GLuint heightTexture, uint32_t slot, const TileId& id, const HeightEncoding& stored,
                       const EditedTile& edited) {
    std::vector<interop::EditParameters> edits;
    std::vector<interop::dvec4> segments;
    for (const TerrainEdit& edit : edited.edits) {
        const auto first = static_cast<double>(segments.size());
        for (const EditSegment& segment : edit.line) segments.emplace_back(segment.from, segment.to);
        edits.push_back({.shape = {edit.radius, edit.full, edit.height, edit.rim},
                         .line = {kindOf(edit), first, static_cast<double>(segments.size()), reachOf(edit)}});
    }
    const interop::EditedTileParameters parameters = parametersOf(slot, id, stored, edited);
    glNamedBufferSubData(tileBuffer_.name(), 0, sizeof(parameters), &parameters);
    fill(editBuffer_, editCapacity_, edits);
    fill(segmentBuffer_, segmentCapacity_, segments);

    glUseProgram(program_.name());
    glBindBufferBase(GL_UNIFORM_BUFFER, TERRAY_BUFFER_EDITED_TILE, tileBuffer_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TERRAY_BUFFER_EDITS, editBuffer_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TERRAY_BUFFER_EDIT_SEGMENTS, segmentBuffer_.name());
    glBindImageTexture(TERRAY_IMAGE_EDITED_CODES, heightTexture, 0, GL_TRUE, 0, GL_READ_WRITE, GL_R16UI);
    constexpr GLuint kGroups = (kHeightTileSide + kGroupSide - 1) / kGroupSide;
    glDispatchCompute(kGroups, kGroups, 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

uint64_t TileEditor::bufferBytes() const {
    return sizeof(interop::EditedTileParameters) + editCapacity_ * sizeof(interop::EditParameters) +
           segmentCapacity_ * sizeof(interop::dvec4);
}

}  // namespace terray
