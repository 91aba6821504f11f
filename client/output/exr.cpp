#include <algorithm>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfVecAttribute.h>

#include "client/output/picture.h"
#include "common/bytes.h"
#include "common/error.h"
#include "common/output_file.h"

namespace terray {
namespace {

/// Where OpenEXR writes to: memory, since its files do not tell of a disk that is full when they are closed.
class MemoryStream final : public Imf::OStream {
  public:
    explicit MemoryStream(const std::string& name) : Imf::OStream(name.c_str()) {}
    void write(const char bytes[], int count) override {
        const auto from = std::as_bytes(std::span(bytes, static_cast<size_t>(count)));
        if (content_.size() < position_ + from.size()) content_.resize(position_ + from.size());
        std::copy(from.begin(), from.end(), content_.begin() + static_cast<std::ptrdiff_t>(position_));
        position_ += from.size();
    }
    uint64_t tellp() override { return position_; }
    void seekp(uint64_t position) override { position_ = position; }
    [[nodiscard]] const Bytes& content() const { return content_; }

  private:
    Bytes content_;
    uint64_t position_ = 0;
};

/// Collects channels, then writes them. The arrays are borrowed.
class ExrChannels {
  public:
    explicit ExrChannels(GridSize size)
        : size_(size), header_(static_cast<int>(size.width), static_cast<int>(size.height)) {
        header_.compression() = Imf::ZIP_COMPRESSION;
    }
    Imf::Header& header() { return header_; }

    /// @param component  which of the Scalars that make up a Cell
    template <class Scalar, class Cell>
    void add(const std::string& name, Imf::PixelType type, const Grid<Cell>& grid, size_t component = 0) {
        TERRAY_CHECK(grid.size() == size_);
        static_assert(sizeof(Cell) % sizeof(Scalar) == 0);
        header_.channels().insert(name, Imf::Channel(type));
        // OpenEXR reads only, but its type for both directions is char*.
        const char* first = reinterpret_cast<const char*>(grid.cells().data()) + component * sizeof(Scalar);
        pixels_.insert(name, Imf::Slice(type, const_cast<char*>(first), sizeof(Cell),
                                        sizeof(Cell) * static_cast<size_t>(size_.width)));
    }

    [[nodiscard]] Bytes encode(const std::string& name) const {
        MemoryStream stream(name);
        {
            Imf::OutputFile file(stream, header_);
            file.setFrameBuffer(pixels_);
            file.writePixels(static_cast<int>(size_.height));
        }  // writes its table of lines when it ends
        return stream.content();
    }

  private:
    GridSize size_;
    Imf::Header header_;
    Imf::FrameBuffer pixels_;
};

using HalfColour = std::array<Imath::half, 4>;

Grid<HalfColour> halves(const Grid<glm::vec4>& colour) {
    Grid<HalfColour> result(colour.size());
    for (size_t n = 0; n < colour.cells().size(); ++n) {
        const glm::vec4& c = colour.cells()[n];
        result.cells()[n] = {Imath::half(c.r), Imath::half(c.g), Imath::half(c.b), Imath::half(c.a)};
    }
    return result;
}

}  // namespace

void writeExr(const std::filesystem::path& path, const MeasuredPicture& picture) {
    const Grid<HalfColour> colour = halves(picture.colour);
    Bytes encoded;
    try {
        ExrChannels channels(picture.colour.size());
        channels.add<Imath::half>("R", Imf::HALF, colour, 0);
        channels.add<Imath::half>("G", Imf::HALF, colour, 1);
        channels.add<Imath::half>("B", Imf::HALF, colour, 2);
        channels.add<Imath::half>("A", Imf::HALF, colour, 3);
        channels.add<float>("depth.metres", Imf::FLOAT, picture.depthMetres);
        channels.add<float>("position.x", Imf::FLOAT, picture.position, 0);
        channels.add<float>("position.y", Imf::FLOAT, picture.position, 1);
        channels.add<float>("position.z", Imf::FLOAT, picture.position, 2);
        channels.add<float>("normal.x", Imf::FLOAT, picture.normal, 0);
        channels.add<float>("normal.y", Imf::FLOAT, picture.normal, 1);
        channels.add<float>("normal.z", Imf::FLOAT, picture.normal, 2);
        channels.add<uint32_t>("node.level", Imf::UINT, picture.nodeLevel);
        channels.add<uint32_t>("ray.steps", Imf::UINT, picture.steps);
        channels.add<uint32_t>("ray.hit", Imf::UINT, picture.hit);
        const glm::dvec3& origin = picture.positionOrigin;
        channels.header().insert("terray:positionOrigin", Imf::V3dAttribute({origin.x, origin.y, origin.z}));
        encoded = channels.encode(path.string());
    } catch (const std::exception& failure) {  // whatever OpenEXR throws
        throw Error(ExitCode::output, "cannot encode " + path.string() + ": " + failure.what());
    }
    writeWholeFile(path, encoded);
}

void writeExr(const std::filesystem::path& path, std::span<const NamedChannel> channels) {
    TERRAY_CHECK_OP(channels.size(), >, 0U);
    Bytes encoded;
    try {
        ExrChannels exr(channels.front().values.size());
        for (const NamedChannel& channel : channels) exr.add<float>(channel.name, Imf::FLOAT, channel.values);
        encoded = exr.encode(path.string());
    } catch (const std::exception& failure) {  // whatever OpenEXR throws
        throw Error(ExitCode::output, "cannot encode " + path.string() + ": " + failure.what());
    }
    writeWholeFile(path, encoded);
}

}  // namespace terray
