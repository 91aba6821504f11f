#include "client/navigation/bookmarks.h"

#include <fstream>
#include <span>
#include <sstream>

#include "common/error.h"
#include "common/output_file.h"

namespace terray {
namespace {

constexpr const char* kFormat = "terray-bookmarks";
constexpr int kVersion = 1;

Result<void> readOne(const Json& json, Bookmarks& bookmarks) {
    const auto number = json.numberAt("number");
    if (!number) return number.failure();
    if (!(*number >= 1 && *number <= Bookmarks::kCount)) return Failure{"number is not 1 to 9"};
    const auto text = json.stringAt("camera");
    if (!text) return text.failure();
    const auto camera = parseCamera(*text, nullptr);
    if (!camera) return camera.failure();
    bookmarks.cameras[static_cast<size_t>(*number) - 1] = *camera;
    return {};
}

}  // namespace

Json toJson(const Bookmarks& bookmarks, const Projection* projection) {
    Json list = Json::Array{};
    for (size_t n = 0; n < bookmarks.cameras.size(); ++n) {
        if (!bookmarks.cameras[n]) continue;
        Json entry = Json::Object{{"number", static_cast<int>(n) + 1},
                                  {"camera", formatCamera(*bookmarks.cameras[n], nullptr).value()}};
        if (projection != nullptr)
            if (const auto text = formatCamera(*bookmarks.cameras[n], projection)) entry.set("camera_lonlat", *text);
        list.push(std::move(entry));
    }
    return Json::Object{{"format", kFormat}, {"version", kVersion}, {"bookmarks", std::move(list)}};
}

Result<Bookmarks> bookmarksFromJson(const Json& json) {
    const auto format = json.stringAt("format");
    if (!format || *format != kFormat) return Failure{std::string("expected format \"") + kFormat + '"'};
    const auto version = json.numberAt("version");
    if (!version || *version != kVersion) return Failure{"expected version " + std::to_string(kVersion)};
    const Json* list = json.find("bookmarks");
    if (list == nullptr || !list->isArray()) return Failure{"expected an array bookmarks"};
    Bookmarks bookmarks;
    for (const Json& entry : list->array())
        if (const auto read = readOne(entry, bookmarks); !read) return Failure{"bookmark: " + read.failure().message};
    return bookmarks;
}

Bookmarks loadBookmarks(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path)) return {};
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    const auto refuse = [&](const std::string& why) {
        return Error(ExitCode::input, path.string() + ": no bookmarks: " + why + " (repair it or remove it)");
    };
    if (!file) throw refuse("it cannot be read");
    const auto json = Json::parse(text.str());
    if (!json) throw refuse(json.failure().message);
    auto bookmarks = bookmarksFromJson(*json);
    if (!bookmarks) throw refuse(bookmarks.failure().message);
    return *bookmarks;
}

void saveBookmarks(const Bookmarks& bookmarks, const std::filesystem::path& path, const Projection* projection) {
    std::error_code ignored;  // what is wrong with the folder shows when the file is written
    std::filesystem::create_directories(path.parent_path(), ignored);
    const std::string text = toJson(bookmarks, projection).dump() + "\n";
    writeWholeFile(path, std::as_bytes(std::span(text)));
}

}  // namespace terray
