#!/usr/bin/env python3
"""same_bytes_test.py: results do not depend on the processor: nothing inexact of the system's libm is called, and runs without AVX2 and
fused multiply-add come to the same state. SNUG names the program."""
import json
import os
import re
import subprocess
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
STATES = Path(SNUG).resolve().parent / "tests" / "same_bytes" / "snug_states"
# Rounded as IEEE 754 says, or exact: the same whatever code does it.
EXACT = set("ceil ceilf copysign fabs fdim floor floorf fma fmaf fmax fmin fmod fmodf frexp frexpf ilogb ldexp ldexpf llrint llround logb lrint lround "
            "lroundf modf modff nan nearbyint nextafter remainder remquo rint rintf round roundf scalbln scalbn sqrt sqrtf trunc truncf".split())
WITHOUT = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA"}
SCENES = ["bench/s2-drop.yaml", "bench/s4-bounce.yaml", "bench/s5-swing.yaml", "bench/s6b.yaml", "conveyor.yaml"]


def symbols(file, *words):
    lines = subprocess.run(["nm", "-D", *words, file], capture_output=True, text=True, check=True).stdout.splitlines()
    return {line.split()[-1].split("@")[0] for line in lines}


def libm():
    told = subprocess.run(["ldd", SNUG], capture_output=True, text=True, check=True).stdout
    return re.search(r"libm\.so\.6 => (\S+)", told)[1]


class SameBytes(unittest.TestCase):
    def test_the_program_calls_nothing_inexact_of_the_systems_libm(self):
        called = symbols(SNUG, "--undefined-only") & symbols(libm(), "--defined-only")
        self.assertEqual(sorted(called - EXACT), [], "to be added to src/snug/numerics/elementary.hpp and c_math.cpp")

    def test_the_python_module_has_the_same_functions_and_binds_to_them(self):
        modules = list((Path(SNUG).resolve().parent / "python" / "snug").glob("_core*.so"))
        if not modules:
            self.skipTest("the Python module is not built")
        called = symbols(modules[0], "--undefined-only") & symbols(libm(), "--defined-only")
        self.assertEqual(sorted(called - EXACT), [])
        told = subprocess.run(["readelf", "-dW", modules[0]], capture_output=True, text=True, check=True).stdout
        self.assertRegex(told, r"\(SYMBOLIC\)|Flags:.*SYMBOLIC|\(FLAGS\).*SYMBOLIC")

    def test_libraries_get_the_programs_functions(self):
        own = symbols(SNUG, "--defined-only")
        self.assertEqual({"sin", "cos", "exp", "log", "pow", "atan2"} - own, set())

    def test_states_are_the_same_without_avx2_and_fma(self):
        for scene in SCENES:
            with self.subTest(scene=scene):
                hashes = set()
                for more in ({}, WITHOUT):
                    run = subprocess.run([SNUG, "simulate", str(ROOT / "scenarios" / scene), "--until", "0.5", "--json"], capture_output=True,
                                         text=True, check=True, env={**os.environ, **more})
                    hashes.add(json.loads(run.stdout)["state_hash"])
                self.assertEqual(len(hashes), 1, hashes)

    @unittest.skipUnless(STATES.exists(), "snug_states is not built")
    def test_twenty_scenes_a_heap_and_a_session_are_the_same_without_avx2_and_fma(self):
        found = [json.loads(subprocess.run([STATES, ROOT / "scenarios"], capture_output=True, text=True, check=True, env={**os.environ, **more}).stdout)
                 for more in ({}, WITHOUT)]
        self.assertEqual(len(found[0]), 22)
        self.assertEqual(len(set(found[0].values())), 22, "no two scenes come to one state")
        self.assertEqual(*found)

    def test_a_packing_session_is_the_same_without_avx2_and_fma(self):
        words = ["pack", str(ROOT / "scenarios" / "box-demonstrator.yaml"), "--sequence", "1", "--plant-seed", "4", "--samples", "0",
                 "--agent", "margin", "--decision-time", "0.01", "--json"]
        hashes = set()
        for more in ({}, WITHOUT):
            run = subprocess.run([SNUG, *words], capture_output=True, text=True, check=False, env={**os.environ, **more})
            hashes.add(json.loads(run.stdout)["state_hash"])
        self.assertEqual(len(hashes), 1, hashes)


if __name__ == "__main__":
    unittest.main()
