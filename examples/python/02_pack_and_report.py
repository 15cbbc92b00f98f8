"""Packs a sequence and opens the report of the run. Words: scenario, sequence, page to write
(box-demonstrator, 1, run.html)."""
import os
import sys
import webbrowser
import snug

scenario, sequence, page = sys.argv[1:4] or ("box-demonstrator", "1", "run.html")
result = snug.pack(snug.load_scenario(scenario), sequence, agent="margin", samples=0, robot="none", record="run.h5")
print(f"{result.executed_boxes} boxes, {result.executed_percent:.1f} % of the container")
path = snug.report("run.h5", page).resolve()
if "DISPLAY" in os.environ:
    webbrowser.open(path.as_uri())
