#include "tests/server/server_process.h"

#include <csignal>
#include <cstdlib>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/check.h"
#include "tests/server/small_dataset.h"

namespace terray::server {

ServerProcess::ServerProcess(const std::vector<std::string>& arguments) {
    std::vector<std::string> words = {TERRAY_SERVER_PROGRAM, "--listen", "127.0.0.1:0"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const std::string out = directory_ / "out", err = directory_ / "err";
    id_ = ::fork();
    if (id_ == 0) {
        ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
        ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
        ::execv(pointers[0], pointers.data());
        std::_Exit(127);
    }
    const std::string notice = "listening at http://127.0.0.1:";
    waitForNotice(notice);
    const std::string text = this->err();
    port_ = static_cast<uint16_t>(std::stoi(text.substr(text.find(notice) + notice.size())));
}

ServerProcess::~ServerProcess() {
    if (id_ <= 0) return;
    ::kill(id_, SIGKILL);
    ::waitpid(id_, nullptr, 0);
}

void ServerProcess::signal(int number) const {
    TERRAY_CHECK_OP(::kill(id_, number), ==, 0);
}

void ServerProcess::waitForNotice(const std::string& text) const {
    for (int tries = 0; tries < 2000; ++tries) {
        const std::string all = std::filesystem::exists(directory_ / "err") ? err() : "";
        const size_t place = all.find(text);
        if (place != std::string::npos && all.find('\n', place) != std::string::npos) return;
        ::usleep(10000);
    }
    TERRAY_CHECK_OP(err(), ==, text);  // says what it printed instead
}

int ServerProcess::wait() {
    int status = 0;
    ::waitpid(id_, &status, 0);
    id_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string ServerProcess::out() const {
    return readText(directory_ / "out");
}

std::string ServerProcess::err() const {
    return readText(directory_ / "err");
}

}  // namespace terray::server
