#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace terray {

/// Arguments of a command line as a person wrote them.
using Arguments = std::vector<std::string>;
/// Options by name without dashes, and their values.
using OptionTexts = std::vector<std::pair<std::string, std::string>>;

/// Whether an option is among the arguments, as "--name value" or "--name=value". @param name  without dashes
[[nodiscard]] bool gives(const Arguments& arguments, std::string_view name);
/// The arguments without some options and their values. @param names  options that take one value
[[nodiscard]] Arguments withoutOptions(const Arguments& arguments, std::span<const std::string_view> names);
/// The arguments with these options at their end.
[[nodiscard]] Arguments withOptions(Arguments arguments, const OptionTexts& options);

/// The shortest text that reads back as the same number.
[[nodiscard]] std::string numberText(double number);

}  // namespace terray
