#!/usr/bin/env python3
"""hardening_test.py: what the linker and the compiler were asked for is in the program; the list of what it consists of is whole; a file
compiles to the same bytes in another folder. SNUG names the program, BUILD the build folder."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = Path(os.environ.get("BUILD", ROOT / "build"))
SNUG = os.environ.get("SNUG", str(BUILD / "snug"))


def run(*words, **more):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=True, timeout=1100, **more).stdout


def is_release():
    return "CMAKE_BUILD_TYPE:STRING=Release" in (BUILD / "CMakeCache.txt").read_text()


class Hardening(unittest.TestCase):
    def test_nothing_can_be_written_that_runs_or_leads_to_what_runs(self):
        headers = run("readelf", "-lW", SNUG)
        self.assertRegex(headers, r"Elf file type is DYN")  # anywhere in memory
        self.assertRegex(headers, r"GNU_RELRO")
        self.assertRegex(headers, r"GNU_STACK\s.*\sRW\s")
        self.assertRegex(run("readelf", "-dW", SNUG), r"\(FLAGS(_1)?\).*NOW")
        self.assertNotRegex(headers, r"LOAD\s.*\sRWE\s")

    def test_no_library_is_looked_for_in_the_current_folder(self):
        for file in (SNUG, *(BUILD / "python" / "snug").glob("*.so")):
            self.assertNotRegex(run("readelf", "-dW", file), r"\(R(UN)?PATH\)")

    def test_stacks_and_copies_are_checked(self):
        symbols = run("nm", "-D", "--undefined-only", SNUG)
        self.assertIn("__stack_chk_fail", symbols)
        if is_release():
            self.assertRegex(symbols, r"__\w+_chk\b(?<!__stack_chk_fail)")

    @unittest.skipUnless(os.uname().machine == "x86_64", "targets of jumps are marked on x86-64")
    def test_every_object_of_a_library_has_marked_targets_of_jumps(self):
        notes = run("readelf", "-nW", BUILD / "src" / "snug" / "core" / "libsnug_core.a")
        objects = notes.count("File: ")
        self.assertGreater(objects, 0)
        self.assertEqual(len(re.findall(r"x86 feature: IBT, SHSTK", notes)), objects)


class BillOfMaterials(unittest.TestCase):
    def test_it_has_every_library_that_is_loaded_and_every_package_of_the_page(self):
        bill = json.loads(run(sys.executable, "-B", ROOT / "tools" / "sbom.py", SNUG, "--version", "0.1.0",
                              env={**os.environ, "SOURCE_DATE_EPOCH": "1700000000"}))
        self.assertEqual((bill["spdxVersion"], bill["creationInfo"]["created"]), ("SPDX-2.3", "2023-11-14T22:13:20Z"))
        names = {package["name"] for package in bill["packages"]}
        self.assertLessEqual({"snug", "libc6", "libstdc++6", "libeigen3-dev", "three"}, names)
        self.assertTrue(any(name.startswith("libfmt") for name in names), "its number is that of the release of Debian")
        ids = [package["SPDXID"] for package in bill["packages"]]
        self.assertEqual(len(ids), len(set(ids)))
        related = {relation["relatedSpdxElement"] for relation in bill["relationships"]}
        self.assertEqual(related, set(ids))
        for package in bill["packages"]:
            self.assertTrue(package["versionInfo"], package["name"])
            self.assertRegex(package["SPDXID"], r"^SPDXRef-[A-Za-z0-9.-]+$")


class Reproducible(unittest.TestCase):
    """Of one file; `make reproducible` does it with the packages, and takes as long as two builds."""

    def test_a_file_compiles_to_the_same_bytes_in_another_folder_at_another_time(self):
        commands = json.loads((BUILD / "compile_commands.json").read_text())
        words = next(one["command"] for one in commands if "snug_core.dir" in one["command"]).split()
        flags = [word for word in words if word.startswith(("-O", "-D", "-f", "-std"))]
        objects = []
        for _ in range(2):
            with tempfile.TemporaryDirectory() as folder:
                sources = Path(folder) / ("src" + "x" * len(objects))
                shutil.copytree(ROOT / "src" / "snug" / "core", sources / "snug" / "core")
                mapped = [re.sub(r"(prefix-map=).*", rf"\1{sources}/=", flag) for flag in flags]
                file = sources / "snug" / "core" / "output_file.cpp"
                run(os.environ.get("CXX", "c++"), *mapped, "-I", sources, "-c", file, "-o", f"{file}.o")
                objects.append(Path(f"{file}.o").read_bytes())
        self.assertEqual(objects[0], objects[1])


if __name__ == "__main__":
    unittest.main()
