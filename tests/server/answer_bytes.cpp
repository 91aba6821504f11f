#include "tests/server/answer_bytes.h"

#include <algorithm>

#include "common/check.h"
#include "server/request_reader.h"
#include "server/responder.h"
#include "tests/common/temporary_directory.h"
#include "tests/server/small_dataset.h"

namespace terray::server {
namespace {

const Catalogue& smallCatalogue() {
    static const auto catalogue = [] {
        const test::TemporaryDirectory directory;  // opened archives outlive it
        writeSmallDataset(directory / "small");
        return openCatalogue({{"small", directory / "small"}});
    }();
    return *catalogue;
}

void checkHead(std::string_view head) {
    TERRAY_CHECK(head.starts_with("HTTP/1.1 "));
    TERRAY_CHECK_OP(head.find("\r\n\r\n"), ==, head.size() - 4);
    const auto isControl = [](char c) { return (c >= 0 && c < 0x20) || c == 0x7f; };
    head.remove_suffix(2);
    for (bool isFirst = true; !head.empty(); isFirst = false) {
        const size_t end = head.find("\r\n");
        const std::string_view line = head.substr(0, end);
        TERRAY_CHECK(isFirst || line.find(": ") != std::string_view::npos);
        TERRAY_CHECK(std::none_of(line.begin(), line.end(), isControl));
        head.remove_prefix(end + 2);
    }
}

void checkResponse(const Response& response) {
    TERRAY_CHECK(response.status < 500 || response.status == 501 || response.status == 505);
    TERRAY_CHECK_OP(response.bytesToSend(), <=, lengthOf(response.body));
    if (const auto* slice = std::get_if<ArchiveSlice>(&response.body)) {
        TERRAY_CHECK_OP(slice->range.offset, <=, slice->archive->size());
        TERRAY_CHECK_OP(slice->range.length, <=, slice->archive->size() - slice->range.offset);
    }
    checkHead(writeHead(response, {.keepAlive = !response.closes, .date = imfDate(0)}));
}

/// Answers of one connection whose bytes come in pieces.
std::vector<int> answerPieces(std::string_view bytes, size_t pieceBytes) {
    static const Metrics metrics;
    RequestReader reader;
    std::vector<int> statuses;
    while (!bytes.empty()) {
        const std::string_view piece = bytes.substr(0, pieceBytes);
        bytes.remove_prefix(piece.size());
        reader.append(piece);
        for (auto next = reader.next(); !std::holds_alternative<NeedMore>(next); next = reader.next()) {
            const auto* request = std::get_if<Request>(&next);
            const auto* reason = std::get_if<Refusal>(&next);
            const Response response = request != nullptr ? respond(*request, smallCatalogue(), metrics)
                                                         : refusal(reason->status, reason->message);
            checkResponse(response);
            statuses.push_back(response.status);
            if (reason != nullptr || response.closes) return statuses;
        }
    }
    return statuses;
}

}  // namespace

std::vector<int> answerBytes(std::string_view bytes) {
    const std::vector<int> statuses = answerPieces(bytes, std::max<size_t>(bytes.size(), 1));
    const size_t pieceBytes = 1 + bytes.size() % 13;
    TERRAY_CHECK(statuses == answerPieces(bytes, pieceBytes));
    return statuses;
}

}  // namespace terray::server
