#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "client/stream/open_dataset.h"
#include "common/command_line.h"

namespace terray {

/// The dataset as it is named on a command line: the same in every program that reads one.
class DatasetCommandLine {
  public:
    /// Declares the positional argument DATASET and its options. This object must outlive line.parse().
    void declare(CommandLine& line);

    /// As it was given: a directory or an address.
    [[nodiscard]] const std::string& place() const { return place_; }
    /// Throws as openDataset.
    [[nodiscard]] std::unique_ptr<TileSource> open() const;

  private:
    std::string place_;
    std::string diskCache_;
    uint64_t diskCacheBytes_ = DiskCacheOptions().maxBytes;
};

}  // namespace terray
