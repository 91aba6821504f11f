#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace terray {

/// Options of one program or sub-command, and its `--help`.
///
/// Ours because the bench must build without further libraries (preset bench-minimal). Accepts `--name value`,
/// `--name=value`, `--` before positional arguments that start with a dash; negative numbers are values. Every option
/// may stand anywhere. Unknown, repeated, valueless or badly formed options throw Error(usage) with the nearest known
/// name. Messages do not name the program: its main() does.
///
///     CommandLine line("terray-preprocess synth", "Builds a procedural dataset.");
///     line.option("--size", size, "N", "samples along a side").required();
///     line.parse(arguments);
class CommandLine {
  public:
    CommandLine(std::string program, std::string summary);

    /// Says more about the option just declared.
    class Option {
      public:
        Option& required();
        /// Set to true once the option was given.
        Option& given(bool& flag);

      private:
        friend class CommandLine;
        Option(CommandLine& line, size_t index) : line_(line), index_(index) {}
        CommandLine& line_;
        size_t index_;
    };

    Option flag(std::string name, bool& target, std::string help);
    Option option(std::string name, std::string& target, std::string valueName, std::string help);
    Option option(std::string name, double& target, std::string valueName, std::string help);
    Option option(std::string name, int64_t& target, std::string valueName, std::string help);
    Option option(std::string name, std::optional<double>& target, std::string valueName, std::string help);
    /// One or more values up to the next option; may be repeated.
    Option list(std::string name, std::vector<std::string>& target, std::string valueName, std::string help);
    /// Bytes: a number with an optional suffix K, M, G, T (powers of 1024).
    Option bytes(std::string name, uint64_t& target, std::string help);
    /// "WIDTHxHEIGHT", each 1..65536.
    Option size(std::string name, int& width, int& height, std::string help);
    /// Positional arguments in order; the last may take many.
    Option positional(std::string name, std::string& target, std::string help);
    Option positionals(std::string name, std::vector<std::string>& target, std::string help);

    /// Fills the targets. @return false when `--help` was asked for and printed, then the program should end with ok.
    [[nodiscard]] bool parse(const std::vector<std::string>& arguments);
    /// The text of `--help`: usage line, summary, one line per option.
    [[nodiscard]] std::string help() const;

  private:
    struct Declared {
        std::string name;       ///< "--size", or the name of a positional
        std::string valueName;  ///< empty for a flag
        std::string help;
        bool isPositional = false;
        bool takesMany = false;
        bool isRequired = false;
        bool seen = false;
        bool* given = nullptr;
        std::function<void(const std::string&)> assign;  ///< throws Error(usage)
    };
    Option declare(Declared declared);
    [[noreturn]] void refuseUnknown(const std::string& name) const;
    void give(Declared& option, const std::string& value);
    void givePositional(const std::string& value);
    /// Takes the option at `index` with its values. @return the index of the argument after them
    size_t giveOption(const std::vector<std::string>& arguments, size_t index);

    std::string program_;
    std::string summary_;
    std::vector<Declared> options_;
};

}  // namespace terray
