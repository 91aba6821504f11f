#include "tests/render/preprocessed.h"

#include <map>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

namespace terray {
namespace {

using Names = std::map<std::string, std::string>;

std::string trimmed(const std::string& text) {
    const size_t first = text.find_first_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string> split(const std::string& text, const std::string& by) {
    std::vector<std::string> parts;
    size_t from = 0;
    for (size_t at = text.find(by); at != std::string::npos; from = at + by.size(), at = text.find(by, from))
        parts.push_back(trimmed(text.substr(from, at - from)));
    parts.push_back(trimmed(text.substr(from)));
    return parts;
}

bool valueOf(const std::string& term, const Names& names) {
    if (term.starts_with("!")) return !valueOf(trimmed(term.substr(1)), names);
    if (term.starts_with("defined(")) return names.contains(term.substr(8, term.size() - 9));
    EXPECT_EQ(term.find('('), std::string::npos) << term;
    const auto found = names.find(term);
    if (found == names.end()) return false;
    EXPECT_TRUE(found->second == "0" || found->second == "1") << term << " is " << found->second;
    return found->second == "1";
}

bool holds(const std::string& condition, const Names& names) {
    for (const std::string& alternative : split(condition, "||")) {
        bool all = true;
        for (const std::string& term : split(alternative, "&&")) all = all && valueOf(term, names);
        if (all) return true;
    }
    return false;
}

/// Open conditionals, outermost first.
class Conditionals {
  public:
    /// Whether code at this place counts.
    [[nodiscard]] bool live() const {
        for (const Branch& branch : open_)
            if (!branch.live) return false;
        return true;
    }
    /// @return whether the directive was one of a conditional
    bool take(const std::string& word, const std::string& rest, const Names& names) {
        if (word == "#if") {
            enter(holds(rest, names));
        } else if (word == "#ifdef" || word == "#ifndef") {
            enter(names.contains(rest) == (word == "#ifdef"));
        } else if (word == "#elif" || word == "#else") {
            Branch& branch = open_.back();
            branch.live = !branch.taken && (word == "#else" || holds(rest, names));
            branch.taken |= branch.live;
        } else if (word == "#endif") {
            open_.pop_back();
        } else {
            return false;
        }
        return true;
    }

  private:
    struct Branch {
        bool live;
        bool taken;
    };
    void enter(bool live) { open_.push_back({live, live}); }
    std::vector<Branch> open_;
};

}  // namespace

std::string preprocessed(const std::string& text) {
    Names names;
    Conditionals conditionals;
    std::istringstream lines(text);
    std::string code;
    for (std::string line; std::getline(lines, line);) {
        line = trimmed(line.substr(0, line.find("//")));
        if (line.empty()) continue;
        if (!line.starts_with("#")) {
            if (conditionals.live()) code += line + "\n";
            continue;
        }
        std::istringstream words(line);
        std::string word, name, value;
        words >> word;
        if (conditionals.take(word, trimmed(line.substr(word.size())), names)) continue;
        if (word != "#define" || !conditionals.live()) continue;
        words >> name >> value;
        names[name] = value;
    }
    return code;
}

}  // namespace terray
