#!/usr/bin/env python3
"""Checks that every #include keeps to the layers of the project.

Two tables say it all: which project folders a folder may include (PROJECT), and which folders may include a foreign
library and from how many files (FOREIGN; one file means that library's door; GDAL's is too large for one). A header that neither table knows is an
error, so that a new dependency is always a decision taken here.

usage: check_layers.py [ROOT]
Prints one line "file:line: what was found; what is allowed" for each fault; exits 1 when there is any.
"""

import re
import sys
from pathlib import Path

MANY = None  # any number of files

# folder: what it may include of the project (folders, or single files), beside itself
PROJECT = {
    "common": [],
    "common/reference": ["common"],
    "preprocess": ["common"],
    "server": ["common"],
    "shaders/math": [],
    "shaders": ["shaders/math"],
    "client/stream": ["common"],
    "client/render": ["common", "shaders/interop.h"],
    "client/overlay": ["common", "client/stream"],
    "client/navigation": ["common", "client/stream"],
    "client/exchange": ["common", "client/stream", "client/overlay"],
    "client/output": ["common"],
    "client/engine": ["common", "client/stream", "client/overlay", "client/render"],
    "client/view": [
        "common", "client/stream", "client/overlay", "client/navigation", "client/exchange", "client/render",
        "client/output", "client/engine",
    ],
    "client/bench": [
        "common", "common/reference", "shaders/math", "client/stream", "client/exchange", "client/render",
        "client/output", "client/engine",
    ],
}
PROJECT["tests"] = list(PROJECT)  # a test may look at everything
CPP_FOLDERS = [folder for folder in PROJECT if not folder.startswith("shaders")]
# Beside them the C++ faces of the shaders; shaders/math has one. GLSL itself includes no foreign header anywhere.
CPP_EVERYWHERE = {**{folder: MANY for folder in CPP_FOLDERS}, "shaders": MANY, "shaders/math": 1}

# name: (pattern of its headers, {folder: number of files that may include it}); tests may include any of them
FOREIGN = {
    "the C++ standard library": (r"[a-z_0-9]+", CPP_EVERYWHERE),
    "POSIX": (
        r"(sys|netinet|arpa)/\w+\.h|(unistd|fcntl|dirent|poll|pthread|sched|signal|termios|dlfcn)\.h",
        {folder: MANY for folder in CPP_FOLDERS},
    ),
    "GLM": (r"glm/.*", CPP_EVERYWHERE),
    "zstd": (r"(zstd|zstd_errors|zdict)\.h", {"common": 1}),
    "zlib": (r"(zlib|zconf)\.h", {"common": 1}),
    "GeographicLib": (r"GeographicLib/.*", {"common": 1}),
    "PROJ": (r"proj(_\w+)?\.h|proj/.*", {"common": 1}),
    "GDAL": (r"(gdal|ogr|cpl|vrt)\w*\.h", {"preprocess": 4}),
    "OpenImageIO": (r"OpenImageIO/.*", {"preprocess": 1, "client/output": MANY}),
    "OpenEXR": (r"(OpenEXR|Imath)/.*|(Imf|Imath|Iex|half)\w*\.h", {"client/output": MANY}),
    "stb": (r"(stb/)?stb_\w+\.h", {"preprocess": 1}),
    "MPI": (r"mpi\.h", {"preprocess": 1}),
    "libsquish": (r"squish\.h", {}),
    "pugixml": (r"pugixml\.hpp", {"client/overlay": 1, "client/exchange": 1}),
    "Boost": (r"boost/.*", {"server": MANY}),
    "libcurl": (r"curl/.*", {"client/stream": 1}),
    "EGL": (r"(EGL|KHR)/.*|epoxy/egl\w*\.h", {"client/render": 1}),
    "OpenGL": (r"epoxy/gl\w*\.h", {"client/render": MANY}),
    "GLFW": (r"GLFW/.*", {"client/view": 1}),
    "Dear ImGui": (r"(backends/)?imgui\w*\.h", {"client/view": MANY}),
    "GoogleTest": (r"(gtest|gmock)/.*", {}),
    "Embree": (r"embree3/.*", {}),
    "the C library's allocator": (r"malloc\.h", {}),
    "AVX2 intrinsics": (r"immintrin\.h", {}),
}

