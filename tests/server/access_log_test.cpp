#include "server/access_log.h"

#include <algorithm>
#include <array>
#include <memory>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "common/json.h"

namespace terray::server {
namespace {

constexpr LogEntry kEntry = {.unixMilliseconds = 784111777045,
                             .client = "[::1]:4711",
                             .method = "GET",
                             .target = "/a\"b\\c\xc3\xa4\n?v=1",
                             .status = 206,
                             .bytes = 1234,
                             .microseconds = 56};

TEST(AccessLog, WritesOneLineOfTextWhateverTheClientSent) {
    EXPECT_EQ("1994-11-06T08:49:37.045Z [::1]:4711 \"GET /a%22b%5Cc%C3%A4%0A?v=1\" 206 1234 B 56 us\n",
              logLine(kEntry, LogFormat::text));
    LogEntry cut = kEntry;
    cut.whole = false;
    EXPECT_TRUE(logLine(cut, LogFormat::text).ends_with(" 56 us cut short\n"));
}

TEST(AccessLog, WritesOneJsonObjectALine) {
    const std::string line = logLine(kEntry, LogFormat::json);
    EXPECT_EQ(line.size() - 1, line.find('\n'));
    const auto json = Json::parse(line).value();
    EXPECT_EQ("/a%22b%5Cc%C3%A4%0A?v=1", json.stringAt("target").value());
    EXPECT_EQ(206, json.numberAt("status").value());
    EXPECT_EQ(1234, json.numberAt("bytes").value());
    EXPECT_EQ(56, json.numberAt("microseconds").value());
    EXPECT_TRUE(json.boolAt("whole").value());
}

TEST(AccessLog, DropsAndCountsLinesThatItsReaderIsTooSlowFor) {
    std::array<int, 2> ends{};
    ASSERT_EQ(0, ::pipe(ends.data()));
    constexpr uint64_t kLines = 200000;  // 17 MB, of which the pipe takes 64 kB and the log holds twice 4 MiB at most
    std::atomic<uint64_t> dropped = 0;
    uint64_t received = 0;
    auto log = std::make_unique<AccessLog>(LogFormat::text, ends[1], dropped);
    for (uint64_t i = 0; i < kLines; ++i) log->write(kEntry);  // comes to its end although nobody reads
    EXPECT_GT(dropped, 0);
    std::thread reader([&] {
        std::array<char, 65536> buffer{};
        for (ssize_t count = 0; (count = ::read(ends[0], buffer.data(), buffer.size())) > 0;)
            received += static_cast<uint64_t>(std::count(buffer.begin(), buffer.begin() + count, '\n'));
    });
    log.reset();  // writes what it holds
    ::close(ends[1]);
    reader.join();
    ::close(ends[0]);
    EXPECT_EQ(kLines, received + dropped);
}

}  // namespace
}  // namespace terray::server
