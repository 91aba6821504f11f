#pragma once

#include <filesystem>

namespace terray {

/// A dataset directory that appears whole or not at all.
///
/// Files are made in OUT.partial beside OUT; commit() renames it. With `replace`, an old dataset is moved aside first,
/// deleted last, and put back if the new one cannot take its place. Without commit() nothing is left behind. A
/// directory that is no dataset, or holds anything else besides one, is never replaced.
///
/// OUT.partial is locked while it is in use. One that a killed run left is removed; one that a live run uses is
/// refused.
class OutputDirectory {
  public:
    /// Throws Error(output) when OUT exists and may not be replaced, or its parent is missing or not writable.
    OutputDirectory(const std::filesystem::path& out, bool replace);
    ~OutputDirectory();
    OutputDirectory(const OutputDirectory&) = delete;
    OutputDirectory& operator=(const OutputDirectory&) = delete;

    /// The same refusals as the constructor's for OUT itself, before any work; touches nothing.
    static void check(const std::filesystem::path& out, bool replace);

    /// Where the dataset's files are to be made.
    [[nodiscard]] const std::filesystem::path& directory() const { return partial_; }
    /// Where temporary files may be made; removed by commit().
    [[nodiscard]] std::filesystem::path workDirectory() const;
    void commit();

  private:
    std::filesystem::path out_;
    std::filesystem::path partial_;
    bool replace_;
    int lock_ = -1;
};

}  // namespace terray
