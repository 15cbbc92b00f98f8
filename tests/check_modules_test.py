#!/usr/bin/env python3
"""check_modules_test.py: tools/check_modules.py must object to each kind of wrong include, at the right file and line."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOL = Path(__file__).resolve().parent.parent / "tools" / "check_modules.py"

SOUND = {
    "src/snug/low/CMakeLists.txt": "snug_module(low HEADERS low.hpp)\n",
    "src/snug/low/low.hpp": "// Low.\n#include <vector>\n",
    "src/snug/low/internal/secret.hpp": "// Secret.\n",
    "src/snug/low/low.cpp": '#include "snug/low/low.hpp"\n#include "snug/low/internal/secret.hpp"\n',
    "src/snug/middle/CMakeLists.txt": "snug_module(middle HEADERS middle.hpp\n  DEPENDS low  # why\n  TESTS test/a.cpp)\n",
    "src/snug/middle/middle.hpp": '#include "snug/low/low.hpp"\n',
    "src/snug/high/CMakeLists.txt": "snug_module(high HEADERS high.hpp DEPENDS middle)\n",
    "src/snug/high/high.hpp": '#include "snug/middle/middle.hpp"\n#include "snug/low/low.hpp"\n',
    "bench/count/CMakeLists.txt": "snug_app_library(count SOURCES count.cpp DEPENDS middle)\n",
    "bench/count/count.hpp": '#include "snug/low/low.hpp"\n',
    "bench/count/internal/secret.hpp": "// Secret.\n",
    "apps/snug/CMakeLists.txt": "add_executable(snug main.cpp)\n",
    "apps/snug/main.cpp": '#include "apps/snug/send/send.hpp"\n#include "snug/low/low.hpp"\n',
    "apps/snug/words/CMakeLists.txt": "snug_verb(words SOURCES words.cpp DEPENDS low)\n",
    "apps/snug/words/words.hpp": '#include "snug/low/low.hpp"\n',
    "apps/snug/send/CMakeLists.txt": "snug_verb(send\n  SOURCES send.cpp\n  USES words\n  DEPENDS high count)\n",
    "apps/snug/send/send.hpp": '#include "apps/snug/words/words.hpp"\n#include "bench/count/count.hpp"\n',
    "apps/snug/send/send.cpp": '#include "apps/snug/send/send.hpp"\n#include "snug/high/high.hpp"\n',
    "python/CMakeLists.txt": "add_library(core)\ntarget_link_libraries(core PRIVATE snug::middle fmt::fmt)\n",
    "python/src/module.cpp": '#include "handles.hpp"\n#include "snug/middle/middle.hpp"\n',
    "python/src/handles.hpp": "// Handles.\n",
    "bench/peers/main.cpp": '#include "peers/engine.hpp"\n',
    "bench/peers/engine.hpp": "// Engine.\n",
}


class CheckModules(unittest.TestCase):
    def run_on(self, changes):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in {**SOUND, **changes}.items():
                path = Path(folder) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            result = subprocess.run([sys.executable, TOOL, folder], capture_output=True, text=True, check=False)
        return result.returncode, result.stdout

    def assert_refused(self, changes, *expected):
        status, output = self.run_on(changes)
        self.assertEqual(status, 1, output)
        for text in expected:
            self.assertIn(text, output)

    def test_accepts_declared_and_transitive_includes(self):
        status, output = self.run_on({})
        self.assertEqual((status, output), (0, "17 includes follow the declared modules\n"))

    def test_refuses_an_undeclared_module(self):
        self.assert_refused({"src/snug/low/low.cpp": '// Low.\n\n#include "snug/high/high.hpp"\n'},
                            "low.cpp:3:", "module 'low' does not declare 'high'")

    def test_refuses_an_undeclared_module_in_a_test(self):
        self.assert_refused({"src/snug/low/test/low_test.cpp": '#  include "snug/middle/middle.hpp"\n'},
                            "low_test.cpp:1:", "does not declare 'middle'")

    def test_lets_tests_alone_include_what_only_they_declare(self):
        declared = {"src/snug/low/CMakeLists.txt": "snug_module(low HEADERS low.hpp\n  TESTS test/a.cpp TEST_DEPENDS high)\n"}
        include = '// Low.\n#include "snug/high/high.hpp"\n'
        self.assertEqual(self.run_on({**declared, "src/snug/low/test/a.cpp": include})[0], 0)
        self.assert_refused({**declared, "src/snug/low/low.cpp": include}, "low.cpp:2:", "does not declare 'high'")
        self.assert_refused({"src/snug/low/CMakeLists.txt": "snug_module(low HEADERS low.hpp TEST_DEPENDS moon)\n"},
                            "CMakeLists.txt:1:", "the tests of 'low' depend on 'moon'")

    def test_refuses_angle_brackets_as_a_way_around(self):
        self.assert_refused({"src/snug/low/low.cpp": "#include <snug/high/high.hpp>\n"},
                            "low.cpp:1:", "in quotes", "does not declare 'high'")

    def test_refuses_circular_modules(self):
        self.assert_refused({"src/snug/low/CMakeLists.txt": "\nsnug_module(low HEADERS low.hpp DEPENDS high)\n"},
                            "CMakeLists.txt:", "circular modules:")

    def test_refuses_a_dependency_on_a_module_that_is_not_there(self):
        self.assert_refused({"src/snug/high/CMakeLists.txt": "snug_module(high DEPENDS middle moon)\n"},
                            "CMakeLists.txt:1:", "'moon'")

    def test_refuses_internal_headers_of_another_module(self):
        self.assert_refused({"src/snug/high/high.cpp": '#include "snug/low/internal/secret.hpp"\n'},
                            "high.cpp:1:", "internal headers are for module 'low' only")
        self.assert_refused({"apps/snug/main.cpp": '#include "snug/low/internal/secret.hpp"\n'}, "main.cpp:1:")
        self.assert_refused({"apps/snug/send/send.cpp": '#include "bench/count/internal/secret.hpp"\n'},
                            "send.cpp:1:", "internal headers are for module 'count' only")

    def test_refuses_relative_ways_into_another_module(self):
        self.assert_refused({"src/snug/low/low.cpp": '#include "../high/high.hpp"\n'}, "low.cpp:1:", "leaves module")

    def test_refuses_headers_outside_modules_that_do_not_exist(self):
        self.assert_refused({"bench/peers/main.cpp": '#include "peers/gone.hpp"\n'}, "main.cpp:1:", "gone.hpp")

    def test_refuses_headers_that_do_not_exist(self):
        self.assert_refused({"src/snug/high/high.cpp": '#include "snug/low/gone.hpp"\n'}, "high.cpp:1:", "no such file")

    def test_refuses_a_folder_without_a_module(self):
        self.assert_refused({"src/snug/stray/stray.cpp": "// Stray.\n"}, "stray.cpp:1:", "declares no module")
        self.assert_refused({"apps/other/main.cpp": "// Stray.\n"}, "main.cpp:1:", "declares no module")

    def test_refuses_a_module_that_a_verb_does_not_declare(self):
        self.assert_refused({"apps/snug/words/words.cpp": '// Words.\n#include "snug/high/high.hpp"\n'},
                            "words.cpp:2:", "module 'apps/snug/words' does not declare 'high' (it may use low)")

    def test_refuses_a_verb_s_folder_that_another_does_not_declare(self):
        self.assert_refused({"apps/snug/words/words.cpp": '#include "apps/snug/send/send.hpp"\n'},
                            "words.cpp:1:", "module 'apps/snug/words' does not declare 'apps/snug/send'")

    def test_refuses_verbs_that_use_each_other(self):
        self.assert_refused({"apps/snug/words/CMakeLists.txt": "snug_verb(words USES send DEPENDS low)\n"},
                            "CMakeLists.txt:1:", "circular modules: ")

    def test_refuses_the_program_s_headers_in_a_module_and_in_python(self):
        for place in ("src/snug/high/high.cpp", "python/src/module.cpp"):
            self.assert_refused({place: '#include "apps/snug/send/send.hpp"\n'}, ".cpp:1:", "does not declare 'apps/snug/send'")
            self.assert_refused({place: '\n#include "../../apps/snug/send/send.hpp"\n'}, ".cpp:2:")

    def test_refuses_a_module_that_python_does_not_link(self):
        self.assert_refused({"python/src/module.cpp": '// Module.\n\n#include "snug/high/high.hpp"\n'},
                            "module.cpp:3:", "module 'python' does not declare 'high' (it may use low, middle)")


class Planner(unittest.TestCase):
    """A planner cannot name a plant's state: no chain of declared modules leads there, and no include."""

    ROOT = Path(__file__).resolve().parent.parent
    HIDDEN = ("simulated_plant", "remote_plant", "study")

    def setUp(self):
        sys.path.insert(0, str(TOOL.parent))
        import check_modules
        self.check_modules = check_modules

    def test_no_chain_of_modules_leads_from_the_session_to_a_plant_s_truth(self):
        modules = self.check_modules.declared_units(self.ROOT)
        problems = []
        reachable = self.check_modules.check_declarations(modules, problems)
        self.assertEqual(problems, [])
        for planner in ("session", "plant", "perception", "packing"):
            self.assertFalse(reachable[planner] & set(self.HIDDEN), planner)
        self.assertIn("simulated_plant", reachable["study"])
        self.assertFalse(reachable["remote_plant"] & {"simulated_plant", "study", "session"}, "a plant elsewhere")

    def test_no_file_of_the_planner_includes_one_of_a_plant_s_truth(self):
        for planner in ("session", "plant", "perception", "packing"):
            files = [path for path in self.check_modules.source_files(self.ROOT)
                     if self.ROOT / "src" / "snug" / planner in path.parents]
            self.assertTrue(files, planner)
            for path in files:
                for line in path.read_text().splitlines():
                    match = self.check_modules.INCLUDE.match(line)
                    if match:
                        self.assertNotIn(Path(match.group(2)).parts[1:2], [(name,) for name in self.HIDDEN], path)

    def test_an_include_of_it_would_be_refused(self):
        session = self.ROOT / "src" / "snug" / "session"
        texts = {"src/snug/simulated_plant/CMakeLists.txt": "snug_module(simulated_plant HEADERS simulated_plant.hpp)\n",
                 "src/snug/simulated_plant/simulated_plant.hpp": "// Truth.\n",
                 "src/snug/session/CMakeLists.txt": "snug_module(session HEADERS session.hpp DEPENDS low)\n",
                 "src/snug/session/session.hpp": '#include "snug/simulated_plant/simulated_plant.hpp"\n'}
        with tempfile.TemporaryDirectory() as folder:
            for name, text in {**SOUND, **texts}.items():
                path = Path(folder) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            problems, _ = self.check_modules.check(Path(folder))
        self.assertEqual(len(problems), 1)
        self.assertIn("module 'session' does not declare 'simulated_plant'", problems[0])
        self.assertTrue((session / "session.hpp").exists())


if __name__ == "__main__":
    unittest.main()
