#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace terray {

using Bytes = std::vector<std::byte>;
using ByteView = std::span<const std::byte>;

static_assert(std::endian::native == std::endian::little, "files are little-endian; a big-endian port must swap here");

/// Reads little-endian numbers from bytes that nobody vouches for.
///
/// Never reads past the end: the first read that would do so fails, and so does every one after it. Read all fields of
/// a record, then ask ok() once. A failed read returns zero.
class ByteReader {
  public:
    explicit ByteReader(ByteView bytes) : bytes_(bytes) {}

    [[nodiscard]] bool ok() const { return ok_; }
    [[nodiscard]] size_t position() const { return position_; }
    [[nodiscard]] size_t remaining() const { return bytes_.size() - position_; }

    template <class T>
    requires(std::is_arithmetic_v<T>) T read() {
        T value{};
        const ByteView field = take(sizeof(T));
        if (ok_) std::memcpy(&value, field.data(), sizeof(T));
        return value;
    }
    /// The next `count` bytes, as a view into the input; empty when there are not that many.
    ByteView take(size_t count) {
        if (!ok_ || count > remaining()) {
            ok_ = false;
            return {};
        }
        const ByteView field = bytes_.subspan(position_, count);
        position_ += count;
        return field;
    }
    /// An unsigned LEB128 number, as PMTiles directories and protocol buffers use; over 64 bits fails.
    uint64_t readVarint() {
        uint64_t value = 0;
        for (int shift = 0; shift < 64; shift += 7) {
            const uint64_t next = read<uint8_t>();
            if (!ok_ || (shift == 63 && next > 1)) break;
            value |= (next & 0x7f) << shift;
            if ((next & 0x80) == 0) return value;
        }
        ok_ = false;
        return 0;
    }

  private:
    ByteView bytes_;
    size_t position_ = 0;
    bool ok_ = true;
};

/// Appends little-endian numbers to a growing array; the inverse of ByteReader.
class ByteWriter {
  public:
    template <class T>
    requires(std::is_arithmetic_v<T>) void write(T value) {
        std::byte field[sizeof(T)];
        std::memcpy(field, &value, sizeof(T));
        bytes_.insert(bytes_.end(), field, field + sizeof(T));
    }
    void writeBytes(ByteView bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
    void writeText(std::string_view text) { writeBytes(std::as_bytes(std::span(text))); }
    void writeVarint(uint64_t value) {
        for (; value >= 0x80; value >>= 7) write(static_cast<uint8_t>(value | 0x80));
        write(static_cast<uint8_t>(value));
    }

    [[nodiscard]] size_t size() const { return bytes_.size(); }
    [[nodiscard]] const Bytes& bytes() const { return bytes_; }
    /// Hands the array over and leaves this writer empty.
    [[nodiscard]] Bytes release() { return std::move(bytes_); }

  private:
    Bytes bytes_;
};

}  // namespace terray
