#!/usr/bin/env python3
"""figures.py: makes the numbers that README and the documents state, and writes them where they stand: between `<!-- figures: NAME -->` and
`<!-- end -->`.

  figures.py                 all of them: an hour on two cores; a second call goes on where one was ended
  figures.py NAME ...        these
  figures.py --check NAME    nothing is written: exit code 1 where a document says something else

Names: first-run, sessions, acceptance, bench, ur, ur-frames. `acceptance` needs the demonstrator's own programs (--programs FOLDER). The same commit gives the same text on
every machine; beneath each table stands the commit that last changed the program, and what it was made on."""
import argparse
import functools
import json
import os
import platform
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SCENARIO = "scenarios/box-demonstrator.yaml"
SEQUENCES = ("1", "2", "3", "4", "5")
PLANTS = 6
TUTORIAL = ["--sequence", "1", "--plant-seed", "4"]  # the command of its first run
# Boxes that the report's robot and its people packed of each sequence (report, Tables 1 and 2), and their share of the container, %, as `compare` counts it.
REPORTED = {"the report's robot, programmed by hand": ((12, 74.22), (12, 66.14), (13, 68.69), (14, 66.70), (12, 66.66)),
            "the report's people, by hand": ((12, 74.22), (12, 66.14), (13, 68.69), (15, 73.79), (14, 76.41))}


class CannotMake(Exception):
    """Why a figure cannot be made here."""


