#pragma once
// A dataset of a few small tiles whose bytes are known: the server never looks into them.

#include <filesystem>
#include <string>

#include "common/bytes.h"
#include "common/tile_id.h"

namespace terray::server {

/// Finest level of its heights; imagery goes one level deeper.
inline constexpr uint32_t kSmallLevel = 2;
/// In the pyramid, but without surface: not stored.
inline constexpr TileId kEmptyTile{2, 3, 3};

/// The bytes that a tile of such a dataset has, a few hundred; they differ by tile, layer and edition.
[[nodiscard]] std::string smallTile(const std::string& layer, const TileId& id, int edition = 1);

/// Writes the dataset into a directory, which is made.
/// @param edition  changes every tile's bytes, and so the dataset's version
/// @param suffix   stands at the end of each tile's bytes
void writeSmallDataset(const std::filesystem::path& directory, bool withImagery = true, int edition = 1,
                       const std::string& suffix = "");

/// Makes its heights archive `size` bytes long, with zeros that take no room on the disk, and writes `text` at
/// `offset`.
void growHeights(const std::filesystem::path& directory, uint64_t size, uint64_t offset, const std::string& text);

[[nodiscard]] std::string readText(const std::filesystem::path& path);

}  // namespace terray::server
