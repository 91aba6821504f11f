# Writes the source behind common/version.h: which version, commit, compiler and kind of build this is.
# Run by the build as: cmake -DSOURCE_DIR= -DOUTPUT= -DVERSION= -DCOMPILER= -DBUILD_TYPE= -DSANITIZE= -P write_version.cmake
# Leaves OUTPUT untouched when nothing changed.

# The commit of SOURCE_DIR, and whether tracked files differ from it. Without git or a repository: "unknown", clean.
set(commit "unknown")
set(dirty "false")
find_program(git git)
if(git)
    execute_process(COMMAND ${git} -C ${SOURCE_DIR} rev-parse HEAD
        OUTPUT_VARIABLE head RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(NOT failed)
        set(commit ${head})
        execute_process(COMMAND ${git} -C ${SOURCE_DIR} --no-optional-locks status --porcelain --untracked-files=no
            OUTPUT_VARIABLE changes ERROR_QUIET)
        if(changes)
            set(dirty "true")
        endif()
    endif()
endif()

set(build "${BUILD_TYPE}")
if(SANITIZE)
    string(APPEND build " ${SANITIZE}")
endif()

file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "common/version.h"

namespace terray {

const BuildInfo& buildInfo() {
    static constexpr BuildInfo kInfo{
        .version = "@VERSION@",
        .commit = "@commit@",
        .dirty = @dirty@,
        .compiler = "@COMPILER@",
        .build = "@build@",
    };
    return kInfo;
}

}  // namespace terray
]])
