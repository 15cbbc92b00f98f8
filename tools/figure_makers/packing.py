"""Tables of packing sessions, and of programs and loads that are packed."""
import json
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from figure_makers.common import ROOT, SCENARIO, SEQUENCES, CannotMake, bench, commit, origin, others, run, table, timed, with_origin

PLANTS = 6
TUTORIAL = ["--sequence", "1", "--plant-seed", "4"]  # the command of its first run
# Boxes that the report's robot and its people packed of each sequence (report, Tables 1 and 2), and their share of the container, %, as `compare` counts it.
REPORTED = {"the report's robot, programmed by hand": ((12, 74.22), (12, 66.14), (13, 68.69), (14, 66.70), (12, 66.66)),
            "the report's people, by hand": ((12, 74.22), (12, 66.14), (13, 68.69), (15, 73.79), (14, 76.41))}


def mean_and_range(values, unit=""):
    return f"{statistics.mean(values):.1f}{unit} ({min(values):.1f} to {max(values):.1f})"


def mean_of(cells):
    return f"{statistics.mean(percent for _, percent in cells) + 1e-9:.1f}"  # a half is rounded up



def first_run(words):
    """The first session of the tutorial."""
    result = json.loads(run([words.snug, "pack", SCENARIO, *TUTORIAL, "--json"]))
    return {"first-run": f"{result['executed_boxes']} boxes fill {result['executed_percent']:.2f} %."}


def compared(words, skips):
    """Thirty sessions that may leave out so many boxes; kept for each commit."""
    kept = words.folder / f"sessions-{skips}-{commit()}"
    rows = json.loads(run([words.snug, "compare", SCENARIO, "--agents", "contact-aware", "--plants", PLANTS, "--skips", skips, "--dir", kept, "--json"]))["rows"]
    if broken := [row for row in rows if row["failure"]]:
        raise CannotMake(f"sessions: {len(broken)} of {len(rows)} broke off")
    return rows


def sessions(words):
    """Five sequences in six plants, once by the report's rule and once with two skips."""
    rows, strict_rows = (compared(words, skips) for skips in (2, 0))
    by_sequence, strict_by_sequence = ({name: [row for row in some if row["sequence"] == name] for name in SEQUENCES} for some in (rows, strict_rows))
    filled, strict = ([row["executed_percent"] for row in some] for some in (rows, strict_rows))
    hours = [row["boxes_per_hour"] for row in rows]
    sent, planned, lost = (sum(row[key] for row in rows) for key in ("items_sent", "items_as_planned", "boxes_lost"))
    robot, people = (mean_of(cells) for cells in REPORTED.values())
    what = f"n = {len(rows)}: plants 1 to {PLANTS}, planner seed 1"
    short = [
        "| five sequences | filling, mean (lowest to highest) | boxes an hour |", "|---|---|---|",
        f"| people, by hand (the report) | {people} % | |",
        f"| robot, programmed by hand (the report) | {robot} % | |",
        f"| snug, stopped at the first box that does not fit | {mean_and_range(strict, ' %')} | |",
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
             [mean_and_range([row["executed_percent"] for row in strict_by_sequence[name]]) for name in SEQUENCES] + [mean_and_range(strict)]),
        *(line(who, [f"{boxes} / {percent:.1f}" for boxes, percent in cells] + [mean_of(cells)])
          for who, cells in REPORTED.items()), "",
        f"Standard deviation over the {len(rows)} sessions {statistics.stdev(filled):.1f} points, {statistics.mean(hours):.0f} boxes an hour "
        f"({min(hours):.0f} to {max(hours):.0f}) without the time in which the robot waits for a plan. Of {sent} boxes that were sent {planned} ended as "
        f"planned, {'none was' if lost == 0 else f'{lost} were'} lost, recoveries: {sum(row['recoveries'] for row in rows)}. Of those stopped at the first box that "
        f"does not fit (`--skips 0`), {sum(row['items_as_planned'] for row in strict_rows)} of {sum(row['items_sent'] for row in strict_rows)} ended as planned.", "", origin(what)]
    by_plant = [
        line("% of the container", [*(f"S{name}" for name in SEQUENCES), "mean"]), "|---" * (len(SEQUENCES) + 2) + "|",
        *(line(f"plant {plant}", [f"{percent:.2f}" for percent in cells] + [f"{statistics.mean(cells):.2f}"]) for plant, cells in (
            (plant, [row["executed_percent"] for name in SEQUENCES for row in by_sequence[name] if row["plant_seed"] == plant])
            for plant in range(1, PLANTS + 1))),
        line("mean of the plants", [f"{statistics.mean(row['executed_percent'] for row in by_sequence[name]):.2f}" for name in SEQUENCES]
             + [f"{statistics.mean(filled):.2f}"]),
        line("stopped at the first box that does not fit, mean", [f"{statistics.mean(row['executed_percent'] for row in strict_by_sequence[name]):.2f}" for name in SEQUENCES]
             + [f"{statistics.mean(strict):.2f}"]),
        *(line(who, [f"{percent:.2f}" for _, percent in cells] + [mean_of(cells)]) for who, cells in REPORTED.items()), "", origin(what)]
    return {"sessions": "\n".join(short), "sessions-by-sequence": "\n".join(long), "sessions-by-plant": "\n".join(by_plant)}


