#include "server/serve_command.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <limits>
#include <thread>

#include <sys/resource.h>

#include "common/command_line.h"
#include "server/server.h"

namespace terray::server {
namespace {

using Milliseconds = std::chrono::milliseconds;

/// A complaint or notice of a server that runs; the access log has stdout to itself.
void say(const std::string& text) {
    std::fprintf(stderr, "terray-server: %s\n", text.c_str());
}

struct Settings {
    std::vector<std::string> datasets;
    std::string listen = "127.0.0.1:8080";
    int64_t threads = std::max<int64_t>(std::thread::hardware_concurrency(), 1);
    int64_t maxConnections = 16384;
    uint64_t cacheBytes = uint64_t{256} << 20;
    double idleTimeout = 60;
    std::string log = "text";
};

LogFormat parseLogFormat(const std::string& text) {
    if (text == "text") return LogFormat::text;
    if (text == "json") return LogFormat::json;
    if (text == "off") return LogFormat::off;
    throw Error(ExitCode::usage, "--log: \"" + text + "\" is no format of the access log; expected json, text or off");
}

void requireBetween(const std::string& option, double value, double least, double most) {
    if (value >= least && value <= most) return;
    throw Error(ExitCode::usage, option + " must be from " + std::to_string(static_cast<int64_t>(least)) + " to " +
                                     std::to_string(static_cast<int64_t>(most)));
}

/// Lets this process have as many open files as the system allows it. @return connections that fit, at most `wanted`
size_t roomForConnections(size_t wanted) {
    constexpr size_t kOtherFiles = 512;  // archives, listeners, what libraries open
    rlimit limit = {};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return wanted;
    limit.rlim_cur = limit.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &limit);
    if (limit.rlim_max == RLIM_INFINITY || wanted + kOtherFiles <= limit.rlim_max) return wanted;
    const size_t room = limit.rlim_max > 2 * kOtherFiles ? limit.rlim_max - kOtherFiles : limit.rlim_max / 2;
    say("this process may have " + std::to_string(limit.rlim_max) + " open files: at most " + std::to_string(room) +
        " connections instead of " + std::to_string(wanted) + " (raise ulimit -n, or LimitNOFILE= of the unit)");
    return room;
}

/// The signals that this program acts on. Blocked in every thread; the main thread waits for them.
sigset_t handledSignals() {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, signal);
    return signals;
}

/// Keeps datasets up to date until the program is told to end.
void serveUntilStopped(Server& server, std::shared_ptr<const Catalogue> catalogue, const Settings& settings) {
    const sigset_t signals = handledSignals();
    for (;;) {
        int signal = 0;
        if (::sigwait(&signals, &signal) != 0) continue;
        if (signal != SIGHUP) return;
        try {
            catalogue = reloadCatalogue(parseSpecs(settings.datasets), *catalogue, say);
            server.reload(catalogue);
            say("reloaded, " + std::to_string(catalogue->datasets().size()) + " datasets");
        } catch (const Error& error) {
            say(std::string("reload: ") + error.what() + "; all is served on as it was");
        }
    }
}

/// Lets answers under way end; a second signal ends them at once.
void stopInOrder(Server& server, Milliseconds grace) {
    say("stopping: answers under way are sent to their end, for up to " + std::to_string(grace.count() / 1000) + " s");
    server.stop(grace);
    const sigset_t signals = handledSignals();
    const timespec interval = {.tv_sec = 0, .tv_nsec = 20'000'000};
    while (!server.hasEnded()) {
        const int signal = ::sigtimedwait(&signals, nullptr, &interval);
        if (signal == SIGTERM || signal == SIGINT) server.stop(Milliseconds(0));
    }
    server.join();
}

bool parse(const std::vector<std::string>& arguments, Settings& settings) {
    CommandLine line(
        "terray-server",
        "Serves datasets over HTTP/1.1. SIGHUP opens them anew, SIGTERM ends after the answers under way.\n"
        "Its addresses, behaviour and limits are described in server/README.md.");
    line.positionals("NAME=DIR", settings.datasets,
                     "a dataset and its name in addresses; @FILE: one NAME=DIR a line, read again at SIGHUP")
        .required();
    line.option("--listen", settings.listen, "HOST:PORT",
                "default 127.0.0.1:8080; [::]:8080 for IPv6; port 0: a free one");
    line.option("--threads", settings.threads, "N", "threads that serve; default: one for each core");
    line.bytes("--cache", settings.cacheBytes, "tiles kept in memory, default 256M; 0: none");
    line.option("--max-connections", settings.maxConnections, "N",
                "default 16384; one more takes the place of the longest idle, else it is refused");
    line.option("--idle-timeout", settings.idleTimeout, "S",
                "seconds without a request, or for 64 KiB of an answer, default 60");
    line.option("--log", settings.log, "FORMAT", "access log on stdout: text (default), json or off");
    return line.parse(arguments);
}

}  // namespace

ExitCode runServer(const std::vector<std::string>& arguments) {
    Settings settings;
    if (!parse(arguments, settings)) return ExitCode::ok;
    requireBetween("--threads", static_cast<double>(settings.threads), 1, 1024);
    requireBetween("--max-connections", static_cast<double>(settings.maxConnections), 1, 10'000'000);
    requireBetween("--idle-timeout", settings.idleTimeout, 1, 86400);

    const sigset_t signals = handledSignals();
    ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // before there are threads: they inherit it
    std::signal(SIGPIPE, SIG_IGN);                    // a client, or a reader of the log, that has gone

    const auto catalogue = openCatalogue(parseSpecs(settings.datasets));
    const Milliseconds idleTimeout(static_cast<int64_t>(settings.idleTimeout * 1000));
    Server server({.listen = settings.listen,
                   .threads = static_cast<int>(settings.threads),
                   .maxConnections = roomForConnections(static_cast<size_t>(settings.maxConnections)),
                   .idleTimeout = idleTimeout,
                   .cacheBytes = settings.cacheBytes,
                   .log = parseLogFormat(settings.log)},
                  catalogue);
    server.start();
    for (const std::string& address : server.addresses()) say("listening at http://" + address);
    serveUntilStopped(server, catalogue, settings);
    stopInOrder(server, idleTimeout);
    return ExitCode::ok;
}

}  // namespace terray::server
