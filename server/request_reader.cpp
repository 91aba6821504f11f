// The door to Boost.Beast: its parser turns the bytes of one whole head into a Request.
#include "server/request_reader.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>

namespace terray::server {
namespace {

namespace http = boost::beast::http;

constexpr std::string_view kHeadEnd = "\r\n\r\n";

/// Whether a request line ends in a version of HTTP, whichever.
bool namesVersion(std::string_view head) {
    const std::string_view line = head.substr(0, head.find("\r\n"));
    const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
    if (line.size() < 9) return false;
    const std::string_view end = line.substr(line.size() - 9);
    return end.starts_with(" HTTP/") && isDigit(end[6]) && end[7] == '.' && isDigit(end[8]);
}

Refusal refusalFor(const boost::system::error_code& error, std::string_view head) {
    if (error == http::error::bad_version && namesVersion(head))
        return {505, "this server speaks HTTP/1.1 and HTTP/1.0"};
    if (error == http::error::body_limit) return {413, "this server takes no request bodies"};
    return {400, "not an HTTP request: " + error.message()};
}

using Fields = http::fields;

/// A field that may stand once; a list-valued one that stands several times is one list (RFC 9110, 5.3).
std::optional<std::string> fieldOf(const Fields& fields, http::field name) {
    std::optional<std::string> value;
    const auto [begin, end] = fields.equal_range(name);
    for (auto field = begin; field != end; ++field) {
        const std::string text(field->value().data(), field->value().size());
        value = value ? *value + ", " + text : text;
    }
    return value;
}

std::variant<NeedMore, Request, Refusal> parseHead(std::string_view head) {
    http::request_parser<http::empty_body> parser;
    parser.header_limit(static_cast<uint32_t>(head.size()) + 1);
    boost::system::error_code error;
    parser.put(boost::asio::buffer(head.data(), head.size()), error);
    if (error) return refusalFor(error, head);
    if (!parser.is_header_done()) return Refusal{400, "not an HTTP request: its head is not whole"};

    const auto& message = parser.get();
    const auto hosts = message.count(http::field::host);
    if (hosts > 1 || (message.version() == 11 && hosts == 0))
        return Refusal{400, "an HTTP/1.1 request needs exactly one Host field"};
    const auto length = parser.content_length();
    return Request{
        .method = std::string(message.method_string()),
        .target = std::string(message.target()),
        .version = static_cast<int>(message.version()),
        .keepAlive = message.keep_alive(),
        .hasBody = (length && *length > 0) || message.count(http::field::transfer_encoding) > 0,
        .ifMatch = fieldOf(message, http::field::if_match),
        .ifNoneMatch = fieldOf(message, http::field::if_none_match),
        .ifRange = fieldOf(message, http::field::if_range),
        .range = fieldOf(message, http::field::range),
    };
}

}  // namespace

void RequestReader::drop(size_t count) {
    pending_.erase(0, count);
    scanned_ = 0;
    if (pending_.empty()) pending_ = std::string();  // an idle connection holds no memory here
}

std::variant<NeedMore, Request, Refusal> RequestReader::next() {
    // Empty lines before a request are tolerated (RFC 9112, 2.2).
    size_t blank = 0;
    while (pending_.compare(blank, 2, "\r\n") == 0) blank += 2;
    if (blank > 0) drop(blank);

    const size_t end = pending_.find(kHeadEnd, scanned_);
    const size_t lineEnd = pending_.find("\r\n");
    if (std::min(lineEnd, pending_.size()) > limits_.lineBytes)
        return Refusal{414, "the request line has more than " + std::to_string(limits_.lineBytes) + " bytes"};
    if (std::min(end, pending_.size()) > limits_.headBytes)
        return Refusal{431, "the head of the request has more than " + std::to_string(limits_.headBytes) + " bytes"};
    if (end == std::string::npos) {
        scanned_ = pending_.size() - std::min(pending_.size(), kHeadEnd.size() - 1);
        return NeedMore{};
    }
    auto parsed = parseHead(std::string_view(pending_).substr(0, end + kHeadEnd.size()));
    drop(end + kHeadEnd.size());
    return parsed;
}

}  // namespace terray::server
