#!/usr/bin/env python3
"""theory_pictures_test.py: the computed pictures of docs/theory are those of tools/theory_pictures.py, and what they draw of the
cup's rest is what snug computes."""
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TOOLS = ROOT / "tools"
sys.path.insert(0, str(TOOLS))
from theory import cup  # noqa: E402

NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
# Pixels: another mathematical library may round a coordinate to the next tenth.
ROUNDING = 0.11


class TheoryPictures(unittest.TestCase):
    def test_those_of_the_documents_are_those_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, "-B", TOOLS / "theory_pictures.py", "--folder", folder], check=True, capture_output=True)
            drawn = sorted(Path(folder).glob("*.svg"))
            self.assertGreater(len(drawn), 10)
            for picture in drawn:
                with self.subTest(picture.name):
                    new, old = picture.read_text(), (ROOT / "docs" / "img" / picture.name).read_text()
                    self.assertEqual(NUMBER.sub("0", new), NUMBER.sub("0", old), "draw it again: make curves")
                    for a, b in zip(NUMBER.findall(new), NUMBER.findall(old)):
                        self.assertAlmostEqual(float(a), float(b), delta=ROUNDING, msg="draw it again: make curves")

    def test_bends_are_those_that_snug_computes(self):
        cases = [(3.0, 1.75, 60), (5.0, 1.75, 60), (10.0, 1.75, 60), (5.0, 2.5, 150), (3.0, 2.5, 150)]
        lines = []
        for bend, mass, tilt in cases:
            c, s = math.cos(math.radians(tilt)), math.sin(math.radians(tilt))
            K = [[value if i == j else 0.0 for j in range(6)] for i, value in enumerate((2500.0, 2500.0, 6000.0, bend, bend, 3.0))]
            at = {"R": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "o": [0.0, 0.0, 0.025]}
            lines.append(json.dumps({"id": tilt, "W_R_E": [[c, 0.0, -s], [0.0, -1.0, 0.0], [-s, 0.0, -c]], "mass": mass, "com_S": [0.0, 0.0, 0.06], "K": K,
                                     "E_H_S2": at, "S_H_S1": {"R": at["R"], "o": [0.0, 0.0, -0.025]}}))
        done = subprocess.run([os.environ["SNUG"], "cup", "settle", "-"], input="\n".join(lines) + "\n", capture_output=True, text=True, check=False)
        answers = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual(len(answers), len(cases), done.stderr)
        for (bend, mass, tilt), answer in zip(cases[:4], answers):
            # 1e-9 degrees: both end at 1e-12 of the load or at rounding, stiffness times 1e-12 m or rad.
            plane = cup.Plane(bend, mass, tilt)
            fraction = 0.0
            motion = (0.0, 0.0, 0.0)
            while fraction < 1.0:
                fraction += 0.125
                motion = plane.settle(motion, fraction)[0]
            self.assertEqual(answer["status"], "converged")
            self.assertAlmostEqual(answer["bend_deg"], abs(math.degrees(motion[2])), delta=1e-9)
        # The branch that ends at a fold: there is no rest under the whole load.
        self.assertEqual(answers[4]["status"], "beyond_capacity")
        # 1e-4: the picture's branch has a point each half degree (2e-5 of gravity at the fold), snug stops within 3e-5.
        fold = max(fraction for fraction, _ in cup.Plane(*cases[4]).branch())
        self.assertAlmostEqual(answers[4]["load_fraction"], fold, delta=1e-4)


if __name__ == "__main__":
    unittest.main()
