#include "preprocess/file_lists.h"

#include <fstream>

#include "common/error.h"

namespace terray {
namespace {

/// A line without what editors of other systems leave at its end.
std::string trimmed(std::string line) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.pop_back();
    return line;
}

std::vector<std::string> namesIn(const std::string& list) {
    std::ifstream file(list);
    if (!file) throw Error(ExitCode::input, "cannot read the list of files \"" + list + "\": there is no such file");
    std::vector<std::string> names;
    std::string line;
    while (std::getline(file, line)) {
        const std::string name = trimmed(line);
        if (name.empty() || name.front() == '#') continue;
        if (name.front() == '@')
            throw Error(ExitCode::input,
                        "the list of files \"" + list + "\" names another list, \"" + name + "\"; expected files only");
        names.push_back(name);
    }
    if (file.bad()) throw Error(ExitCode::input, "cannot read the list of files \"" + list + "\" to its end");
    if (names.empty()) throw Error(ExitCode::input, "the list of files \"" + list + "\" is empty");
    return names;
}

}  // namespace

std::vector<std::string> withoutLists(const std::vector<std::string>& names) {
    std::vector<std::string> files;
    for (const std::string& name : names) {
        if (name.empty() || name.front() != '@') {
            files.push_back(name);
            continue;
        }
        const std::vector<std::string> listed = namesIn(name.substr(1));
        files.insert(files.end(), listed.begin(), listed.end());
    }
    return files;
}

}  // namespace terray
