#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "common/json.h"

namespace terray {

/// The parts of a video that is being made: a directory beside it, "VIDEO.parts", with what the video is made of
/// (video.json) and the segments that are whole. It stays when the program is ended, so that the video can be gone on
/// with, until finish().
class VideoParts {
  public:
    /// Makes the directory, or with `resume` takes the one that is there; without `resume` an earlier one is removed.
    /// @param description  what frames and encoding depend on. Throws Error(usage), naming what differs, when the parts
    /// that are there were made of something else, Error(output) when the directory cannot be made or read.
    VideoParts(const std::filesystem::path& video, const Json& description, bool resume);

    /// Where a segment is to be written, and how it becomes whole.
    [[nodiscard]] std::filesystem::path unfinished(size_t segment) const;
    [[nodiscard]] std::filesystem::path segment(size_t segment) const;
    void publish(size_t segment) const;
    [[nodiscard]] bool has(size_t segment) const;

    /// The launch that frames are drawn by, once it is known: on resuming, the one it began with.
    [[nodiscard]] std::string launch() const { return launch_; }
    void setLaunch(const std::string& launch);

    [[nodiscard]] std::filesystem::path log() const { return directory_ / "ffmpeg.log"; }
    /// Writes a list of the first `segments` segments as ffmpeg's concat takes it.
    [[nodiscard]] std::filesystem::path list(size_t segments) const;
    /// Where the whole video is put together before it gets its name.
    [[nodiscard]] std::filesystem::path whole() const;
    /// Gives the video its name and removes the directory.
    void finish() const;

  private:
    std::filesystem::path video_;
    std::filesystem::path directory_;
    Json description_;
    std::string launch_;
};

}  // namespace terray
