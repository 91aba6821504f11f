#include "common/pmtiles_gzip.h"

#if TERRAY_WITH_ZLIB
#include <algorithm>
#include <limits>

#include <zlib.h>
#endif

namespace terray {

#if TERRAY_WITH_ZLIB
namespace {

constexpr int kGzipWindowBits = 15 + 16;  // zlib.h: 16 more asks for the gzip format

/// A z_stream that is ended whatever happens. zlib's interface is not const-correct: it does not write to its input.
struct Stream {
    explicit Stream(ByteView input) {
        z.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(input.data()));
        z.avail_in = static_cast<uInt>(input.size());
    }
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;
    ~Stream() {
        if (end != nullptr) end(&z);
    }
    void setOutput(Bytes& output, size_t start) {
        z.next_out = reinterpret_cast<Bytef*>(output.data() + start);
        z.avail_out = static_cast<uInt>(output.size() - start);
    }
    z_stream z{};
    int (*end)(z_stream*) = nullptr;
};

bool fitsZlib(size_t size) {
    return size <= std::numeric_limits<uInt>::max();
}

}  // namespace

Result<Bytes> gzipCompress(ByteView bytes) {
    if (!fitsZlib(bytes.size())) return Failure{"gzip: more than 4 GiB at once"};
    Stream stream(bytes);
    if (deflateInit2(&stream.z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindowBits, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return Failure{"gzip: out of memory"};
    stream.end = deflateEnd;
    Bytes packed(deflateBound(&stream.z, static_cast<uLong>(bytes.size())));
    stream.setOutput(packed, 0);
    if (deflate(&stream.z, Z_FINISH) != Z_STREAM_END) return Failure{"gzip: compression failed"};
    packed.resize(stream.z.total_out);
    return packed;
}

Result<Bytes> gzipDecompress(ByteView bytes, size_t maxBytes) {
    if (!fitsZlib(bytes.size()) || !fitsZlib(maxBytes)) return Failure{"gzip: more than 4 GiB at once"};
    Stream stream(bytes);
    if (inflateInit2(&stream.z, kGzipWindowBits) != Z_OK) return Failure{"gzip: out of memory"};
    stream.end = inflateEnd;
    // The size is not known beforehand and the format's own figure is not to be trusted: grow as data arrives.
    Bytes unpacked;
    int status = Z_OK;
    while (status == Z_OK && unpacked.size() <= maxBytes) {
        const size_t done = unpacked.size();
        unpacked.resize(std::min(maxBytes + 1, std::max<size_t>(4096, 2 * done)));
        stream.setOutput(unpacked, done);
        status = inflate(&stream.z, Z_NO_FLUSH);
        unpacked.resize(unpacked.size() - stream.z.avail_out);
    }
    if (unpacked.size() > maxBytes) return Failure{"gzip: unpacks to more than " + std::to_string(maxBytes) + " bytes"};
    if (status != Z_STREAM_END || stream.z.avail_in != 0) return Failure{"gzip: damaged or cut short"};
    return unpacked;
}

#else

namespace {

const Failure kWithoutZlib{"this build reads and writes no gzip directories (configured with TERRAY_WITH_ZLIB=OFF)"};

}  // namespace

Result<Bytes> gzipCompress(ByteView) {
    return kWithoutZlib;
}
Result<Bytes> gzipDecompress(ByteView, size_t) {
    return kWithoutZlib;
}

#endif

}  // namespace terray
