#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "common/error.h"

namespace terray {

/// A file that is written under a temporary name beside its target and gets its own name only when it is whole.
/// Without commit() nothing is left behind.
class PartialFile {
  public:
    explicit PartialFile(std::filesystem::path target) : target_(std::move(target)), partial_(target_) {
        partial_ += ".partial";
    }
    PartialFile(const PartialFile&) = delete;
    PartialFile& operator=(const PartialFile&) = delete;
    ~PartialFile() {
        std::error_code ignored;  // after commit() there is nothing to remove
        std::filesystem::remove(partial_, ignored);
    }

    /// Where to write.
    [[nodiscard]] const std::filesystem::path& path() const { return partial_; }
    /// What it will be called.
    [[nodiscard]] const std::filesystem::path& target() const { return target_; }
    /// Takes the place of the target; the file must have been closed. Throws Error(output) when that fails.
    void commit() {
        std::error_code failure;
        std::filesystem::rename(partial_, target_, failure);
        if (failure) fail(failure.message());
    }
    /// Throws Error(output): the target cannot be written, and why.
    [[noreturn]] void fail(const std::string& reason) const {
        throw Error(ExitCode::output, "cannot write " + target_.string() + ": " + reason);
    }

  private:
    std::filesystem::path target_;
    std::filesystem::path partial_;
};

}  // namespace terray
