#include "client/render/mesh_tiles.h"

#include <algorithm>

namespace terray {
namespace {

/// Level 0 of a layer, as edits have left it.
Grid<uint16_t> readCodes(GLuint heightTexture, uint32_t slot) {
    Grid<uint16_t> codes({kHeightTileSide, kHeightTileSide});
    glPixelStorei(GL_PACK_ALIGNMENT, alignof(uint16_t));
    glGetTextureSubImage(heightTexture, 0, 0, 0, static_cast<GLint>(slot), kHeightTileSide, kHeightTileSide, 1,
                         GL_RED_INTEGER, GL_UNSIGNED_SHORT, static_cast<GLsizei>(codes.cells().size_bytes()),
                         codes.cells().data());
    return codes;
}

/// Vertices lie in the middle of cells: a block covers half a cell more to the east and the south.
bool touches(int block, const interop::NodeParameters& node) {
    constexpr float kReach = TerrainMesh::kBlockSide + 0.5F;
    const auto west = static_cast<float>(block % TerrainMesh::kBlocksAcross * TerrainMesh::kBlockSide);
    const auto north = static_cast<float>(block / TerrainMesh::kBlocksAcross * TerrainMesh::kBlockSide);
    return west - 0.5F < node.boxMax.x && west + kReach > node.boxMin.x && north - 0.5F < node.boxMax.y &&
           north + kReach > node.boxMin.y;
}

}  // namespace

MeshTiles::MeshTiles(const MethodScene& scene, uint32_t slots)
    : scene_(scene), meshes_(slots), vertexArray_(makeVertexArray()) {}

/// A tile is drawn where its own error is at most the selection's tolerance, so what the mesh adds is in proportion to
/// that. The finest tiles have no error: a quarter of a sample is what bends of that length can be seen to be off.
MeshTolerance MeshTiles::toleranceOf(const PreparedTile& tile) const {
    const double spacing = scene_.tiling.spacing(tile.id.level);
    const double step = tile.encoding.metresPerCode();
    const double metres = scene_.method.error * std::max(double{tile.record.error}, spacing / 4);
    return {.codes = metres / step, .sag = scene_.earthBend * spacing * spacing / 4 / step};
}

void MeshTiles::build(const PreparedTile& tile) {
    Mesh& mesh = meshes_.at(tile.slot);
    bytes_ -= mesh.starts.back() * sizeof(uint16_t);
    mesh = {.tolerance = toleranceOf(tile), .holed = tile.record.hasHoles, .heightTexture = tile.heightTexture};
    Grid<uint16_t> read;
    if (tile.codes == nullptr) read = readCodes(tile.heightTexture, tile.slot);
    const Grid<uint16_t>& codes = tile.codes != nullptr ? *tile.codes : read;
    if (scene_.method.method == Method::hybrid) {
        mesh.estimate = estimatedTriangles(codes, mesh.tolerance);
    } else {
        make(mesh, codes);
    }
}

void MeshTiles::make(Mesh& mesh, const Grid<uint16_t>& codes) const {
    const TerrainMesh made = triangulated(codes, mesh.tolerance);
    mesh.indices = makeBuffer();
    mesh.starts = made.starts;
    bytes_ += mesh.starts.back() * sizeof(uint16_t);
    if (!made.indices.empty())
        glNamedBufferStorage(mesh.indices.name(), static_cast<GLsizeiptr>(made.indices.size() * sizeof(uint16_t)),
                             made.indices.data(), 0);
}

void MeshTiles::draw(const interop::NodeParameters& node) const {
    Mesh& mesh = meshes_.at(node.source.x);
    if (!mesh.indices) make(mesh, readCodes(mesh.heightTexture, node.source.x));
    // The blocks that the node's cell touches; clip distances cut off what lies beyond it.
    std::array<GLsizei, TerrainMesh::kBlocks> counts{};
    std::array<const void*, TerrainMesh::kBlocks> offsets{};
    std::array<GLint, TerrainMesh::kBlocks> bases{};
    GLsizei blocks = 0;
    for (int block = 0; block < TerrainMesh::kBlocks; ++block) {
        const auto place = static_cast<size_t>(block);
        const uint32_t first = mesh.starts[place], end = mesh.starts[place + 1];
        if (!touches(block, node) || first == end) continue;
        const auto at = static_cast<size_t>(blocks++);
        counts[at] = static_cast<GLsizei>(end - first);
        offsets[at] = reinterpret_cast<const void*>(uintptr_t{first} * sizeof(uint16_t));
        bases[at] = block * TerrainMesh::kBlockVertices;
        drawn_ += (end - first) / 3;
    }
    if (blocks == 0) return;
    glUniform1i(TERRAY_UNIFORM_HOLED, mesh.holed ? 1 : 0);
    glBindVertexArray(vertexArray_.name());
    glVertexArrayElementBuffer(vertexArray_.name(), mesh.indices.name());
    // Through a hole the ground is seen from below.
    if (mesh.holed) glDisable(GL_CULL_FACE);
    glMultiDrawElementsBaseVertex(GL_TRIANGLES, counts.data(), GL_UNSIGNED_SHORT, offsets.data(), blocks, bases.data());
    glEnable(GL_CULL_FACE);
}

uint64_t MeshTiles::triangles(const interop::NodeParameters& node) const {
    const Mesh& mesh = meshes_.at(node.source.x);
    uint64_t indices = 0, blocks = 0;
    for (int block = 0; block < TerrainMesh::kBlocks; ++block) {
        if (!touches(block, node)) continue;
        const auto place = static_cast<size_t>(block);
        indices += mesh.starts[place + 1] - mesh.starts[place];
        ++blocks;
    }
    if (mesh.indices) return indices / 3;
    return static_cast<uint64_t>(mesh.estimate * static_cast<double>(blocks) / TerrainMesh::kBlocks);
}

bool MeshTiles::isMade(const interop::NodeParameters& node) const {
    return static_cast<bool>(meshes_.at(node.source.x).indices);
}

double MeshTiles::bytesPerTriangle() const {
    uint64_t all = 0;
    for (const Mesh& mesh : meshes_) all += mesh.starts.back() / 3;
    return all == 0 ? 0 : static_cast<double>(bytes_) / static_cast<double>(all);
}

float MeshTiles::slack(uint32_t slot) const {
    return static_cast<float>(meshes_.at(slot).tolerance.codes);
}

}  // namespace terray
