#include <string_view>

#include "common/check.h"
#include "common/dataset_metadata.h"
#include "tests/fuzz/allocation_limit.h"
#include "tests/fuzz/targets.h"

namespace terray::fuzz {
namespace {

/// json.h: 64 bytes for each of the text. What metadataFromJson makes of the value is smaller than the value.
constexpr size_t kParseFactor = 64;
constexpr size_t kReadFactor = 32;
constexpr size_t kSmallThings = size_t{16} << 10;  // messages, buffers

}  // namespace

bool readMetadata(ByteView bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto json = within(kParseFactor * text.size() + kSmallThings, [&] { return Json::parse(text); });
    if (!json.ok()) return false;
    const auto again = Json::parse(json->dump());
    TERRAY_CHECK(again.ok() && *again == *json);

    const auto metadata = within(kReadFactor * text.size() + kSmallThings, [&] { return metadataFromJson(*json); });
    if (!metadata.ok()) return false;
    const auto written = metadataFromJson(toJson(*metadata));
    TERRAY_CHECK(written.ok() && *written == *metadata);
    return true;
}

}  // namespace terray::fuzz
