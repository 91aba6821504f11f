// From bytes to requests, and from targets to segments.
#include <gtest/gtest.h>

#include "server/preconditions.h"
#include "server/request_reader.h"
#include "server/request_target.h"

namespace terray::server {
namespace {

using Next = std::variant<NeedMore, Request, Refusal>;

Next readAll(const std::string& bytes) {
    RequestReader reader;
    reader.append(bytes);
    return reader.next();
}

int refusedWith(const std::string& bytes) {
    const Next next = readAll(bytes);
    const auto* reason = std::get_if<Refusal>(&next);
    return reason == nullptr ? 0 : reason->status;
}

constexpr const char* kPlain =
    "GET /a?v=1 HTTP/1.1\r\nHost: x\r\nRange: bytes=0-1\r\nIf-None-Match: \"a\"\r\n"
    "If-None-Match: \"b\"\r\n\r\n";

TEST(RequestReader, ReadsWhatTheServerActsOn) {
    const auto request = std::get<Request>(readAll(kPlain));
    EXPECT_EQ("GET", request.method);
    EXPECT_EQ("/a?v=1", request.target);
    EXPECT_EQ(11, request.version);
    EXPECT_TRUE(request.keepAlive);
    EXPECT_FALSE(request.hasBody);
    EXPECT_EQ("bytes=0-1", request.range);
    EXPECT_EQ("\"a\", \"b\"", request.ifNoneMatch);
    EXPECT_FALSE(request.ifRange);
}

TEST(RequestReader, IsTheSameForEverySplitIntoPieces) {
    const std::string bytes = std::string(kPlain) + "HEAD /b HTTP/1.0\r\n\r\n";
    for (size_t split = 0; split <= bytes.size(); ++split) {
        RequestReader reader;
        std::vector<std::string> seen;
        for (const std::string& piece : {bytes.substr(0, split), bytes.substr(split)}) {
            reader.append(piece);
            for (Next next = reader.next(); std::holds_alternative<Request>(next); next = reader.next())
                seen.push_back(std::get<Request>(next).method + std::get<Request>(next).target);
        }
        EXPECT_EQ((std::vector<std::string>{"GET/a?v=1", "HEAD/b"}), seen) << split;
        EXPECT_TRUE(reader.empty());
    }
}

TEST(RequestReader, WaitsForEveryTruncationOfAHead) {
    const std::string bytes = kPlain;
    for (size_t size = 0; size < bytes.size(); ++size)
        EXPECT_TRUE(std::holds_alternative<NeedMore>(readAll(bytes.substr(0, size)))) << size;
}

TEST(RequestReader, KnowsWhetherTheConnectionStays) {
    const auto keeps = [](const std::string& line, const std::string& fields) {
        return std::get<Request>(readAll(line + "\r\nHost: x\r\n" + fields + "\r\n")).keepAlive;
    };
    EXPECT_TRUE(keeps("GET / HTTP/1.1", ""));
    EXPECT_FALSE(keeps("GET / HTTP/1.1", "Connection: close\r\n"));
    EXPECT_FALSE(keeps("GET / HTTP/1.0", ""));
    EXPECT_TRUE(keeps("GET / HTTP/1.0", "Connection: keep-alive\r\n"));
}

TEST(RequestReader, SeesThatABodyFollows) {
    const auto hasBody = [](const std::string& fields) {
        return std::get<Request>(readAll("POST / HTTP/1.1\r\nHost: x\r\n" + fields + "\r\n")).hasBody;
    };
    EXPECT_TRUE(hasBody("Content-Length: 5\r\n"));
    EXPECT_TRUE(hasBody("Transfer-Encoding: chunked\r\n"));
    EXPECT_TRUE(hasBody("Transfer-Encoding: gzip\r\n"));
    EXPECT_FALSE(hasBody("Content-Length: 0\r\n"));
}

TEST(RequestReader, RefusesWhatIsNoRequest) {
    EXPECT_EQ(400, refusedWith("rubbish\r\n\r\n"));
    EXPECT_EQ(400, refusedWith("GET /\r\n\r\n"));
    EXPECT_EQ(400, refusedWith("GET / FTP/1.1\r\nHost: x\r\n\r\n"));
    EXPECT_EQ(400, refusedWith("GET / HTTP/1.1\r\nHost: x\r\nbad field\r\n\r\n"));
    EXPECT_EQ(400, refusedWith("GET / HTTP/1.1\r\nHost: x\r\nContent-Length: -1\r\n\r\n"));
    EXPECT_EQ(400, refusedWith("GET / HTTP/1.1\r\nHost: x\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n"));
    EXPECT_EQ(400, refusedWith("GET / HTTP/1.1\r\n\r\n")) << "without Host";
    EXPECT_EQ(400, refusedWith("GET / HTTP/1.1\r\nHost: x\r\nHost: y\r\n\r\n"));
    EXPECT_EQ(505, refusedWith("GET / HTTP/2.0\r\nHost: x\r\n\r\n"));
    EXPECT_EQ(413, refusedWith("PUT / HTTP/1.1\r\nHost: x\r\nContent-Length: 99999999999\r\n\r\n"));
}

TEST(RequestReader, BoundsTheRequestLineAndTheHead) {
    const std::string rest = " HTTP/1.1\r\nHost: x\r\n";
    const size_t fits = HeadLimits().lineBytes - std::string("GET  HTTP/1.1").size();
    EXPECT_TRUE(std::holds_alternative<Request>(readAll("GET /" + std::string(fits - 1, 'a') + rest + "\r\n")));
    EXPECT_EQ(414, refusedWith("GET /" + std::string(fits, 'a') + rest + "\r\n"));
    EXPECT_EQ(414, refusedWith("GET /" + std::string(HeadLimits().lineBytes, 'a'))) << "before its end has come";
    const std::string head = "GET /" + rest + "X: ";
    const size_t field = HeadLimits().headBytes - head.size();
    EXPECT_TRUE(std::holds_alternative<Request>(readAll(head + std::string(field, 'a') + "\r\n\r\n")));
    EXPECT_EQ(431, refusedWith(head + std::string(field + 1, 'a') + "\r\n\r\n"));
    EXPECT_EQ(431, refusedWith(head + std::string(field + 1, 'a'))) << "before its end has come";
}

TEST(RequestReader, ToleratesEmptyLinesBeforeARequest) {
    EXPECT_EQ("/", std::get<Request>(readAll("\r\n\r\nGET / HTTP/1.0\r\n\r\n")).target);
}

std::string joined(const std::string& target) {
    const auto parsed = parseTarget(target);
    if (!parsed) return "none";
    std::string text;
    for (const std::string& segment : parsed->segments) text += "[" + segment + "]";
    return text + (parsed->version ? " v=" + *parsed->version : "");
}

TEST(RequestTarget, TakesPathsApart) {
    EXPECT_EQ("", joined("/"));
    EXPECT_EQ("", joined("*"));
    EXPECT_EQ("[a][b]", joined("/a/b"));
    EXPECT_EQ("[a][]", joined("/a/"));
    EXPECT_EQ("[a b]", joined("/a%20b"));
    EXPECT_EQ("[a] v=1", joined("/a?x=2&v=1&v=3"));
    EXPECT_EQ(" v=", joined("/?v="));
    EXPECT_EQ("[a]", joined("http://host:80/a"));
    EXPECT_EQ("", joined("https://host"));
}

TEST(RequestTarget, NeverResolvesDotsOrHiddenSlashes) {
    EXPECT_EQ("[..][..][etc][passwd]", joined("/../../etc/passwd"));
    EXPECT_EQ("[../etc]", joined("/%2e%2e%2fetc"));
    EXPECT_EQ("[a][.][b]", joined("/a/./b"));
}

TEST(RequestTarget, RefusesWhatIsNoPath) {
    for (const char* target : {"", "a/b", "/%", "/%4", "/%zz", "/% 1", "/a?v=%1", "ftp://host/a", "http:/a"})
        EXPECT_EQ("none", joined(target)) << target;
}

std::string rangeOf(const std::string& field, uint64_t size) {
    const auto range = parseRange(field, size);
    if (std::holds_alternative<Unsatisfiable>(range)) return "unsatisfiable";
    const auto* part = std::get_if<ByteRange>(&range);
    return part == nullptr ? "whole" : std::to_string(part->offset) + "+" + std::to_string(part->length);
}

TEST(ParseRange, TakesOnePart) {
    EXPECT_EQ("0+1", rangeOf("bytes=0-0", 10));
    EXPECT_EQ("2+8", rangeOf("bytes=2-", 10));
    EXPECT_EQ("2+8", rangeOf("Bytes=2-", 10)) << "names of units have no case (RFC 9110, 14.1)";
    EXPECT_EQ("2+8", rangeOf("bytes=2-99", 10));
    EXPECT_EQ("7+3", rangeOf("bytes=-3", 10));
    EXPECT_EQ("0+10", rangeOf("bytes=-99", 10));
    EXPECT_EQ("6000000000+2", rangeOf("bytes=6000000000-6000000001", 7000000000));
    EXPECT_EQ("9+1", rangeOf("bytes=9-99999999999999999999999", 10)) << "beyond 64 bits";
}

TEST(ParseRange, KnowsWhatCannotBeSatisfied) {
    for (const char* field : {"bytes=10-", "bytes=10-11", "bytes=-0", "bytes=99999999999999999999999-"})
        EXPECT_EQ("unsatisfiable", rangeOf(field, 10)) << field;
    EXPECT_EQ("unsatisfiable", rangeOf("bytes=0-", 0));
    EXPECT_EQ("unsatisfiable", rangeOf("bytes=-1", 0));
}

TEST(ParseRange, IgnoresOtherUnitsBadSyntaxAndSeveralParts) {
    for (const char* field : {"", "bytes", "bytes=", "bytes=-", "bytes=a-b", "bytes=3-2", "bytes=1", "lines=0-1",
                              "bytes=0-1,4-5", "bytes=+1-2", "bytes=0x1-2", "bytes=1-2-3"})
        EXPECT_EQ("whole", rangeOf(field, 10)) << field;
}

TEST(NamesTag, ComparesStronglyOrWeakly) {
    const std::string tag = "\"abc\"";
    for (const char* field : {"\"abc\"", "*", "\"x\", \"abc\"", "\"x\",\"abc\"", " \"abc\" "}) {
        EXPECT_TRUE(namesTag(field, tag, true)) << field;
        EXPECT_TRUE(namesTag(field, tag, false)) << field;
    }
    EXPECT_TRUE(namesTag("W/\"abc\"", tag, true));
    EXPECT_FALSE(namesTag("W/\"abc\"", tag, false));
    for (const char* field : {"", "abc", "\"abcd\"", "\"abc", "\"a,b\"", ", ", "\"x\" rubbish"})
        EXPECT_FALSE(namesTag(field, tag, true)) << field;
}

}  // namespace
}  // namespace terray::server
