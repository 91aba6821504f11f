"""scripts/check_layers.py finds what it is for: each test writes a small tree with one fault, or none."""

import importlib.util
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).parents[2] / "scripts" / "check_layers.py"
spec = importlib.util.spec_from_file_location("check_layers", SCRIPT)
check_layers = importlib.util.module_from_spec(spec)
spec.loader.exec_module(check_layers)


class Layers(unittest.TestCase):
    def faults(self, files):
        """Faults of a tree of {path: text}."""
        with tempfile.TemporaryDirectory() as folder:
            write_tree(Path(folder), files)
            return check_layers.check(Path(folder))

    def test_the_allowed_tree_has_no_faults(self):
        self.assertEqual([], self.faults({
            "common/a.h": "#pragma once\n#include <vector>\n#include <glm/vec3.hpp>\n",
            "common/a.cpp": '#include "common/a.h"\n#include <zstd.h>\n',
            "preprocess/read.cpp": '#include "common/a.h"\n#include <gdal_priv.h>\n#include <cpl_conv.h>\n',
            "shaders/interop.h": "#pragma once\n",
            "shaders/math/box.glsl": "// a box\n",
            "shaders/march.glsl": '#include "math/box.glsl"\n',
            "client/render/draw.cpp": '#include <epoxy/gl.h>\n#include "shaders/interop.h"\n',
            "tests/common/a_test.cpp": '#include <gtest/gtest.h>\n#include "common/a.h"\n',
        }))

    def test_a_fault_names_file_line_finding_and_rule(self):
        found = self.faults({"common/a.cpp": "#include <vector>\n\n#include <gdal.h>\n"})
        self.assertEqual(["common/a.cpp:3: found #include gdal.h; GDAL is allowed only in preprocess, tests"], found)

    def test_common_includes_no_higher_layer(self):
        self.assertEqual(1, len(self.faults({"preprocess/a.h": "", "common/b.cpp": '#include "preprocess/a.h"\n'})))

    def test_stream_and_render_do_not_know_each_other(self):
        self.assertEqual(2, len(self.faults({
            "client/stream/a.h": '#include "client/render/b.h"\n',
            "client/render/b.h": '#include "client/stream/a.h"\n',
        })))

    def test_render_takes_of_the_shaders_only_what_it_shares_with_them(self):
        tree = {"shaders/math/box.glsl": "", "client/render/b.cpp": '#include "shaders/math/box.glsl"\n'}
        self.assertEqual(1, len(self.faults(tree)))

    def test_shader_math_includes_only_shader_math(self):
        self.assertEqual(2, len(self.faults({
            "shaders/a.glsl": "",
            "shaders/math/b.glsl": '#include "math/c.glsl"\n#include "a.glsl"\n#include <cmath>\n',
            "shaders/math/c.glsl": "",
        })))

    def test_shader_math_has_one_face_in_cpp(self):
        face = '#include <cmath>\n#include "math/box.glsl"\n'
        self.assertEqual([], self.faults({"shaders/math/box.glsl": "", "shaders/math/a.h": face}))
        self.assertEqual(2, len(self.faults({"shaders/math/box.glsl": "", "shaders/math/a.h": face,
                                             "shaders/math/b.h": face})))

    def test_a_library_has_one_door(self):
        found = self.faults({"preprocess/a.cpp": "#include <stb_dxt.h>\n", "preprocess/b.cpp": "#include <stb_image.h>\n"})
        self.assertEqual(2, len(found))
        self.assertIn("found stb in 2 files of preprocess (preprocess/a.cpp, preprocess/b.cpp); 1 is", found[0])

    def test_an_unknown_library_is_a_fault(self):
        self.assertEqual(1, len(self.faults({"common/a.cpp": "#include <nlohmann/json.hpp>\n"})))

    def test_a_missing_or_relative_project_file_is_a_fault(self):
        self.assertEqual(1, len(self.faults({"common/a.h": "", "common/b.cpp": '#include "a.h"\n'})))

    def test_an_include_by_macro_is_a_fault(self):
        self.assertEqual(1, len(self.faults({"common/a.cpp": "#include TERRAY_HEADER\n"})))

    def test_a_file_outside_all_layers_is_a_fault(self):
        self.assertEqual(1, len(self.faults({"client/a.cpp": ""})))

    def test_comments_and_raw_strings_are_not_read(self):
        text = '// #include <gdal.h>\n/*\n#include <gdal.h>\n*/\nconst char* kText = R"(\n#include "none.glsl"\n)";\n'
        self.assertEqual([], self.faults({"common/a.cpp": text}))

    def test_the_exit_status_says_whether_there_are_faults(self):
        with tempfile.TemporaryDirectory() as folder:
            write_tree(Path(folder), {"common/a.cpp": "#include <vector>\n"})
            self.assertEqual(0, run_script(folder))
            write_tree(Path(folder), {"common/b.cpp": "#include <GLFW/glfw3.h>\n"})
            self.assertEqual(1, run_script(folder))


def write_tree(root, files):
    for path, text in files.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text, encoding="utf-8")


def run_script(root):
    return subprocess.run([sys.executable, str(SCRIPT), root], capture_output=True, check=False).returncode


if __name__ == "__main__":
    unittest.main()
