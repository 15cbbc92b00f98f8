#!/usr/bin/env python3
"""tempo_curve.py: cycle time, boxes an hour and hold of the cup against the tempo, a table in Markdown."""
import argparse
import json
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def pack(words, tempo, sequence):
    """The documented JSON of one session; with the lag where `tempo` is 0."""
    command = [*words, "--sequence", sequence, "--json"] + (["--tempo", str(tempo)] if tempo else ["--controller", "lagged"])
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    return json.loads(done.stdout)


def row_of(tempo, sessions):
    """Means of the sessions with one tempo as cells of the table."""
    items = [item for one in sessions for item in one["items"] if item.get("sends")]
    cycles = [one["unturned_cycle_seconds"] for one in sessions if one["unturned_cycle_seconds"] is not None]
    holds = [item["hold_factor"] for item in items if item["hold_factor"] is not None]
    boxes, seconds = sum(one["executed_boxes"] for one in sessions), sum(one["duration"] for one in sessions)
    parts = [sum(item["seconds"][part] for item in items) / len(items)
             for part in ("travel", "carry", "regrasp", "insert", "push", "wait")]
    planned = sum(one["items_as_planned"] for one in sessions)
    waited = sum(item["planning_wait"] for one in sessions for item in one["items"])
    return [f"{tempo:g}" if tempo else "lag", f"{statistics.mean(cycles):.1f}" if cycles else "-", f"{3600 * boxes / seconds:.0f}",
            f"{3600 * boxes / (seconds + waited):.0f}",
            *[f"{part:.1f}" for part in parts], f"{min(holds):.1f}" if holds else "-", f"{planned} of {len(items)}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--snug", default=str(ROOT / "build" / "snug"), help="the program (default: build/snug)")
    parser.add_argument("--scenario", default=str(ROOT / "scenarios" / "box-demonstrator.yaml"))
    parser.add_argument("--sequences", default="1,2,3,4,5", help="names separated by commas")
    parser.add_argument("--tempos", default="0.5,0.6,0.7,0.8,0.9,1", help="separated by commas; 0: with the demonstrator's lag")
    parser.add_argument("--plant-seed", default="0", help="plant of all sessions (default: 0, the nominal one)")
    parser.add_argument("--samples", default="0", help="rehearsals of each motion in sampled worlds (default: none)")
    parser.add_argument("--set", action="append", default=[], help="change of the scenario, such as robot.velocity_fraction=1")
    options = parser.parse_args()
    words = [options.snug, "pack", options.scenario, "--plant-seed", options.plant_seed, "--samples", options.samples]
    for change in options.set:
        words += ["--set", change]
    print("| tempo | unturned cycle, s | boxes an hour | with waits for plans | travel, s a box | carry | regrasp | insert | push | wait | least hold factor | as planned |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    for tempo in (float(text) for text in options.tempos.split(",")):
        sessions = [pack(words, tempo, sequence) for sequence in options.sequences.split(",")]
        print("| " + " | ".join(row_of(tempo, sessions)) + " |", flush=True)


if __name__ == "__main__":
    main()
