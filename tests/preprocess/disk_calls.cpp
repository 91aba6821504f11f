#include "tests/preprocess/disk_calls.h"

#include <csignal>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

std::function<bool(const terray::DiskCall&)> watch;

bool diesNow(const char* name, int descriptor = -1) {
    return watch && watch({name, descriptor});
}

[[noreturn]] void die() {
    ::kill(::getpid(), SIGKILL);
    for (;;) ::pause();
}

}  // namespace

extern "C" {

ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t offset) {
    if (diesNow("pwrite", descriptor)) {
        ::syscall(SYS_pwrite64, descriptor, bytes, count / 2, offset);
        die();
    }
    return ::syscall(SYS_pwrite64, descriptor, bytes, count, offset);
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
    if (diesNow("write", descriptor)) {
        ::syscall(SYS_write, descriptor, bytes, count / 2);
        die();
    }
    return ::syscall(SYS_write, descriptor, bytes, count);
}

int fdatasync(int descriptor) {
    if (diesNow("fdatasync", descriptor)) die();
    return static_cast<int>(::syscall(SYS_fdatasync, descriptor));
}

int fsync(int descriptor) {
    if (diesNow("fsync", descriptor)) die();
    return static_cast<int>(::syscall(SYS_fsync, descriptor));
}

int ftruncate(int descriptor, off_t length) noexcept {
    if (diesNow("ftruncate", descriptor)) die();
    return static_cast<int>(::syscall(SYS_ftruncate, descriptor, length));
}

int rename(const char* from, const char* to) noexcept {
    if (diesNow("rename")) die();
    return static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

int mkdir(const char* path, mode_t mode) noexcept {
    if (diesNow("mkdir")) die();
    return static_cast<int>(::syscall(SYS_mkdirat, AT_FDCWD, path, mode));
}

int unlinkat(int directory, const char* path, int flags) noexcept {
    if (diesNow("unlinkat")) die();
    return static_cast<int>(::syscall(SYS_unlinkat, directory, path, flags));
}

int unlink(const char* path) noexcept {
    if (diesNow("unlink")) die();
    return static_cast<int>(::syscall(SYS_unlinkat, AT_FDCWD, path, 0));
}

int rmdir(const char* path) noexcept {
    if (diesNow("rmdir")) die();
    return static_cast<int>(::syscall(SYS_unlinkat, AT_FDCWD, path, AT_REMOVEDIR));
}

int remove(const char* path) noexcept {
    if (diesNow("remove")) die();
    if (::syscall(SYS_unlinkat, AT_FDCWD, path, 0) == 0) return 0;
    return static_cast<int>(::syscall(SYS_unlinkat, AT_FDCWD, path, AT_REMOVEDIR));
}

}  // extern "C"

namespace terray {

DiskWatch::DiskWatch(std::function<bool(const DiskCall&)> dieNow) {
    watch = std::move(dieNow);
}

DiskWatch::~DiskWatch() {
    watch = {};
}

}  // namespace terray
