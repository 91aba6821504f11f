#pragma once

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

namespace terray::detail {

[[noreturn]] inline void checkFailed(const char* file, int line, const char* condition, const std::string& values) {
    std::fprintf(stderr, "%s:%d: check failed: %s%s\n", file, line, condition, values.c_str());
    std::abort();
}

template <class A, class B>
[[nodiscard]] std::string describePair(const A& a, const B& b) {
    std::ostringstream text;
    text << " (left " << a << ", right " << b << ")";
    return text.str();
}

}  // namespace terray::detail

/// Misuse of an interface by our own code: stops the program and says where. Stays on in release builds.
/// Never for input: what comes from a file or a peer is answered with Result or Error.
#define TERRAY_CHECK(condition)                                                              \
    do {                                                                                     \
        if (!(condition)) ::terray::detail::checkFailed(__FILE__, __LINE__, #condition, ""); \
    } while (false)

/// As TERRAY_CHECK for a comparison, printing both values: TERRAY_CHECK_OP(index, <, size).
#define TERRAY_CHECK_OP(left, op, right)                                                            \
    do {                                                                                            \
        const auto& terrayLeft = (left);                                                            \
        const auto& terrayRight = (right);                                                          \
        if (!(terrayLeft op terrayRight))                                                           \
            ::terray::detail::checkFailed(__FILE__, __LINE__, #left " " #op " " #right,             \
                                          ::terray::detail::describePair(terrayLeft, terrayRight)); \
    } while (false)
