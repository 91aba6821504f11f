#include "tests/preprocess_sources/read_counter.h"

#include <atomic>
#include <cstdio>

#include <cpl_vsi.h>

namespace terray::test {
namespace {

constexpr const char* kPrefix = "/vsicounted/";
std::atomic<uint64_t> bytesRead = 0;

std::FILE* fileOf(void* handle) {
    return static_cast<std::FILE*>(handle);
}

void install() {
    VSIFilesystemPluginCallbacksStruct* calls = VSIAllocFilesystemPluginCallbacksStruct();
    calls->stat = [](void*, const char* name, VSIStatBufL* status, int) { return VSIStatL(name, status); };
    calls->open = [](void*, const char* name, const char*) -> void* { return std::fopen(name, "rb"); };
    calls->tell = [](void* handle) { return static_cast<vsi_l_offset>(::ftello(fileOf(handle))); };
    calls->seek = [](void* handle, vsi_l_offset offset, int whence) {
        return ::fseeko(fileOf(handle), static_cast<off_t>(offset), whence);
    };
    calls->read = [](void* handle, void* buffer, size_t size, size_t count) {
        const size_t got = std::fread(buffer, size, count, fileOf(handle));
        bytesRead += size * got;
        return got;
    };
    calls->eof = [](void* handle) { return std::feof(fileOf(handle)); };
    calls->close = [](void* handle) { return std::fclose(fileOf(handle)); };
    VSIInstallPluginHandler(kPrefix, calls);
    VSIFreeFilesystemPluginCallbacksStruct(calls);
}

}  // namespace

std::string countedName(const std::string& file) {
    static const bool isInstalled = [] {
        install();
        return true;
    }();
    (void)isInstalled;
    return kPrefix + file;
}

uint64_t takeBytesRead() {
    return bytesRead.exchange(0);
}

}  // namespace terray::test
