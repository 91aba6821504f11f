#pragma once

#include <cstddef>
#include <filesystem>

namespace terray {

/// The directory that a run writes into: summary.json and manifest.json, a replay's frames.csv, steps.csv and
/// frames/frame_00000.png, ..., and of a measurement of errors errors.csv or split.csv, and maps/;
/// of the stability suite stability.csv.
class RunDirectory {
  public:
    /// Creates the directory, unless it exists. Throws Error(output) when that fails, or when an earlier run lies in it
    /// and `force` is not set; with `force` the files of that run, and only those, are removed.
    RunDirectory(std::filesystem::path path, bool withFrames, bool force);
    /// Without keep() removes again what the run wrote and the directories that were made for it.
    ~RunDirectory();
    RunDirectory(const RunDirectory&) = delete;
    RunDirectory& operator=(const RunDirectory&) = delete;

    /// The run is whole: its files stay.
    void keep() { kept_ = true; }

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::filesystem::path table() const;
    [[nodiscard]] std::filesystem::path errors() const;
    /// Of errors by their causes.
    [[nodiscard]] std::filesystem::path split() const;
    [[nodiscard]] std::filesystem::path stability() const;
    /// Made when it is first asked for; its files begin with map_.
    [[nodiscard]] std::filesystem::path maps() const;
    /// How many rays took how many steps.
    [[nodiscard]] std::filesystem::path steps() const;
    [[nodiscard]] std::filesystem::path summary() const;
    [[nodiscard]] std::filesystem::path manifest() const;
    [[nodiscard]] std::filesystem::path frames() const;
    /// Of a frame's picture, numbered with at least five digits.
    [[nodiscard]] std::filesystem::path frame(size_t index) const;

  private:
    void removeRun() const;

    std::filesystem::path path_;
    bool existed_;
    bool kept_ = false;
};

}  // namespace terray
