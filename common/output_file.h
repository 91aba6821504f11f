#pragma once

#include <filesystem>

#include "common/bytes.h"

namespace terray {

/// A file being written under a temporary name: publish() gives it its final name once all of it is on the disk, and
/// without publish() nothing is left behind. Buffered; one thread. Every failure throws Error(output) with path and
/// reason.
class OutputFile {
  public:
    /// Creates or truncates `path`.
    explicit OutputFile(std::filesystem::path path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(ByteView bytes);
    /// Appends all that `other` holds, by the kernel's own copy where the file system offers it, else 1 MiB at a time.
    void append(OutputFile& other);
    /// Bytes written so far.
    [[nodiscard]] uint64_t size() const { return size_; }
    /// Forces the content to the disk, renames the file (replacing what had that name), and forces the new name there
    /// too.
    void publish(const std::filesystem::path& target);

  private:
    void flush();
    void writeAll(ByteView bytes);
    [[noreturn]] void refuse(const std::string& what) const;

    std::filesystem::path path_;
    int descriptor_ = -1;
    uint64_t size_ = 0;
    Bytes buffer_;
};

/// Writes a file that appears whole or not at all, by way of `target` with ".partial" appended. Throws as OutputFile
/// does.
void writeWholeFile(const std::filesystem::path& target, ByteView content);

}  // namespace terray
