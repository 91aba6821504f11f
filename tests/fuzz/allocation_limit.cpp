#include "tests/fuzz/allocation_limit.h"

#include <cstdio>
#include <cstdlib>
#include <limits>
#include <new>

#include <malloc.h>

#include "common/check.h"

namespace {

constexpr int64_t kNoLimit = std::numeric_limits<int64_t>::max();
thread_local int64_t heldBytes = 0;  // of those taken under the limit; below 0 where older ones are given back
thread_local int64_t mostBytes = kNoLimit;

void* allocate(size_t size) {
    void* const memory = std::malloc(size);
    if (memory == nullptr) return nullptr;
    heldBytes += static_cast<int64_t>(malloc_usable_size(memory));
    if (heldBytes > mostBytes) {
        std::fprintf(stderr, "allocation beyond the limit: %zu bytes more make %lld, the limit is %lld\n", size,
                     static_cast<long long>(heldBytes), static_cast<long long>(mostBytes));
        std::abort();
    }
    return memory;
}

void release(void* memory) {
    heldBytes -= static_cast<int64_t>(malloc_usable_size(memory));
    std::free(memory);
}

}  // namespace

namespace terray::fuzz {

AllocationLimit::AllocationLimit(size_t bytes) {
    TERRAY_CHECK_OP(mostBytes, ==, kNoLimit);
    heldBytes = 0;
    mostBytes = static_cast<int64_t>(bytes);
}

AllocationLimit::~AllocationLimit() {
    mostBytes = kNoLimit;
}

}  // namespace terray::fuzz

// All forms but the aligned ones: Clang's sanitizers bring each form by itself, and what one gave another cannot free.
void* operator new(size_t size) {
    void* const memory = allocate(size);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}
void* operator new[](size_t size) {
    return operator new(size);
}
void* operator new(size_t size, const std::nothrow_t&) noexcept {
    return allocate(size);
}
void* operator new[](size_t size, const std::nothrow_t&) noexcept {
    return allocate(size);
}
void operator delete(void* memory) noexcept {
    release(memory);
}
void operator delete[](void* memory) noexcept {
    release(memory);
}
void operator delete(void* memory, size_t) noexcept {
    release(memory);
}
void operator delete[](void* memory, size_t) noexcept {
    release(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
    release(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
    release(memory);
}
