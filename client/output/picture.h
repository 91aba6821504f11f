#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "common/grid.h"
#include "common/rgba.h"

namespace terray {

/// Writes a PNG as writePng() does, row by row from the top, as rows come: of any size, in the memory of the rows given
/// at a time. The file appears whole at finish(), or not at all. Throws Error(output) when it cannot be written.
class PngWriter {
  public:
    PngWriter(const std::filesystem::path& path, GridSize size);
    ~PngWriter();

    /// The next rows, as wide as the picture and no more of them than it still lacks.
    void write(GridView<const Rgba> rows);
    /// After the last row.
    void finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Writes a picture as PNG: 8-bit sRGB with alpha, row 0 at the top, through OpenImageIO. The file appears whole or not
/// at all. Throws Error(output) when it cannot be written.
void writePng(const std::filesystem::path& path, GridView<const Rgba> srgb);

/// Reads a picture of 8 bits a channel, such as a PNG, through OpenImageIO: grey becomes red, green and blue, missing
/// alpha 255; colours are as stored, not multiplied by alpha. Throws Error(input) when it is missing, damaged, or of
/// another kind.
[[nodiscard]] Grid<Rgba> readPicture(const std::filesystem::path& path);

/// A picture with everything that is known of each pixel. All grids have one size; row 0 is the top.
struct MeasuredPicture {
    Grid<glm::vec4> colour;        ///< linear, primaries of sRGB; alpha 1
    Grid<float> depthMetres;       ///< along the view axis; infinity where there is sky
    glm::dvec3 positionOrigin{0};  ///< world, metres: add it to positions
    Grid<glm::vec3> position;      ///< of the hit, world, metres less positionOrigin; 0 where there is sky
    Grid<glm::vec3> normal;        ///< world (east, north, up), unit length; 0 where there is sky
    Grid<uint32_t> nodeLevel;      ///< level of the height tile that was hit; 0 where there is sky
    Grid<uint32_t> steps;          ///< of the pixel's ray over all nodes
    Grid<uint32_t> hit;            ///< 1: ground, 0: sky
};

/// Writes such a picture as OpenEXR, ZIP-compressed: channels R G B A (half), depth.metres, position.x/y/z,
/// normal.x/y/z (float), node.level, ray.steps, ray.hit (unsigned integers). The attribute "terray:positionOrigin"
/// (three doubles) belongs to position: floats alone would leave decimetres at UTM northings. The file appears whole or
/// not at all. Throws Error(output) when it cannot be written.
void writeExr(const std::filesystem::path& path, const MeasuredPicture& picture);

/// A number of each pixel under a name.
struct NamedChannel {
    std::string name;
    Grid<float> values;
};

/// Writes numbers as OpenEXR, ZIP-compressed, a float channel each; at least one, all of one size. Otherwise as above.
void writeExr(const std::filesystem::path& path, std::span<const NamedChannel> channels);

}  // namespace terray
