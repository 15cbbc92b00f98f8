#!/usr/bin/env python3
"""charts_test.py: charts and curves in docs/img are those that tools/charts.py draws from the tables beside them and from data."""
import re
import sys
import unittest
import xml.etree.ElementTree as xml
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True
import charts  # noqa: E402


NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-\d+)?")
ROUNDING = 0.11  # pixels: another mathematical library may round a coordinate to the next tenth


class Charts(unittest.TestCase):
    def test_of_documents_are_those_of_their_tables(self):
        for name, draw in charts.CHARTS.items():
            with self.subTest(name):
                stands, drawn = (ROOT / "docs" / "img" / f"{name}.svg").read_text(encoding="utf-8"), draw()
                why = f"/usr/bin/python3 tools/charts.py {name}"
                self.assertEqual(NUMBER.sub("", stands), NUMBER.sub("", drawn), why)
                for one, other in zip(NUMBER.findall(stands), NUMBER.findall(drawn), strict=True):
                    self.assertAlmostEqual(float(one), float(other), delta=ROUNDING, msg=why)

    def test_are_well_formed_and_say_what_they_show(self):
        for name, draw in charts.CHARTS.items():
            root = xml.fromstring(draw())
            self.assertTrue(root.find("{http://www.w3.org/2000/svg}title").text, name)

    def test_draw_a_number_where_the_scale_has_it(self):
        svg = charts.ranges("a", [("one", [(60.0, 70.0, 80.0, charts.BLUE)])], [60, 80], "%", left=200)
        self.assertIn('<circle cx="500"', svg)
        self.assertIn('x1="200" y1="56" x2="800" y2="56"', svg)

    def test_know_a_table_by_its_section(self):
        table = charts.tables("packing-results.md", "Faults")[0]
        self.assertEqual(table[0][0], "fault")
        self.assertNotIn("---", table[1][0])
        with self.assertRaisesRegex(SystemExit, "no section 'None'"):
            charts.tables("packing-results.md", "None")


if __name__ == "__main__":
    unittest.main()
