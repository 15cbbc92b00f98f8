#!/usr/bin/env python3
"""pictures.py: draws the pictures of README and the documents that show runs and pages, from runs of today's program, into docs/img.

  pictures.py [NAME ...]     all of them, some minutes; needs Debian's chromium

Names: report, kitchen, validation, packed-sequence-2, places, identified."""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CHROMIUM = os.environ.get("SNUG_CHROMIUM", "/usr/bin/chromium")
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
# Of each run: words of pack.
RUNS = {
    "first": ("--sequence", "1", "--plant-seed", "4"),  # the tutorial's first run
    "kitchen": ("--items", ROOT / "scenarios" / "orders-example.csv", "--sequence", "kitchen", "--samples", "0"),
    "second": ("--sequence", "2", "--plant-seed", "1", "--samples", "0"),
}


def snug(folder, *words):
    done = subprocess.run([SNUG, *map(str, words)], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):  # 1: it ran, and something did not go as it should
        raise SystemExit(f"pictures.py: snug {' '.join(map(str, words))}:\n{done.stderr}")


def recording(folder, name):
    """The file of a run in the folder; packed where it is not there yet."""
    file = folder / f"{name}.h5"
    if not file.exists():
        snug(folder, "pack", CELL, *RUNS[name], "-o", file)
    return file


def photograph(page, picture, size):
    """A page as Chromium shows it, without a graphics card."""
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run([CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--hide-scrollbars",
                               f"--user-data-dir={profile}", f"--window-size={size}", "--virtual-time-budget=15000", f"--screenshot={picture}", page],
                              capture_output=True, text=True, check=False)
    if done.returncode != 0 or not Path(picture).exists():
        raise SystemExit(f"pictures.py: chromium drew nothing of {page}:\n{done.stderr[-2000:]}")


def report(folder, picture, name="first", time=30):
    snug(folder, "report", recording(folder, name), "-o", "page.html")
    photograph(f"file://{folder}/page.html#t={time}", picture, "1280,720")


def kitchen(folder, picture):
    report(folder, picture, "kitchen", 40)


def validation(folder, picture):
    run = recording(folder, "first")
    snug(folder, "measure", run, "--sensors", ROOT / "scenarios" / "sensors" / "demonstrator.yaml", "--repetitions", "2", "-o", "measured.h5")
    snug(folder, "validate", "--simulated", run, "--measured", "measured.h5", "-o", "validation.html")
    photograph(f"file://{folder}/validation.html", picture, "1100,800")


def packed_sequence_2(folder, picture):
    snug(folder, "picture", recording(folder, "second"), "--camera", "top", "--size", "700x520", "-o", picture)


def places(folder, picture):
    arm = ROOT / "scenarios" / "robots" / "ur5e.urdf"
    snug(folder, "init", "cell", "cell")
    snug(folder, "cell", "place", "cell/cell.yaml", "--arm", arm, "-o", "cell/placed.yaml", "--page", "places.html")
    photograph(f"file://{folder}/places.html", picture, "1180,1100")


def identified(folder, picture):
    """The shipped tosses, with two numbers of the task far from the truth and all others fixed."""
    shutil.copytree(ROOT / "scenarios" / "tosses", folder / "tosses")
    task = folder / "tosses" / "task.yaml"
    lines = []
    for line in task.read_text(encoding="utf-8").splitlines():
        name = re.search(r"\{name: (\w+)", line)
        if name and name[1] in ("friction", "edge_friction"):
            line = re.sub(r" value: [\d.]+", " value: 0.3", line)
        elif name:
            line = line.replace("{name:", "{fixed: true, name:")
        lines.append(line)
    task.write_text("\n".join(lines) + "\n", encoding="utf-8")
    snug(folder, "identify", "scene", task, "--local", "60", "--page", "identified.html")
    photograph(f"file://{folder}/identified.html", picture, "1100,700")


PICTURES = {"report": report, "kitchen": kitchen, "validation": validation, "packed-sequence-2": packed_sequence_2, "places": places,
            "identified": identified}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="of " + ", ".join(PICTURES))
    words = parser.parse_args()
    if unknown := [name for name in words.names if name not in PICTURES]:
        parser.error(f"got '{unknown[0]}'; expected {', '.join(PICTURES)}")
    with tempfile.TemporaryDirectory() as folder:
        for name in words.names or PICTURES:
            drawn = Path(folder) / f"{name}.png"
            PICTURES[name](Path(folder), drawn)
            (ROOT / "docs" / "img" / f"{name}.png").write_bytes(drawn.read_bytes())
            print(f"docs/img/{name}.png", flush=True)


if __name__ == "__main__":
    sys.exit(main())
