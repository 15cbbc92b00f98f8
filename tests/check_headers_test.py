#!/usr/bin/env python3
"""check_headers_test.py: tools/check_headers.py must object to a header that needs what it does not include, and to no other."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOL = Path(__file__).resolve().parent.parent / "tools" / "check_headers.py"

POSE = "#pragma once\n#include <vector>\nstruct Pose {\n  std::vector<double> numbers;\n};\n"


class CheckHeaders(unittest.TestCase):
    def run_on(self, files):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                path = Path(folder) / "src" / "snug" / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            result = subprocess.run([sys.executable, TOOL, folder], capture_output=True, text=True, check=False)
        return result.returncode, result.stdout + result.stderr

    def test_sound_headers(self):
        status, output = self.run_on({"spatial/pose.hpp": POSE,
                                      "arm/arm.hpp": '#include "snug/spatial/pose.hpp"\nstruct Arm {\n  Pose base;\n  std::vector<int> joints;\n};\n'})
        self.assertEqual((status, output.strip()), (0, "2 of 2 headers compile alone"))

    def test_header_that_needs_what_another_includes(self):
        status, output = self.run_on({"spatial/pose.hpp": POSE, "arm/arm.hpp": "struct Arm {\n  Pose base;\n};\n",
                                      "arm/joints.hpp": "using Joints = std::vector<double>;\n"})
        self.assertEqual(status, 1)
        self.assertIn("snug/arm/arm.hpp does not compile alone", output)
        self.assertIn("snug/arm/joints.hpp does not compile alone", output)
        self.assertIn("1 of 3 headers compile alone", output)

    def test_header_that_others_include_is_named_and_they_too(self):
        status, output = self.run_on({"arm/part.hpp": "using Parts = std::vector<double>;\n",
                                      "arm/arm.hpp": '#include "snug/arm/part.hpp"\nstruct Arm {\n  Parts parts;\n};\n',
                                      "arm/cell.hpp": '#include <vector>\n#include "snug/arm/arm.hpp"\nstruct Cell {\n  Arm arm;\n};\n'})
        self.assertEqual(status, 1)
        for name in ("part", "arm"):
            self.assertIn(f"snug/arm/{name}.hpp does not compile alone", output)
        self.assertIn("1 of 3 headers compile alone", output)

    def test_header_that_a_source_file_includes_first_is_left_to_the_compilation_of_that(self):
        needs_more = "using Joints = std::vector<double>;\n"
        status, output = self.run_on({"spatial/pose.hpp": POSE, "arm/joints.hpp": needs_more, "arm/arm.hpp": needs_more,
                                      "arm/joints.cpp": '// Joints.\n#include "snug/arm/joints.hpp"\n\n#include <vector>\n',
                                      "arm/link.cpp": '#include <vector>\n#include "snug/arm/arm.hpp"\n'})
        self.assertEqual(status, 1)
        self.assertIn("snug/arm/arm.hpp does not compile alone", output)
        self.assertIn("1 of 2 headers compile alone", output)

    def test_no_headers(self):
        status, output = self.run_on({})
        self.assertEqual(status, 1)
        self.assertIn("no headers", output)


if __name__ == "__main__":
    unittest.main()
