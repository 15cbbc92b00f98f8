#!/usr/bin/env python3
"""served_cell.py: what a cell served over CLICK costs, beside its targets: round trips, a whole program, real time.

Words: [PROGRAM.csv (default: one that `snug pack` makes)] [--sequence 1] [--corrections none]
[--cup holding (of one that `snug pack` makes: phases)] [--minutes 10]. The program is done
by `snug simulate --robot` and by `snug control` over CLICK: state hash and boxes have to be the same. For `--minutes` a controller
sends commands at 125 Hz to `serve --async`, while the other core is kept busy. Run it with /usr/bin/python3 (python3-zmq,
python3-protobuf) on a machine that does nothing else, real time under `chrt -f 10`. SNUG names the program (default: build/snug).
Exit code: 1 when the hashes differ."""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))
from click_test import CELL, SNUG, STILL, Peer, Served  # noqa: E402

TICK = 0.008  # s


def row(name, value, unit, target):
    print(f"{name:<52} {value:>9.4g} {unit:<8} {target}", flush=True)


def answer_of(*words, codes=(0,)):
    result = subprocess.run([SNUG, *map(str, words), "--json"], capture_output=True, text=True, check=False)
    if result.returncode not in codes:
        sys.exit(f"served_cell.py: snug {words[0]}: {result.stderr or result.stdout}")
    return json.loads(result.stdout)


def round_trips():
    for figure in answer_of("bench", "click", codes=(0, 1))["results"]:  # 1: a figure missed its target
        row(figure["name"], figure["value"], figure["unit"], figure["target"])


def packed(result):
    return sum(box["state"] == "packed" for box in result["boxes"])


def whole_program(program, sequence, corrections, cup):
    """True when the run over CLICK ended in the state of the run in one process."""
    words = ["--sequence", sequence, "--corrections", corrections]
    here = answer_of("simulate", CELL, "--program", program, *words, "--robot", "ur10", "--cup", cup)
    with tempfile.TemporaryDirectory() as folder:
        endpoint = f"ipc://{folder}/cell"
        with Served("--sequence", sequence, "--cup", cup, "--json", endpoint=endpoint) as served:
            start = time.monotonic()
            answer_of("control", program, *words, "--click", endpoint)
            took = time.monotonic() - start
            served.end()
    there = json.loads(served.stdout)
    row("program over CLICK, simulated s a second", here["duration_s"] / took, "x", ">= 50")
    row("  boxes packed over CLICK", packed(there), f"(and {packed(here)})", "the same as in one process")
    is_same = there["state_hash"] == here["state_hash"]
    print(f"  state hash {there['state_hash']} / {here['state_hash']}: {'the same' if is_same else 'NOT the same'}")
    return is_same


def real_time(minutes):
    busy = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    try:
        with Served("--async") as served, Peer(served.endpoint) as peer:
            def resident():
                status = Path(f"/proc/{served.process.pid}/status").read_text()
                return int(status.split("VmRSS:")[1].split()[0]) / 1024.0

            peer.handshake()
            end = time.monotonic() + 60.0 * minutes
            early = time.monotonic() + min(30.0, 15.0 * minutes)
            first = None
            while time.monotonic() < end:
                peer.control(STILL)
                if first is None and time.monotonic() > early:
                    first = resident()
                time.sleep(TICK)
            last = resident()
            served.end()
    finally:
        busy.kill()
    line = next(line for line in served.said if "real time:" in line)
    print("  " + line.strip())
    late = float(line.split("(median), ")[1].split()[0]) / 1e3
    row(f"real time, {minutes:g} minutes: 99 % of steps late by less", late, "ms", "<= 1")
    row("  memory at the end (after half a minute)", last, f"({first:.1f}) MB", "flat")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?")
    parser.add_argument("--sequence", default="1")
    parser.add_argument("--corrections", default="none")
    parser.add_argument("--cup", choices=("holding", "phases"))
    parser.add_argument("--minutes", type=float, default=10.0)
    words = parser.parse_args()
    round_trips()
    with tempfile.TemporaryDirectory() as folder:
        program = words.program
        if not program:
            program = str(Path(folder, "program.csv"))
            answer_of("pack", CELL, "--sequence", words.sequence, "--agent", "margin", "--program", program)
        is_same = whole_program(program, words.sequence, words.corrections, words.cup or ("holding" if words.corrections != "none" else "phases"))
    if words.minutes > 0.0:
        real_time(words.minutes)
    return 0 if is_same else 1


if __name__ == "__main__":
    os.environ.setdefault("PYTHONDONTWRITEBYTECODE", "1")
    sys.exit(main())
