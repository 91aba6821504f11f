// terray-server as a program: options, exit codes, signals, its log.
#include <csignal>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>

#include "common/json.h"
#include "tests/common/temporary_directory.h"
#include "tests/server/raw_client.h"
#include "tests/server/server_process.h"
#include "tests/server/small_dataset.h"
#include "tests/support/run_program.h"

namespace terray::server {
namespace {

using test::TemporaryDirectory;

ProgramResult runOnce(const std::vector<std::string>& arguments) {
    return execute({.program = TERRAY_SERVER_PROGRAM, .arguments = arguments});
}

TEST(ServerProgram, TellsItsOptions) {
    const ProgramResult help = runOnce({"--help"});
    EXPECT_EQ(0, help.exitCode);
    for (const char* option :
         {"NAME=DIR", "--listen", "--threads", "--max-connections", "--idle-timeout", "--log", "--cache"})
        EXPECT_NE(std::string::npos, help.out.find(option)) << option;
    EXPECT_EQ(0, runOnce({"--version"}).exitCode);
}

TEST(ServerProgram, ExitsAsTheReadmeSays) {
    const TemporaryDirectory directory;
    writeSmallDataset(directory / "a");
    const std::string a = "a=" + (directory / "a").string();
    EXPECT_EQ(2, runOnce({}).exitCode);
    EXPECT_EQ(2, runOnce({a, "--log", "xml"}).exitCode);
    EXPECT_EQ(2, runOnce({a, "--threads", "0"}).exitCode);
    EXPECT_EQ(2, runOnce({a, "--listen", "8080"}).exitCode);
    EXPECT_EQ(2, runOnce({a, "--listen", "::1:8080"}).exitCode);
    EXPECT_EQ(3, runOnce({"@" + (directory / "none").string()}).exitCode);
    EXPECT_EQ(5, runOnce({"b=" + (directory / "b").string()}).exitCode);
    EXPECT_EQ(10, runOnce({a, "--listen", "192.0.2.1:80"}).exitCode) << "an address of nobody (RFC 5737)";
}

TEST(ServerProgram, SaysThatItsPortIsTaken) {
    const TemporaryDirectory directory;
    writeSmallDataset(directory / "a");
    const std::string a = "a=" + (directory / "a").string();
    ServerProcess first({a});
    const std::string address = "127.0.0.1:" + std::to_string(first.port());
    const ProgramResult second = runOnce({a, "--listen", address});
    EXPECT_EQ(10, second.exitCode);
    EXPECT_NE(std::string::npos, second.err.find("cannot listen at " + address + ": Address already in use"));
}

TEST(ServerProgram, EndsInOrderAtSigtermAndSigint) {
    for (const int signal : {SIGTERM, SIGINT}) {
        const TemporaryDirectory directory;
        writeSmallDataset(directory / "a");
        ServerProcess server({"a=" + (directory / "a").string()});
        RawClient client(server.port());
        EXPECT_EQ(200, client.ask("GET", "/a/heights/0/0/0").status);
        server.signal(signal);
        EXPECT_EQ(0, server.wait());
        EXPECT_TRUE(client.isEnded());
    }
}

TEST(ServerProgram, EndsAtOnceAtASecondSignal) {
    const TemporaryDirectory directory;
    writeSmallDataset(directory / "a");
    growHeights(directory / "a", 1'000'000'000, 0, "");
    ServerProcess server({"a=" + (directory / "a").string()});
    RawClient lazy(server.port());
    lazy.request("GET", "/a/heights.pmtiles");
    EXPECT_GT(lazy.drop(1000), 0);
    server.signal(SIGTERM);
    server.waitForNotice("stopping");
    server.signal(SIGTERM);
    EXPECT_EQ(0, server.wait());
}

TEST(ServerProgram, ReadsItsListAgainAtSighup) {
    const TemporaryDirectory directory;
    writeSmallDataset(directory / "a");
    writeSmallDataset(directory / "b", false);
    const auto list = [&](const std::string& names) {
        std::ofstream file(directory / "list");
        for (const char name : names) file << name << "=" << (directory / std::string(1, name)).string() << "\n";
    };
    list("a");
    ServerProcess server({"@" + (directory / "list").string()});
    RawClient client(server.port());
    EXPECT_EQ(404, client.ask("GET", "/b/metadata.json").status);
    list("b");
    server.signal(SIGHUP);
    server.waitForNotice("reloaded, 1 datasets");
    EXPECT_EQ(200, client.ask("GET", "/b/metadata.json").status);
    EXPECT_EQ(404, client.ask("GET", "/a/metadata.json").status);
    std::filesystem::remove(directory / "list");
    server.signal(SIGHUP);
    server.waitForNotice("all is served on as it was");
    EXPECT_EQ(200, client.ask("GET", "/b/metadata.json").status);
}

TEST(ServerProgram, LogsEachAnswerWithBytesAndTime) {
    const TemporaryDirectory directory;
    writeSmallDataset(directory / "a");
    ServerProcess server({"a=" + (directory / "a").string(), "--log", "json"});
    RawClient client(server.port());
    const RawAnswer tile = client.ask("GET", "/a/heights/2/0/1");
    EXPECT_EQ(404, client.ask("GET", "/\"x\"").status);
    server.signal(SIGTERM);
    EXPECT_EQ(0, server.wait());
    const std::string log = server.out();
    const size_t lineEnd = log.find('\n');
    const auto first = Json::parse(log.substr(0, lineEnd)).value();
    EXPECT_EQ("/a/heights/2/0/1", first.stringAt("target").value());
    EXPECT_EQ(200, first.numberAt("status").value());
    EXPECT_GT(first.numberAt("bytes").value(), static_cast<double>(tile.body.size())) << "with the head";
    EXPECT_GE(first.numberAt("microseconds").value(), 0);
    EXPECT_TRUE(first.stringAt("client").value().starts_with("127.0.0.1:"));
    const auto second = Json::parse(log.substr(lineEnd + 1)).value();
    EXPECT_EQ("/%22x%22", second.stringAt("target").value());
}

}  // namespace
}  // namespace terray::server
