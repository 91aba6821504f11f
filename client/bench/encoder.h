#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

#include "common/bytes.h"

namespace terray {

/// Another program that takes bytes on its standard input, such as ffmpeg encoding a video: it is running from
/// construction to finish(). One thread.
class Encoder {
  public:
    /// Starts `program` (looked for as a shell does). What it prints goes to the file `log`.
    /// Throws Error(unsupported) when there is no such program, Error(output) when it cannot be started.
    Encoder(const std::string& program, const std::vector<std::string>& arguments, std::filesystem::path log);
    /// Ends a program that was not finished, and waits for it.
    ~Encoder();
    Encoder(const Encoder&) = delete;
    Encoder& operator=(const Encoder&) = delete;

    /// Waits until the program has taken all. Throws Error(output), with what it printed, when it ended before.
    void write(ByteView bytes);
    /// Tells the end of the bytes and waits for the program to end. Throws Error(output), with what it printed, when it
    /// did not end well.
    void finish();

  private:
    [[noreturn]] void refuse(const std::string& what) const;
    int wait();

    std::string program_;
    std::filesystem::path log_;
    pid_t process_ = -1;  ///< -1: has ended
    int input_ = -1;
};

/// Runs a program without input to its end. Throws as Encoder does.
void runTool(const std::string& program, const std::vector<std::string>& arguments, const std::filesystem::path& log);

}  // namespace terray
