#pragma once

#include <filesystem>

#include "tests/stream/fake_dataset.h"

namespace terray::test {

/// Writes a fake dataset as archives into an existing directory. @param leafEntries  of a leaf directory; small ones
/// make many of them
void writeDataset(const FakeDataset& dataset, const std::filesystem::path& directory, size_t leafEntries = 4096);

}  // namespace terray::test
