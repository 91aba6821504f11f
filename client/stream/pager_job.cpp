#include "client/stream/pager_job.h"

#include <algorithm>
#include <type_traits>
#include <utility>

namespace terray {
namespace {

void decodePart(TilePart& part) {
    const Bytes payload = std::move(*part.payload);
    part.payload.reset();
    const auto accept = [&part](auto& decoded, auto& place) {
        if (!decoded) {
            part.trouble = decoded.failure().message;
            return;
        }
        place = std::make_shared<std::remove_cvref_t<decltype(*decoded)>>(std::move(*decoded));
        part.tile.bytes = hostBytesOf(part.key);
    };
    if (part.key.layer == TileLayer::heights) {
        auto decoded = decodeHeightTile(payload, part.key.id);
        accept(decoded, part.tile.heights);
    } else {
        auto decoded = decodeImageryTile(payload, part.key.id);
        accept(decoded, part.tile.imagery);
    }
}

/// The mip chain of a photo tile whose parts are all there.
std::shared_ptr<const Bytes> gatherChain(const std::vector<TilePart>& parts) {
    std::vector<const ImageryTile*> ancestors;  // the parent first
    for (size_t i = parts.size() - 1; i-- > 0;) ancestors.push_back(parts[i].tile.imagery.get());
    return std::make_shared<const Bytes>(gatherMipChain(*parts.back().tile.imagery, ancestors));
}

}  // namespace

const TilePart* TileJob::lostPart() const {
    const auto found = std::find_if(parts.begin(), parts.end(), [](const TilePart& part) { return part.lost(); });
    return found == parts.end() ? nullptr : &*found;
}

bool TileJob::decode() {
    bool complete = true;
    for (TilePart& part : parts) {
        if (part.payload) decodePart(part);
        complete = complete && part.done();
    }
    if (complete && key.layer == TileLayer::imagery) imageryChain = gatherChain(parts);
    return complete;
}

std::vector<TileKey> needsOf(const TileKey& key) {
    std::vector<TileKey> needs;
    const uint32_t above = key.layer == TileLayer::imagery ? std::min<uint32_t>(key.id.level, kImageryMips - 1) : 0;
    for (uint32_t levels = above; levels > 0; --levels) needs.push_back({key.layer, key.id.ancestor(levels)});
    needs.push_back(key);
    return needs;
}

std::string describe(const TileKey& key) {
    return (key.layer == TileLayer::heights ? "height tile " : "imagery tile ") + toString(key.id);
}

}  // namespace terray
