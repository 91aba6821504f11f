#include "client/overlay/track.h"

#include <fstream>
#include <string>

#include "common/error.h"

namespace terray {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

Error refusal(const std::filesystem::path& path, const std::string& why) {
    return {ExitCode::input, "cannot read track " + path.string() + ": " + why};
}

}  // namespace

std::string readTrackFile(const std::filesystem::path& path) {
    std::error_code failed;
    const uint64_t size = std::filesystem::file_size(path, failed);
    if (failed) throw refusal(path, failed.message());
    if (size > kMostTrackBytes)
        throw refusal(path,
                      "it has " + std::to_string(size) + " bytes, expected at most " + std::to_string(kMostTrackBytes));
    std::string text(size, '\0');
    std::ifstream file(path, std::ios::binary);
    if (!file.read(text.data(), static_cast<std::streamsize>(size))) throw refusal(path, "reading failed");
    return text;
}

Track readTrack(const std::filesystem::path& path) {
    const std::string text = readTrackFile(path);
    std::string_view content = text;
    if (content.starts_with(kByteOrderMark)) content.remove_prefix(kByteOrderMark.size());
    content.remove_prefix(std::min(content.find_first_not_of(" \t\r\n"), content.size()));
    // GPX is XML; an IGC file begins with its A record, the recorder's maker.
    const bool xml = content.starts_with('<');
    if (!xml && !content.starts_with('A'))
        throw refusal(path, "it begins neither like GPX (XML) nor like IGC (A record)");
    if (xml && !TERRAY_WITH_TRACKS)
        throw Error(ExitCode::unsupported,
                    "cannot read track " + path.string() + ": this build reads no GPX (TERRAY_WITH_TRACKS is off)");
    auto track = xml ? parseGpx(content) : parseIgc(content);
    if (!track) throw refusal(path, track.failure().message);
    return std::move(*track);
}

}  // namespace terray
