"""The tree keeps its shape: what may lie in the root, how long a file may be, how headers guard themselves."""

import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]
FOLDERS = ["client", "common", "preprocess", "server", "shaders", "scripts", "tests"]
ROOT_FILES = ["CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md"]
MADE_HERE = ["build", "compile_commands.json"]  # what .gitignore keeps out of the repository
SOURCE_SUFFIXES = {".h", ".cpp", ".glsl", ".vert", ".frag", ".comp", ".py", ".cmake", ".txt"}
MAX_LINES = 500  # a file holds one idea


def files_below(suffixes):
    """The project's files with one of the suffixes, root-relative, sorted."""
    found = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.suffix in suffixes]
    return sorted(path.relative_to(ROOT) for path in found if path.is_file())


class Tree(unittest.TestCase):
    def test_the_root_holds_only_what_is_agreed(self):
        allowed = {*FOLDERS, *ROOT_FILES, *MADE_HERE}
        found = {path.name for path in ROOT.iterdir() if not path.name.startswith(".")}
        self.assertEqual(set(), found - allowed)

    def test_no_source_file_is_longer_than_one_idea(self):
        lengths = {str(path): len((ROOT / path).read_text(encoding="utf-8").splitlines())
                   for path in files_below(SOURCE_SUFFIXES)}
        self.assertGreater(len(lengths), 0)
        self.assertEqual({}, {path: lines for path, lines in lengths.items() if lines > MAX_LINES})

    def test_headers_guard_themselves(self):
        headers = files_below({".h"})
        self.assertGreater(len(headers), 0)
        unguarded = [str(path) for path in headers if not is_guarded(path)]
        self.assertEqual([], unguarded)


def is_guarded(header):
    """Whether a header begins with #pragma once; one that GLSL shares may have a macro instead."""
    first = first_code_line((ROOT / header).read_text(encoding="utf-8"))
    return first == "#pragma once" or (header.parts[0] == "shaders" and first.startswith("#ifndef TERRAY_"))


def first_code_line(text):
    """The first line that is neither empty nor a line comment."""
    lines = (line.strip() for line in text.splitlines())
    return next((line for line in lines if line and not line.startswith("//")), "")


if __name__ == "__main__":
    unittest.main()
