#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <ostream>
#include <string>

namespace terray {

/// The deepest level a tile id may have: PMTiles v3 numbers all tiles of levels 0..31 in 64 bits.
inline constexpr uint32_t kMaxTileLevel = 31;

/// One square of the quadtree: level 0 is the single root tile, x grows to the east, y to the SOUTH (as PMTiles z/x/y).
struct TileId {
    uint32_t level = 0;
    uint32_t x = 0;
    uint32_t y = 0;

    auto operator<=>(const TileId&) const = default;

    /// Whether the id names a tile that can exist: level <= kMaxTileLevel, x and y below 2^level.
    [[nodiscard]] constexpr bool valid() const {
        return level <= kMaxTileLevel && (uint64_t{x} >> level) == 0 && (uint64_t{y} >> level) == 0;
    }
    /// The tile that covers this one, one level up. Not for the root.
    [[nodiscard]] constexpr TileId parent() const { return {level - 1, x >> 1, y >> 1}; }
    /// The tile `levels` above, 0 being the tile itself; levels <= level.
    [[nodiscard]] constexpr TileId ancestor(uint32_t levels) const {
        return {level - levels, x >> levels, y >> levels};
    }
    /// Child by quadrant: 0 north-west, 1 north-east, 2 south-west, 3 south-east.
    [[nodiscard]] constexpr TileId child(uint32_t quadrant) const {
        return {level + 1, 2 * x + (quadrant & 1), 2 * y + (quadrant >> 1)};
    }
    /// Which child of its parent this tile is, numbered as in child().
    [[nodiscard]] constexpr uint32_t quadrant() const { return (x & 1) | ((y & 1) << 1); }
    /// Whether `other` is this tile or lies beneath it.
    [[nodiscard]] constexpr bool covers(const TileId& other) const {
        return other.level >= level && other.ancestor(other.level - level) == *this;
    }
};

/// "level/x/y", as in the URLs of a tile server.
[[nodiscard]] inline std::string toString(const TileId& id) {
    return std::to_string(id.level) + "/" + std::to_string(id.x) + "/" + std::to_string(id.y);
}
inline std::ostream& operator<<(std::ostream& out, const TileId& id) {
    return out << toString(id);
}

}  // namespace terray

template <>
struct std::hash<terray::TileId> {
    size_t operator()(const terray::TileId& id) const noexcept {
        // Multiplicative mixing by odd 64-bit constants (golden ratio and its like), enough for a hash map.
        uint64_t h = id.level * 0x9e3779b97f4a7c15ULL;
        h = (h ^ id.x) * 0xbf58476d1ce4e5b9ULL;
        h = (h ^ (h >> 29) ^ id.y) * 0x94d049bb133111ebULL;
        return static_cast<size_t>(h ^ (h >> 32));
    }
};
