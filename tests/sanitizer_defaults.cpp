// How the sanitizers behave in every program of a sanitized build (TERRAY_SANITIZE), whoever starts it. Their run-time
// libraries look for these functions by name; an environment variable such as ASAN_OPTIONS still overrides them.

#include <dlfcn.h>

#include <initializer_list>

extern "C" {

const char* __ubsan_default_options();
const char* __tsan_default_options();
const char* __tsan_default_suppressions();
const char* __lsan_default_options();
const char* __lsan_default_suppressions();
int __lsan_is_turned_off();

const char* __ubsan_default_options() {
    return "print_stacktrace=1";
}

const char* __tsan_default_options() {
    return "halt_on_error=1:second_deadlock_stack=1";
}

// Mesa's software rasteriser, GDAL and OpenImageIO synchronise their threads in code that was not instrumented; GDAL's
// drivers take two mutexes in both orders while they are registered, once, by one thread.
const char* __tsan_default_suppressions() {
    return "called_from_lib:libEGL_mesa.so\n"
           "called_from_lib:swrast_dri.so\n"
           "called_from_lib:libLLVM\n"
           "race:libgdal\n"
           "race:libOpenImageIO\n"
           "deadlock:libgdal";
}

const char* __lsan_default_options() {
    return "print_suppressions=0";
}

// Memory that foreign libraries keep until the process ends.
const char* __lsan_default_suppressions() {
    return "leak:libEGL\n"
           "leak:libGLdispatch\n"
           "leak:libglfw\n"
           "leak:libX11\n"
           "leak:libdbus\n"
           "leak:libglapi\n"
           "leak:swrast_dri\n"
           "leak:libLLVM\n"
           "leak:libOpenImageIO\n"
           "leak:libgdal\n"
           "leak:libproj";
}

// At exit the leak checker stops all threads and reads their memory. Where one is a thread of Mesa's rasteriser that is
// just ending, that faults ("Tracer caught signal 11"), about once in a thousand programs. Programs that drew are
// therefore not searched for leaks; for those that did not, and for all other faults, nothing changes.
int __lsan_is_turned_off() {
    for (const char* driver : {"libEGL_mesa.so.0", "libGLX_mesa.so.0"})
        if (dlopen(driver, RTLD_LAZY | RTLD_NOLOAD) != nullptr) return 1;
    return 0;
}

}  // extern "C"
