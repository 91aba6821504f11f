#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "common/pmtiles.h"
#include "common/tile_id.h"

namespace terray::server {

class ServedArchive;

/// What of a request's head the server acts on. Nothing here has been looked up or decoded yet.
struct Request {
    std::string method;     ///< as sent: "GET"
    std::string target;     ///< as sent: "/alps/heights/3/1/2?v=..."
    int version = 11;       ///< 10 or 11
    bool keepAlive = true;  ///< what the client asks for, by its version and Connection
    bool hasBody = false;   ///< a body follows, or may: nobody reads it, so the connection ends with the answer
    std::optional<std::string> ifMatch, ifNoneMatch, ifRange, range;
};

/// Bytes of an archive, which it holds open.
struct ArchiveSlice {
    std::shared_ptr<const ServedArchive> archive;
    ByteRange range;
    std::optional<TileId> tile = {};  ///< they are all of this tile
};

using Body = std::variant<std::monostate, std::string, ArchiveSlice>;
[[nodiscard]] uint64_t lengthOf(const Body& body);

/// An answer before it is written. Its fields never hold anything that a client sent.
struct Response {
    int status = 200;
    std::string fields;  ///< "Name: value\r\n" each, without those of the connection and of the length
    Body body;           ///< of a HEAD too: its length is told, its bytes are not sent
    bool isHead = false;
    bool closes = false;  ///< the connection ends after it whatever the client asked for

    void addField(std::string_view name, std::string_view value);
    /// Bytes of body that follow the head: none to HEAD, and where the status has none.
    [[nodiscard]] uint64_t bytesToSend() const;
};

/// Who asked, as far as it shapes the head of the answer.
struct HeadContext {
    int version = 11;
    bool keepAlive = true;
    std::string_view date;  ///< as imfDate() writes it
};

/// The head of an answer with the empty line after it. Content-Length is there unless the status forbids it.
[[nodiscard]] std::string writeHead(const Response& response, const HeadContext& context);
/// "Not Found" and so on, for the statuses that this server gives.
[[nodiscard]] std::string_view reasonPhrase(int status);
/// A point in time as HTTP writes it: "Sun, 06 Nov 1994 08:49:37 GMT".
[[nodiscard]] std::string imfDate(int64_t unixSeconds);

/// An answer of one line of text that says what is wrong and what to do.
[[nodiscard]] Response refusal(int status, const std::string& message);

}  // namespace terray::server
