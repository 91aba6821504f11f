#include <exception>
#include <memory>
#include <string>
#include <utility>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "client/output/picture.h"
#include "common/check.h"
#include "common/error.h"
#include "common/output_file.h"

namespace terray {
namespace {

constexpr int kChannels = 4;
constexpr int kCompression = 4;  // of zlib's 1 to 9

/// Brings what OpenImageIO encodes into a file. OpenImageIO 2.4 does not notice a full disk, and no exception may pass
/// through libpng: what goes wrong is kept until somebody asks.
class FileProxy final : public OIIO::Filesystem::IOProxy {
  public:
    FileProxy(const std::string& name, OutputFile& file) : IOProxy(name, Write), file_(file) {}

    [[nodiscard]] const char* proxytype() const override { return "terray"; }
    size_t write(const void* data, size_t size) override {
        if (failure_) return 0;
        try {
            file_.write({static_cast<const std::byte*>(data), size});
        } catch (const Error&) {
            failure_ = std::current_exception();
            return 0;
        }
        m_pos += static_cast<int64_t>(size);
        return size;
    }
    void rethrow() const {
        if (failure_) std::rethrow_exception(failure_);
    }

  private:
    OutputFile& file_;
    std::exception_ptr failure_;
};

}  // namespace

struct PngWriter::State {
    State(std::filesystem::path target, GridSize extent)
        : path(std::move(target)),
          size(extent),
          file(path.string() + ".partial"),
          proxy(path.string(), file),
          output(OIIO::ImageOutput::create("png")) {
        if (!output)
            throw Error(ExitCode::output,
                        "cannot write " + path.string() + ": OpenImageIO's PNG writer: " + OIIO::geterror());
    }
    /// @param done  what OpenImageIO answered
    void require(bool done) const {
        proxy.rethrow();
        if (!done) throw Error(ExitCode::output, "cannot encode " + path.string() + ": " + output->geterror());
    }

    std::filesystem::path path;
    GridSize size;
    int64_t rows = 0;  ///< written
    OIIO::ImageSpec spec;
    OutputFile file;
    FileProxy proxy;
    std::unique_ptr<OIIO::ImageOutput> output;  // last: it is closed before the file is
};

PngWriter::PngWriter(const std::filesystem::path& path, GridSize size) : state_(std::make_unique<State>(path, size)) {
    OIIO::ImageSpec spec(static_cast<int>(size.width), static_cast<int>(size.height), kChannels, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("png:compressionLevel", kCompression);
    state_->spec = std::move(spec);
}

PngWriter::~PngWriter() = default;

void PngWriter::write(GridView<const Rgba> rows) {
    State& state = *state_;
    TERRAY_CHECK_OP(rows.width(), ==, state.size.width);
    TERRAY_CHECK_OP(state.rows + rows.height(), <=, state.size.height);
    // Not before there are rows: libpng complains of a file that is given up without any.
    if (state.rows == 0)
        state.require(state.output->set_ioproxy(&state.proxy) && state.output->open(state.path.string(), state.spec));
    const auto bytesPerRow = static_cast<OIIO::stride_t>(rows.stride()) * kChannels;
    const auto first = static_cast<int>(state.rows), end = static_cast<int>(state.rows + rows.height());
    state.require(state.output->write_scanlines(first, end, 0, OIIO::TypeDesc::UINT8, rows.data(), OIIO::AutoStride,
                                                bytesPerRow));
    state.rows = end;
}

void PngWriter::finish() {
    State& state = *state_;
    TERRAY_CHECK_OP(state.rows, ==, state.size.height);
    state.require(state.output->close());
    state.file.publish(state.path);
}

void writePng(const std::filesystem::path& path, GridView<const Rgba> srgb) {
    PngWriter writer(path, {srgb.width(), srgb.height()});
    writer.write(srgb);
    writer.finish();
}

}  // namespace terray