def run(words, *more):
    done = subprocess.run([*map(str, words), *map(str, more)], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode not in (0, 1) or not done.stdout:  # 1: it ran, and the robot could not do all
        raise CannotMake(f"{' '.join(map(str, words))}: exit code {done.returncode}")
    return done.stdout


@functools.cache  # of the program that the figures were begun with
def commit():
    """The last one that changed the program or what it reads."""
    done = subprocess.run(["git", "log", "-1", "--format=%h", "--", "src", "apps", "scenarios"], cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"


def origin(what):
    """What a table was made from, on what."""
    return f"*{what}; commit {commit()}, {platform.machine().replace('_', '-')}, {os.cpu_count()} cores (`make figures`).*"


def mean_and_range(values, unit=""):
    return f"{statistics.mean(values):.1f}{unit} ({min(values):.1f} to {max(values):.1f})"


def mean_of(cells):
    return f"{statistics.mean(percent for _, percent in cells) + 1e-9:.1f}"  # a half is rounded up


# ---- figures: each gives the texts of its blocks

def first_run(words):
    """The first session of the tutorial."""
    result = json.loads(run([words.snug, "pack", SCENARIO, *TUTORIAL, "--json"]))
    return {"first-run": f"{result['executed_boxes']} boxes fill {result['executed_percent']:.2f} %."}


def sessions(words):
    """Thirty sessions: five sequences in six plants."""
    kept = words.folder / f"sessions-{commit()}"
    rows = json.loads(run([words.snug, "compare", SCENARIO, "--agents", "contact-aware", "--plants", PLANTS, "--dir", kept, "--json"]))["rows"]
    if broken := [row for row in rows if row["failure"]]:
        raise CannotMake(f"sessions: {len(broken)} of {len(rows)} broke off")
    by_sequence = {name: [row for row in rows if row["sequence"] == name] for name in SEQUENCES}
    filled = [row["executed_percent"] for row in rows]
    before = [row["percent_before_skips"] for row in rows]
    hours = [row["boxes_per_hour"] for row in rows]
    sent, planned, lost = (sum(row[key] for row in rows) for key in ("items_sent", "items_as_planned", "boxes_lost"))
    robot, people = (mean_of(cells) for cells in REPORTED.values())
    what = f"n = {len(rows)}: plants 1 to {PLANTS}, planner seed 1"
    short = [
        "| five sequences | filling, mean (lowest to highest) | boxes an hour |", "|---|---|---|",
        f"| people, by hand (the report) | {people} % | |",
        f"| robot, programmed by hand (the report) | {robot} % | |",
        f"| snug, stopped at the first box that does not fit | {mean_and_range(before, ' %')} | |",
        f"| snug, may leave out two boxes | {mean_and_range(filled, ' %')} | {statistics.mean(hours):.0f} |", "",
        f"Of {sent} boxes that the robot moved to a place {planned} ended as planned; {'none was' if lost == 0 else f'{lost} were'} lost.", "", origin(what)]

    def line(name, cells):
        return f"| {name} | " + " | ".join(cells) + " |"

    first = [by_sequence[name][0] for name in SEQUENCES]
    long = [
        line("boxes / % of the container", [*(f"S{name}" for name in SEQUENCES), "mean (lowest to highest)"]), "|---" * (len(SEQUENCES) + 2) + "|",
        line("snug, six plants", [mean_and_range([row["executed_percent"] for row in by_sequence[name]]) for name in SEQUENCES] + [mean_and_range(filled)]),
        line("snug, plant 1", [f"{row['executed_boxes']} / {row['executed_percent']:.1f}" for row in first]
             + [mean_and_range([row["executed_percent"] for row in first])]),
        line("snug, six plants, stopped at the first box that does not fit",
             [mean_and_range([row["percent_before_skips"] for row in by_sequence[name]]) for name in SEQUENCES] + [mean_and_range(before)]),
        *(line(who, [f"{boxes} / {percent:.1f}" for boxes, percent in cells] + [mean_of(cells)])
          for who, cells in REPORTED.items()), "",
        f"Standard deviation over the {len(rows)} sessions {statistics.stdev(filled):.1f} points, {statistics.mean(hours):.0f} boxes an hour "
        f"({min(hours):.0f} to {max(hours):.0f}) without the time in which the robot waits for a plan. Of {sent} boxes that were sent {planned} ended as "
        f"planned, {'none was' if lost == 0 else f'{lost} were'} lost, {sum(row['recoveries'] for row in rows)} times the robot recovered.", "", origin(what)]
    by_plant = [
        line("% of the container", [*(f"S{name}" for name in SEQUENCES), "mean"]), "|---" * (len(SEQUENCES) + 2) + "|",
        *(line(f"plant {plant}", [f"{percent:.2f}" for percent in cells] + [f"{statistics.mean(cells):.2f}"]) for plant, cells in (
            (plant, [row["executed_percent"] for name in SEQUENCES for row in by_sequence[name] if row["plant_seed"] == plant])
            for plant in range(1, PLANTS + 1))),
        line("mean of the plants", [f"{statistics.mean(row['executed_percent'] for row in by_sequence[name]):.2f}" for name in SEQUENCES]
             + [f"{statistics.mean(filled):.2f}"]),
        line("before the first item was skipped, mean", [f"{statistics.mean(row['percent_before_skips'] for row in by_sequence[name]):.2f}" for name in SEQUENCES]
             + [f"{statistics.mean(before):.2f}"]),
        *(line(who, [f"{percent:.2f}" for _, percent in cells] + [mean_of(cells)]) for who, cells in REPORTED.items()), "", origin(what)]
    return {"sessions": "\n".join(short), "sessions-by-sequence": "\n".join(long), "sessions-by-plant": "\n".join(by_plant)}


def acceptance(words):
    """The demonstrator's own programs."""
    if not words.programs.is_dir():
        raise CannotMake(f"acceptance: there is no folder '{words.programs}' with the demonstrator's own programs (--programs)")
    table = run([sys.executable, ROOT / "tools" / "acceptance.py", words.programs]).rstrip()
    return {"acceptance": table + "\n\n" + origin("one run of each program")}


def bench(words):
    """How accurate the physics is on scenes with a known answer; speeds depend on the machine and are not among them."""
    value = {row["name"]: row["value"] for row in json.loads(run([words.snug, "bench", "s", "--json"]))["results"]}
    slides = max(value[f"s3.{heading}.error_percent"] for heading in (0, 22, 45))
    rows = (
        ("14 stacked boxes, 10 s, all awake: deepest overlap; drift", f"{value['s1.awake.penetration_mm']:.4f} mm; {value['s1.awake.drift_mm']:.4f} mm", "0.01 mm; 0.001 mm"),
        ("12 boxes dropped at random, five seeds: deepest overlap", f"{value['s2.worst_penetration_mm']:.2f} mm", "1 mm"),
        ("distance of a sliding box, at 0, 22.5 and 45 degrees", f"{slides:.4f} % off", "0.05 %"),
        ("height of a rebound", f"{value['s4.error_percent']:.3f} % off", "0.5 %"),
        ("tilted insertion into a gap that is 5 mm too narrow", f"{'in' if value['s6b.completes'] == 1 else 'not in'}, with {value['s6b.peak_force_N']:.0f} N", "70 N"))
    return {"bench": "\n".join(["| scene | snug | target |", "|---|---|---|", *(f"| {' | '.join(cells)} |" for cells in rows), "", origin("`snug bench`")])}


UR_PACK = ["--samples", "0", "--decision-time", "0.2"]
UR_PLANTS = (1, 2, 3)


def serve_ur(words, sequence, plant, boxes):
    """A served UR at ports that are free; its process, and what is added to its ports."""
    for offset in range(4000, 9000, 100):
        served = subprocess.Popen([str(words.snug), "serve", SCENARIO, "--sequence", sequence, "--plant-seed", str(plant), "--ur", "127.0.0.1",
                                   "--ur-port-offset", str(offset), "--observers", boxes], cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        said = served.stderr.readline()
        if "serving" in said:
            return served, offset
        served.wait()
    raise CannotMake(f"no served UR: {said}")


def pack_through_ur(words, sequence, plant, perception):
    """A session in lockstep, the cell in a process of its own; with frames the camera, too."""
    with tempfile.TemporaryDirectory() as folder:
        boxes = f"ipc://{folder}/boxes"
        served, offset = serve_ur(words, sequence, plant, boxes)
        threading.Thread(target=served.stderr.read, daemon=True).start()
        camera = f"{words.snug} camera {SCENARIO} --click {boxes} --sequence {sequence} --seed {plant} --shot {{look}} -o {{frame}}.h5"
        frames = ["--frames", camera] if perception == "frames" else []
        try:
            return json.loads(run([words.snug, "pack", SCENARIO, "--sequence", sequence, "--plant-seed", plant, *UR_PACK, "--plant", f"ur://127.0.0.1:{offset}",
                                   "--observe", boxes, "--lockstep", "--perception", perception, *frames, "--json"]))
        finally:
            served.send_signal(signal.SIGINT)
            served.wait()


def ur_row(words, kept, how, sequence, plant):
    """How one session came out: made once for each commit."""
    key = f"{how} {sequence} {plant}"
    rows = json.loads(kept.read_text()) if kept.exists() else {}
    if key not in rows:
        inside = ["--perception", how.split()[1], "--json"]
        result = (json.loads(run([words.snug, "pack", SCENARIO, "--sequence", sequence, "--plant-seed", plant, *UR_PACK, *inside])) if how.startswith("inside")
                  else pack_through_ur(words, sequence, plant, how.split()[1]))
        if result["failure"]:
            raise CannotMake(f"{key}: {result['failure']}")
        rows[key] = {name: result[name] for name in ("executed_percent", "executed_boxes", "items_sent", "items_as_planned", "boxes_lost")}
        kept.write_text(json.dumps(rows))
    return rows[key]


def ur_table(words, perceptions, plants, sequences):
    """`perceptions`: of the cell in one process, and through a UR."""
    kept = words.folder / f"ur-{commit()}.json"
    hows = (f"inside {perceptions[0]}", f"ur {perceptions[1]}")
    rows = {(how, name, plant): ur_row(words, kept, how, name, plant) for plant in plants for name in sequences for how in hows}
    lines = ["| % of the container | " + " | ".join(f"S{name}" for name in sequences) + " | mean |", "|---" * (len(sequences) + 2) + "|"]
    for plant in plants:
        for how, label in zip(hows, ("in one process", "through the UR")):
            cells = [rows[how, name, plant]["executed_percent"] for name in sequences]
            lines.append(f"| plant {plant}, {label} | " + " | ".join(f"{percent:.2f}" for percent in cells) + f" | {statistics.mean(cells):.2f} |")
    inside, through = ([row["executed_percent"] for key, row in rows.items() if key[0] == how] for how in hows)
    ur = [row for key, row in rows.items() if key[0] == hows[1]]
    sent, planned, lost = (sum(row[key] for row in ur) for key in ("items_sent", "items_as_planned", "boxes_lost"))
    inside_sent, inside_planned = (sum(row[key] for key_, row in rows.items() if key_[0] == hows[0]) for key in ("items_sent", "items_as_planned"))
    lines += ["", f"Through the UR {statistics.mean(through) - statistics.mean(inside):+.2f} points on average. Of {sent} boxes that were sent {planned} ended as planned "
              f"({100.0 * planned / sent:.1f} %; in one process {inside_planned} of {inside_sent}); {'none was' if lost == 0 else f'{lost} were'} lost.", "",
              origin(f"n = {len(ur)} sessions in lockstep, a served UR10, `{' '.join(UR_PACK)}`")]
    return "\n".join(lines)


def ur(words):
    """Sessions through a served UR beside those of the same plants in one process."""
    return {"ur": ur_table(words, ("exact", "exact"), UR_PLANTS, SEQUENCES)}


def ur_frames(words):
    """The same with a camera that is a program of its own and sees the robot, beside the simulated camera in one process, with the same errors."""
    return {"ur-frames": ur_table(words, ("camera", "frames"), (1, 2), SEQUENCES)}


MAKERS = {"first-run": first_run, "sessions": sessions, "acceptance": acceptance, "bench": bench, "ur": ur, "ur-frames": ur_frames}


# ---- documents

BLOCK = re.compile(r"(<!-- figures: ([\w-]+) -->)(.*?)(<!-- end -->)", re.S)


def documents():
    return [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def without_origin(text):
    return re.sub(r"; commit \S+ .*?\(`make figures`\)", "", text)


def put(texts, is_check):
    """Writes the blocks; what differs, as lines."""
    different, found = [], set()
    for path in documents():
        def replace(match, path=path):
            name = match[2]
            if name not in texts:
                return match[0]
            found.add(name)
            old = match[3]
            new = f"\n{texts[name]}\n" if "\n" in texts[name] else texts[name]
            if without_origin(old).strip() != without_origin(new).strip():
                different.append(f"{path.relative_to(ROOT)}: {name}: stands:\n{old.strip()}\nmade:\n{new.strip()}")
            return match[1] + new + match[4]
        text = path.read_text(encoding="utf-8")
        changed = BLOCK.sub(replace, text)
        if not is_check and changed != text:
            beside = path.with_name(path.name + ".new")
            beside.write_text(changed, encoding="utf-8")
            beside.rename(path)
    if missing := set(texts) - found:
        raise CannotMake(f"no document has a block <!-- figures: {sorted(missing)[0]} -->")
    return different


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--check", action="store_true", help="write nothing, exit code 1 where something differs")
    parser.add_argument("--snug", type=Path, default=ROOT / "build" / "snug", help="the program (default: build/snug)")
    parser.add_argument("--programs", type=Path, default=ROOT.parent / "shared" / "data" / "waypoints", help="folder of the demonstrator's programs")
    parser.add_argument("--folder", type=Path, default=ROOT / "build" / "figures", help="where rows are kept (default: build/figures)")
    words = parser.parse_args()
    if unknown := [name for name in words.names if name not in MAKERS]:
        parser.error(f"got '{unknown[0]}'; expected {', '.join(MAKERS)}")
    words.folder.mkdir(parents=True, exist_ok=True)
    code = 0
    for name in words.names or MAKERS:
        try:
            different = put(MAKERS[name](words), words.check)
        except CannotMake as why:
            print(f"figures.py: {why}", file=sys.stderr)
            code = 2
            continue
        print(f"{name}: {'as it stands' if not different else 'differs' if words.check else 'written'}", flush=True)
        if words.check and different:
            print("\n".join(different))
            code = code or 1
    sys.exit(code)


if __name__ == "__main__":
    main()
