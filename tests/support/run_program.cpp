#include "tests/support/run_program.h"

#include <cstdlib>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/common/temporary_directory.h"

namespace terray {
namespace {

/// In the child: output to files, limits, then the program. Does not return.
[[noreturn]] void becomeProgram(const ProgramRun& run, char* const* arguments, const std::filesystem::path& out,
                                const std::filesystem::path& err) {
    ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    if (run.maxFileBytes) {
        const rlimit limit = {*run.maxFileBytes, *run.maxFileBytes};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ::execv(arguments[0], arguments);
    std::_Exit(127);
}

std::string readText(const std::filesystem::path& path) {
    const Bytes bytes = test::readFile(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

ProgramResult execute(const ProgramRun& run) {
    const test::TemporaryDirectory directory;
    std::vector<std::string> words = {run.program};
    words.insert(words.end(), run.arguments.begin(), run.arguments.end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);

    const pid_t child = ::fork();
    if (child == 0) becomeProgram(run, arguments.data(), directory / "out", directory / "err");
    int status = 0;
    bool interrupted = false;
    while (::waitpid(child, &status, run.interruptWhen ? WNOHANG : 0) == 0) {
        if (!interrupted && run.interruptWhen()) {
            ::kill(child, SIGINT);
            interrupted = true;
        }
        ::usleep(1000);
    }
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readText(directory / "out"), readText(directory / "err")};
}

}  // namespace terray
