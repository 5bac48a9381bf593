#!/usr/bin/python3
"""tools/check_layers.py finds each kind of violation in a small repository, and nothing else."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "tools" / "check_layers.py"

GOOD = {
    "src/tandem/tandem.h": '#pragma once\n#include "tandem/io/file.h"\n',
    "src/tandem/core/CMakeLists.txt": "tandem_module(NAME core\n  SOURCES a.cpp\n  HEADERS a.h)\n",
    "src/tandem/core/a.h": "#pragma once\n#include <vector>\n",
    "src/tandem/core/a.cpp": '#include "tandem/core/a.h"\n\n#include <yaml-cpp/yaml.h>\n',
    "src/tandem/motion/CMakeLists.txt": "tandem_module(NAME motion HEADERS m.h)\n",
    "src/tandem/motion/m.h":
        '#pragma once\n#include <Eigen/Core>\n#include <unsupported/Eigen/Splines>\n'
        '#include "tandem/core/a.h"\n',
    "src/tandem/world/CMakeLists.txt": "tandem_module(NAME world HEADERS w.h)\n",
    "src/tandem/world/w.h": "#pragma once\n",
    "src/tandem/collision/CMakeLists.txt":
        "tandem_module(NAME collision\n  SOURCES c.cpp  # inner.h is private\n  HEADERS c.h)\n"
        "tandem_module(NAME collision_fcl FOLDER collision/fcl SOURCES f.cpp HEADERS f.h)\n",
    "src/tandem/collision/c.h": '#pragma once\n#include "tandem/motion/m.h"\n',
    "src/tandem/collision/inner.h": "#pragma once\n#include <fcl/fcl.h>\n",
    "src/tandem/collision/c.cpp": '#include "tandem/collision/inner.h"\n',
    "src/tandem/collision/fcl/f.h": '#pragma once\n#include "tandem/collision/c.h"\n',
    "src/tandem/collision/fcl/f.cpp":
        '#include "tandem/collision/fcl/f.h"\n#include "tandem/collision/inner.h"\n',
    "src/tandem/planning/CMakeLists.txt": "tandem_module(NAME planning SOURCES p.cpp)\n",
    "src/tandem/planning/p.cpp": '#include "tandem/collision/c.h"\n',
    "src/tandem/pipeline/CMakeLists.txt": "tandem_module(NAME pipeline SOURCES p.cpp)\n",
    "src/tandem/pipeline/p.cpp": '#include "tandem/collision/fcl/f.h"\n',
    "src/tandem/io/CMakeLists.txt": "tandem_module(NAME io HEADERS file.h)\n",
    "src/tandem/io/file.h": "#pragma once\n",
    "apps/tandem/main.cpp": '#include <CLI/CLI.hpp>\n#include "tandem/tandem.h"\n#include "local.h"\n',
}


def body(lines):
    """`lines` lines of statements."""
    return "  f();\n" * lines


class CheckLayers(unittest.TestCase):
    def run_on(self, changes):
        """Exit code and output on the good repository with `changes` (None removes a file)."""
        with tempfile.TemporaryDirectory() as folder:
            for name, text in {**GOOD, **changes}.items():
                path = Path(folder) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                if text is not None:
                    path.write_text(text)
            done = subprocess.run([sys.executable, SCRIPT, "--root", folder], text=True,
                                  capture_output=True, check=False)
            return done.returncode, done.stdout + done.stderr

    def assert_finds(self, changes, *expected):
        """Exactly one finding, at the place and with the words of `expected`."""
        code, output = self.run_on(changes)
        self.assertEqual(code, 1, output)
        self.assertIn("check_layers: 1 finding\n", output)
        for words in expected:
            self.assertIn(words, output)

    def assert_clean(self, changes):
        code, output = self.run_on(changes)
        self.assertEqual((code, output), (0, "check_layers: 0 findings\n"))

    def test_good_repository_is_clean(self):
        self.assert_clean({})

    def test_no_repository_is_wrong_use(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, SCRIPT, "--root", folder], text=True,
                                  capture_output=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("no src/tandem", done.stderr)

    def test_include_upwards(self):
        self.assert_finds({"src/tandem/core/a.cpp": '\n#include "tandem/motion/m.h"\n'},
                          "src/tandem/core/a.cpp:2:", "includes up", "motion is level 4")

    def test_include_sideways(self):
        self.assert_finds({"src/tandem/motion/m.h": '#include "tandem/world/w.h"\n'},
                          "src/tandem/motion/m.h:1:", "includes sideways")

    def test_core_includes_optional_component(self):
        for user in ("collision/c", "planning/p"):
            self.assert_finds({f"src/tandem/{user}.cpp": '#include "tandem/collision/fcl/f.h"\n'},
                              f"src/tandem/{user}.cpp:1:", "collision/fcl is optional")

    def test_optional_component_includes_up(self):
        self.assert_finds({"src/tandem/collision/fcl/f.cpp": '#include "tandem/io/file.h"\n'},
                          "src/tandem/collision/fcl/f.cpp:1:", "includes up")

    def test_folder_includes_the_umbrella(self):
        self.assert_finds({"src/tandem/pipeline/p.cpp": '#include "tandem/tandem.h"\n'},
                          "src/tandem/pipeline/p.cpp:1:", "tandem.h is for programs")

    def test_unknown_folder(self):
        self.assert_finds({"src/tandem/gadgets/g.h": "#pragma once\n"},
                          "src/tandem/gadgets/g.h:1:", "does not know")
        self.assert_finds({"src/tandem/core/deeper/g.h": "#pragma once\n"},
                          "src/tandem/core/deeper/g.h:1:", "does not know")

    def test_include_of_nothing(self):
        self.assert_finds({"src/tandem/core/a.cpp": '#include "tandem/core/none.h"\n'},
                          "src/tandem/core/a.cpp:1:", "does not exist")

    def test_relative_include(self):
        self.assert_finds({"src/tandem/core/a.cpp": '#include "a.h"\n'},
                          "src/tandem/core/a.cpp:1:", "write the path from src")

    def test_third_party_in_public_header(self):
        for library in ("yaml-cpp/yaml.h", "fcl/fcl.h", "nlopt.hpp", "tinyxml2.h"):
            self.assert_finds({"src/tandem/core/a.h": f"#pragma once\n#  include <{library}>\n"},
                              "src/tandem/core/a.h:2:", library, "only std, Eigen and tandem")

    def test_private_header_used_in_public_or_elsewhere(self):
        include = '#include "tandem/collision/inner.h"\n'
        self.assert_finds({"src/tandem/collision/c.h": include},
                          "src/tandem/collision/c.h:1:", "private to its folder")
        self.assert_finds({"src/tandem/planning/p.cpp": include},
                          "src/tandem/planning/p.cpp:1:", "private to its folder")

    def test_unlisted_source_is_not_built(self):
        self.assert_finds({"src/tandem/core/b.cpp": "\n"}, "src/tandem/core/b.cpp:1:", "SOURCES")
        self.assert_finds({"src/tandem/collision/fcl/c.cpp": "\n"},
                          "src/tandem/collision/fcl/c.cpp:1:", "not built")

    def test_file_sizes(self):
        for name, limit in (("src/tandem/core/a.h", 300), ("src/tandem/core/a.cpp", 600),
                            ("apps/tandem/main.cpp", 600), ("tests/core/x_test.cpp", 600)):
            self.assert_clean({name: "\n" * (limit - 1)})
            self.assert_finds({name: "\n" * limit}, f"{name}:{limit}:", f"stay under {limit}")

    def test_function_sizes(self):
        for opening in ("void g() {\n", "TEST(Suite, Case) {\n", "int Foo::bar(int a) const {\n",
                        "Foo::Foo() : a_{1}, b_(2) {\n", "Foo::Foo() : a_(1), b_{2} {\n",
                        "template <class T>\nauto f(T t = {}) -> std::vector<T> {\n",
                        "bool operator<(A a, B b) {\n", "const auto kF = [](int x) {\n",
                        "namespace a { struct B : C<int> { void f() override {\n"):
            extra = opening.count("\n") + 1
            for name in ("src/tandem/core/a.cpp", "tests/core/x_test.cpp"):
                closing = "}" * (opening.count("{") - opening.count("{}") -
                                 opening.count("{1}") - opening.count("{2}")) + ";\n"
                self.assert_clean({name: opening + body(59 - extra) + closing})
                self.assert_finds({name: "\n" + opening + body(60 - extra) + closing},
                                  f"{name}:2:", "has 60 lines: stay under 60")

    def test_long_things_that_are_no_functions(self):
        for text in ("namespace a {\nclass B {\n public:\n" + "  void f() {}\n" * 80 + "};\n}\n",
                     "const std::map<int, int> kTable = {\n" + "  {1, 2},\n" * 80 + "};\n",
                     "enum class E {\n" + "  kA,\n" * 80 + "};\n",
                     "/* f() { */\n" + "// g() {\n" * 80,
                     "void f();\n" * 80,
                     'const char* kText = R"(f() {\n' + "text\n" * 80 + ')";\n',
                     "#define F() {\\\n" + "  x \\\n" * 80 + "\n"):
            self.assert_clean({"src/tandem/core/a.cpp": text})

    def test_braces_in_text_do_not_count(self):
        opening = 'void f() {\n  g("}", \'}\', 1\'000\'000);  // }\n  /* } */ h(R"x(})x");\n'
        self.assert_finds({"src/tandem/core/a.cpp": opening + body(60) + "}\n"},
                          "src/tandem/core/a.cpp:1:", "f has 64 lines")


if __name__ == "__main__":
    unittest.main()
