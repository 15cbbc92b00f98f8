"""tools/identify_packed.py on one small case: what was planted in a packed run comes back from its archive."""
import os
import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


class PackedProgram(unittest.TestCase):
    def run_tool(self, *words):
        return subprocess.run([sys.executable, "-B", str(ROOT / "tools" / "identify_packed.py"), *map(str, words)], capture_output=True, text=True, timeout=900,
                              check=False, env=os.environ)

    def test_numbers_planted_in_a_packed_run_are_identified_from_its_archive(self):
        done = self.run_tool("--seed", 2, "--count", 1, "--boxes", 1, "--robot", "none", "--numbers", "cup_axial,cup_bend")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("all found", done.stdout)

    def test_the_misfit_of_a_run_through_an_arm_is_noise_at_the_truth(self):
        done = self.run_tool("--seed", 3, "--count", 1, "--boxes", 1, "--robot", "ur10", "--evaluate")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
