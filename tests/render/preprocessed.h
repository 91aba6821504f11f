#pragma once

#include <string>

namespace terray {

/// The code that a shader's resolved text leaves to the compiler: without comments, without what #if, #elif, #ifdef and
/// #ifndef leave out, without directives and blank lines. Conditions may be made of names that are 0, 1 or undefined,
/// `defined(NAME)`, `!`, `&&` and `||`, without parentheses around them; anything else fails the test that asks.
[[nodiscard]] std::string preprocessed(const std::string& text);

}  // namespace terray
