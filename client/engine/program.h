#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/error.h"

namespace terray {

/// What a main() of a client program does: runs `body` with the arguments after the program's name, prints what an
/// Error says as "<name>: ..." to stderr, and returns the exit code that the table in README.md gives it. `--version`
/// alone prints what was built from which commit. While it runs, the first SIGINT or SIGTERM only sets a flag, so that
/// temporary files can be removed, and a write beyond the limit of a file's size fails instead of ending the program.
int runProgram(const std::string& name, int argc, char** argv,
               const std::function<ExitCode(const std::vector<std::string>& arguments)>& body);

/// Throws Error(interrupted) once SIGINT or SIGTERM has come.
void throwIfInterrupted();

}  // namespace terray