SOURCE_FOLDERS = ["client", "common", "preprocess", "server", "shaders", "tests"]
GLSL = {".glsl", ".vert", ".frag", ".comp"}
SUFFIXES = {".h", ".hpp", ".inl", ".c", ".cc", ".cpp"} | GLSL

HIDDEN = re.compile(r'R"([^()\\\s]{0,16})\(.*?\)\1"|/\*.*?\*/', re.DOTALL)  # raw strings and block comments
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include\b[ \t]*(?:([<"])([^>"\n]+)[>"])?', re.MULTILINE)


def layer_of(path):
    """The layer that a root-relative path lies in: the longest folder of PROJECT that holds it, or None."""
    holders = [folder for folder in PROJECT if path.startswith(folder + "/")]
    return max(holders, key=len, default=None)


def includes(text):
    """Yields (line number, bracket, header) of each #include outside comments and raw strings; header None if odd."""
    visible = HIDDEN.sub(lambda match: "\n" * match.group().count("\n"), text)
    for match in INCLUDE.finditer(visible):
        yield visible.count("\n", 0, match.start()) + 1, match.group(1), match.group(2)


def project_file(root, source, header):
    """Root-relative path of the project file that `header` names in `source`, or None.

    Files are named from the root; shaders name each other also from shaders/.
    """
    bases = [root]
    if source.is_relative_to(root / "shaders"):
        bases.append(root / "shaders")
    for base in bases:
        candidate = (base / header).resolve()
        if candidate.is_file() and candidate.is_relative_to(root):
            return candidate.relative_to(root).as_posix()
    return None


def project_fault(layer, target):
    """Why `layer` must not include the project file `target`, or None if it may."""
    target_layer = layer_of(target)
    if target_layer == layer or target in PROJECT[layer] or target_layer in PROJECT[layer]:
        return None
    return f"{layer} may include of the project only {', '.join([layer] + PROJECT[layer])}"


def foreign_name(header):
    """The library that a header belongs to, or None if the table has no such header."""
    return next((name for name, (pattern, _) in FOREIGN.items() if re.fullmatch(pattern, header)), None)


def foreign_fault(layer, name, is_glsl):
    """Why `layer` must not include the library `name`, or None if it may."""
    if is_glsl:
        return "GLSL includes only files of shaders"
    if name is None:
        return "no known library has it (a new dependency is entered in scripts/check_layers.py)"
    doors = FOREIGN[name][1]
    if layer in doors or layer == "tests":
        return None
    return f"{name} is allowed only in {', '.join(dict.fromkeys([*doors, 'tests']))}"


def source_files(root):
    """All source files below the source folders of root, sorted."""
    for folder in SOURCE_FOLDERS:
        yield from sorted(path for path in (root / folder).rglob("*") if path.suffix in SUFFIXES and path.is_file())


def check(root):
    """Returns the faults of the tree at root as lines of text."""
    root = root.resolve()
    faults = []
    uses = {}  # (library, layer): {file: line of its first include}
    for source in source_files(root):
        path = source.relative_to(root).as_posix()
        layer = layer_of(path)
        if layer is None:
            faults.append(f"{path}:1: lies in no layer; layers are {', '.join(PROJECT)}")
            continue
        for line, bracket, header in includes(source.read_text(encoding="utf-8")):
            where = f"{path}:{line}"
            if header is None:
                faults.append(f"{where}: found an #include without a name; only a name in quotes or <> is allowed")
                continue
            target = project_file(root, source, header) if bracket == '"' else None
            if target is not None:
                reason = project_fault(layer, target)
            elif bracket == '"':
                reason = "no such file in the project (quotes are for project files, named from the root)"
            else:
                name = foreign_name(header)
                reason = foreign_fault(layer, name, source.suffix in GLSL)
                if name is not None and reason is None:
                    uses.setdefault((name, layer), {}).setdefault(path, line)
            if reason is not None:
                faults.append(f"{where}: found #include {header}; {reason}")
    for (name, layer), files in sorted(uses.items()):
        limit = FOREIGN[name][1].get(layer, MANY)
        if limit is not MANY and len(files) > limit:
            for path, line in files.items():
                found = f"found {name} in {len(files)} files of {layer} ({', '.join(files)})"
                faults.append(f"{path}:{line}: {found}; {limit} is allowed")
    return faults


def main():
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent.parent
    faults = check(root)
    for fault in faults:
        print(fault, file=sys.stderr)
    count = sum(1 for _ in source_files(root.resolve()))
    print(f"check_layers: {count} files, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
