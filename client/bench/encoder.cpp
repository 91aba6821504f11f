#include "client/bench/encoder.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <utility>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/error.h"

namespace terray {
namespace {

/// The last lines of a log, or that it is empty.
std::string endOf(const std::filesystem::path& log) {
    constexpr size_t kMost = 600;
    std::ifstream file(log, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    while (!text.empty() && text.back() == '\n') text.pop_back();
    if (text.empty()) return "it printed nothing";
    return "it printed: " + (text.size() > kMost ? "..." + text.substr(text.size() - kMost) : text);
}

/// In the child: input, output, then the program. Returns errno only where there is no such program.
void becomeProgram(char* const* words, int input, const char* log) {
    ::dup2(input, STDIN_FILENO);
    const int out = ::open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(out, STDERR_FILENO);
    // A Ctrl-C is for us: we then end the program, or let it finish what it has.
    ::setpgid(0, 0);
    std::signal(SIGPIPE, SIG_DFL);
    ::execvp(words[0], words);
}

struct Pipe {
    int read = -1;
    int write = -1;
};

Pipe makePipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0)
        throw Error(ExitCode::output, std::string("cannot make a pipe to another program: ") + std::strerror(errno));
    return {ends[0], ends[1]};
}

}  // namespace

Encoder::Encoder(const std::string& program, const std::vector<std::string>& arguments, std::filesystem::path log)
    : program_(program), log_(std::move(log)) {
    std::signal(SIGPIPE, SIG_IGN);  // a program that ended early is told by write()
    std::vector<std::string> words{program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);

    const Pipe input = makePipe(), failure = makePipe();
    process_ = ::fork();
    if (process_ == 0) {
        becomeProgram(pointers.data(), input.read, log_.c_str());
        const int reason = errno;
        [[maybe_unused]] const ssize_t told = ::write(failure.write, &reason, sizeof(reason));
        std::_Exit(127);
    }
    ::close(input.read);
    ::close(failure.write);
    input_ = input.write;
    // Closed by exec when that succeeds.
    int reason = process_ < 0 ? errno : 0;
    if (process_ > 0 && ::read(failure.read, &reason, sizeof(reason)) == 0) reason = 0;
    ::close(failure.read);
    if (reason == 0) return;
    if (process_ > 0) wait();
    ::close(input_);
    if (reason == ENOENT)
        throw Error(ExitCode::unsupported, "cannot find the program " + program +
                                               " (install the Debian package ffmpeg, or say where it is by --ffmpeg)");
    throw Error(ExitCode::output, "cannot start " + program + ": " + std::strerror(reason));
}

Encoder::~Encoder() {
    if (input_ >= 0) ::close(input_);
    if (process_ < 0) return;
    ::kill(process_, SIGKILL);
    wait();
}

int Encoder::wait() {
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status;
}

void Encoder::refuse(const std::string& what) const {
    throw Error(ExitCode::output, program_ + " " + what + "; " + endOf(log_));
}

void Encoder::write(ByteView bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(input_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) {
            wait();
            refuse("ended before it had all frames");
        }
        bytes = bytes.subspan(static_cast<size_t>(written));
    }
}

void Encoder::finish() {
    ::close(std::exchange(input_, -1));
    const int status = wait();
    if (WIFSIGNALED(status)) refuse("was ended by signal " + std::to_string(WTERMSIG(status)));
    if (WEXITSTATUS(status) != 0) refuse("failed with exit code " + std::to_string(WEXITSTATUS(status)));
}

void runTool(const std::string& program, const std::vector<std::string>& arguments, const std::filesystem::path& log) {
    Encoder(program, arguments, log).finish();
}

}  // namespace terray
