#include "server/http_message.h"

#include <array>
#include <cstdio>
#include <ctime>

#include "common/version.h"

namespace terray::server {
namespace {

/// Statuses that have neither a body nor a Content-Length (RFC 9110, 8.6), 304 because it would be the other answer's.
bool isBodyless(int status) {
    return status == 204 || status == 304;
}

}  // namespace

uint64_t lengthOf(const Body& body) {
    if (const auto* text = std::get_if<std::string>(&body)) return text->size();
    if (const auto* slice = std::get_if<ArchiveSlice>(&body)) return slice->range.length;
    return 0;
}

void Response::addField(std::string_view name, std::string_view value) {
    fields.append(name).append(": ").append(value).append("\r\n");
}

uint64_t Response::bytesToSend() const {
    return isHead || isBodyless(status) ? 0 : lengthOf(body);
}

std::string_view reasonPhrase(int status) {
    switch (status) {
        case 200:
            return "OK";
        case 204:
            return "No Content";
        case 206:
            return "Partial Content";
        case 304:
            return "Not Modified";
        case 400:
            return "Bad Request";
        case 404:
            return "Not Found";
        case 405:
            return "Method Not Allowed";
        case 408:
            return "Request Timeout";
        case 412:
            return "Precondition Failed";
        case 413:
            return "Content Too Large";
        case 414:
            return "URI Too Long";
        case 416:
            return "Range Not Satisfiable";
        case 431:
            return "Request Header Fields Too Large";
        case 500:
            return "Internal Server Error";
        case 501:
            return "Not Implemented";
        case 503:
            return "Service Unavailable";
        case 505:
            return "HTTP Version Not Supported";
        default:
            TERRAY_CHECK_OP(status, ==, 0);  // a status of ours without a phrase
    }
    return {};
}

std::string writeHead(const Response& response, const HeadContext& context) {
    static const std::string server = "Server: terray-server/" + std::string(buildInfo().version) + "\r\n";
    std::string head;
    head.reserve(512);
    head.append("HTTP/1.1 ").append(std::to_string(response.status)).append(" ").append(reasonPhrase(response.status));
    head.append("\r\nDate: ").append(context.date).append("\r\n").append(server).append(response.fields);
    if (!isBodyless(response.status))
        head.append("Content-Length: ").append(std::to_string(lengthOf(response.body))).append("\r\n");
    if (!context.keepAlive)
        head.append("Connection: close\r\n");
    else if (context.version == 10)
        head.append("Connection: keep-alive\r\n");
    return head.append("\r\n");
}

std::string imfDate(int64_t unixSeconds) {
    // Not strftime: the names must be English in every locale.
    constexpr std::array<const char*, 7> kDays = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
    constexpr std::array<const char*, 12> kMonths = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                     "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
    const std::time_t time = unixSeconds;
    std::tm utc = {};
    ::gmtime_r(&time, &utc);
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%s, %02d %s %04d %02d:%02d:%02d GMT", kDays[utc.tm_wday], utc.tm_mday,
                  kMonths[utc.tm_mon], utc.tm_year + 1900, utc.tm_hour, utc.tm_min, utc.tm_sec);
    return text.data();
}

Response refusal(int status, const std::string& message) {
    Response response{.status = status};
    response.addField("Content-Type", "text/plain; charset=utf-8");
    response.addField("X-Content-Type-Options", "nosniff");
    response.addField("Cache-Control", "no-store");
    response.addField("Access-Control-Allow-Origin", "*");
    response.body = message + "\n";
    return response;
}

}  // namespace terray::server
