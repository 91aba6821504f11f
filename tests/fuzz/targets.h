#pragma once

#include "common/bytes.h"

namespace terray::fuzz {

// What libFuzzer (run_target.cpp) and the test of the corpus hand bytes to. Each takes them for its kind of input and
// stops the program when the reader under test allocates more than its limit, or gives an answer that contradicts
// itself. See FORMAT.md, "Limits and fuzzing".
//
// @return  whether the bytes were accepted

/// A whole PMTiles archive in memory: open, metadata, forEach over the first tiles, locate and read each.
bool readArchive(ByteView bytes);
/// The JSON text of a dataset's metadata.
bool readMetadata(ByteView bytes);
/// A height tile's payload, whose body size and checksums are made to match first. Bytes that do not begin with its
/// magic number are repeated to fill a tile's planes of residuals instead, packed, and read.
bool readHeightTile(ByteView bytes);
/// Likewise an imagery tile's payload; other bytes are repeated to fill its blocks.
bool readImageryTile(ByteView bytes);

}  // namespace terray::fuzz
