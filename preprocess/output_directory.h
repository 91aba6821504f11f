#pragma once

#include <filesystem>

namespace terray {

/// What a run may do with what it finds at its output.
struct OutputPermissions {
    bool replace = false;  ///< an old dataset may go (--force)
    bool resume = false;   ///< an unfinished build may be gone on with (--resume)
};

/// A dataset directory that appears whole or not at all.
///
/// Files are made in OUT.partial beside OUT: the dataset's in a directory of its own, which commit() renames to OUT,
/// the journal and temporary files beside it. With `replace`, an old dataset is moved aside first, deleted last, and
/// put back if the new one cannot take its place. Without commit() nothing is left behind unless keep() was called. A
/// directory that is no dataset, or holds anything else besides one, is never replaced.
///
/// OUT.partial is locked while it is in use. One that a killed run left is gone on with, or removed without `resume`;
/// one that a live run uses is refused.
class OutputDirectory {
  public:
    /// Throws Error(output) when OUT exists and may not be replaced, or its parent is missing or not writable.
    OutputDirectory(const std::filesystem::path& out, const OutputPermissions& permissions);
    ~OutputDirectory();
    OutputDirectory(const OutputDirectory&) = delete;
    OutputDirectory& operator=(const OutputDirectory&) = delete;

    /// The same refusals as the constructor's for OUT itself, before any work; touches nothing.
    static void check(const std::filesystem::path& out, const OutputPermissions& permissions);

    /// Where the dataset's files are to be made.
    [[nodiscard]] std::filesystem::path directory() const;
    /// Where temporary files may be made; removed by commit().
    [[nodiscard]] std::filesystem::path workDirectory() const;
    /// Of the journal, which is removed last.
    [[nodiscard]] std::filesystem::path journal() const;
    /// Whether an earlier run got as far as giving OUT its name: then only commit() is left to do, if OUT is what this
    /// run is to make.
    [[nodiscard]] bool isPublished() const { return published_; }
    /// Whether OUT.partial is to stay when commit() is not reached, for a later run to go on with.
    void keep(bool isWorthIt) { kept_ = isWorthIt; }
    [[nodiscard]] bool isKept() const { return kept_; }
    void commit();

  private:
    void publish();

    std::filesystem::path out_;
    std::filesystem::path partial_;
    OutputPermissions permissions_;
    int lock_ = -1;
    bool published_ = false;
    bool kept_ = false;
};

}  // namespace terray