def acceptance(words):
    """The demonstrator's own programs."""
    if not words.programs.is_dir():
        raise CannotMake(f"acceptance: there is no folder '{words.programs}' with the demonstrator's own programs (--programs)")
    return {"acceptance": with_origin(run([sys.executable, ROOT / "tools" / "acceptance.py", words.programs]).rstrip(), "one run of each program")}


LOADED = {"sets": tuple(f"BR{number}" for number in range(1, 8)), "first": 10, "time": 30}


def loading(words):
    """Bischoff and Ratcliff's instances by geometry alone: half an hour on one core. What was loaded is kept for each commit."""
    kept = words.folder / f"loading-{commit()}.json"
    filled = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
    for name in LOADED["sets"]:
        if name not in filled:
            filled[name] = json.loads(run([words.snug, "load", others(words, f"packing/{name}.txt"), "--first", LOADED["first"], "--time", LOADED["time"], "--threads", "2",
                                           "--json"]))["mean_percent"]
            kept.write_text(json.dumps(filled), encoding="utf-8")
    return {"loading": with_origin(table((*LOADED["sets"], "mean"), (*(f"{filled[name]:.1f}" for name in LOADED["sets"]),
                                                                     f"{statistics.mean(filled[name] for name in LOADED['sets']):.1f} %")),
                                   f"`snug load BRn.txt --first {LOADED['first']} --time {LOADED['time']}`, % of the container")}


def planning(words):
    """How long deciding and planning a motion take, and what is planned."""
    value = bench(words, "packing.decision") | bench(words, "packing.motion")
    return {"planning": timed(table(
        ("one core", "median", "longest", "target (median)"),
        ("a decision of `contact-aware` in the five sequences, default decision time", f"{value['packing.decision.median_s']:.2f} s", f"{value['packing.decision.longest_s']:.1f} s",
         "2 s"),
        (f"one motion, not rehearsed: waypoints, reach of the joints, timing within their limits ({value['packing.motion.count']:.0f} motions)",
         f"{1e3 * value['packing.motion.median_s']:.1f} ms", f"{1e3 * value['packing.motion.longest_s']:.1f} ms", "100 ms"))
        + f"\n\nThe decisions, planned only, fill {value['packing.decision.planned_percent']:.1f} % on average.", "`snug bench packing`, processor time")}


def mcap(words):
    """How large a recording is as MCAP."""
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        session = json.loads(run([words.snug, "pack", SCENARIO, *TUTORIAL, "-o", folder / "run.h5", "--json"]))
        for encoding in ("protobuf", "json"):
            cells, seconds = [], 0.0
            for compression in ("zstd", "none"):
                before = resource.getrusage(resource.RUSAGE_CHILDREN)
                subprocess.run([words.snug, "export", folder / "run.h5", "--format", "mcap", "--encoding", encoding, "--compression", compression, "-o", folder / "run.mcap"],
                               cwd=ROOT, check=True, capture_output=True)
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                cells.append(f"{(folder / 'run.mcap').stat().st_size / 1e6:.1f} MB")
                seconds = seconds or after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
                (folder / "run.mcap").unlink()
            rows.append((encoding, *cells, f"{seconds:.1f} s"))
        size = (folder / "run.h5").stat().st_size / 1e6
    return {"mcap": timed(table(("`--encoding`", "packed with zstd", "`--compression none`", "processor time, packed"), *rows),
                          f"the first session of the tutorial, {session['duration']:.0f} s, {size:.1f} MB as HDF5")}


def tempo(words):
    """Cycle time and hold of the cup against the tempo: half an hour."""
    command = [sys.executable, ROOT / "tools" / "tempo_curve.py", "--snug", words.snug, "--plant-seed", "7"]
    slow = run(command + ["--tempos", "0.5,0.75,1", "--set", "robot.velocity_fraction=0.5"]).splitlines()
    fast = run(command + ["--tempos", "0.5,1"]).splitlines()
    rows = [f"| {fraction}, {line[2:]}" for fraction, lines in (("0.5", slow[2:]), ("0.97", fast[2:])) for line in lines]
    return {"tempo": timed("\n".join([f"| `velocity_fraction`, {slow[0][2:]}", slow[1], *rows]), "five sequences in plant 7, no samples, `tools/tempo_curve.py`")}


MAKERS = {"first-run": first_run, "sessions": sessions, "acceptance": acceptance, "loading": loading, "planning": planning, "mcap": mcap, "tempo": tempo}
