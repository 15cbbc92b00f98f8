#!/usr/bin/env python3
"""from_python.py: what the Python module, environments and studies cost, beside their targets, with what they pack.

Words: [scenario (default: the demonstrator's)] [--only START of a row's name]. Rates of one thread are by CPU time, those of
threads by the clock: run it on a machine that does nothing else. SNUG names the program (default: build/snug)."""
import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import snug

ROOT = Path(__file__).resolve().parents[1]
FLOOR = """
materials: [{name: m}]
contacts: {default: {friction: 0.3, restitution: 0}}
bodies:
  - {name: floor, kind: static, material: m, shapes: [{box: [2, 2, 0.1]}]}
"""


def per_call(work, count):
    """The best of five, s of CPU time."""
    best = float("inf")
    for _ in range(5):
        start = time.process_time()
        for _ in range(count):
            work()
        best = min(best, (time.process_time() - start) / count)
    return best


def overheads(scenario):
    world = snug.World(snug.parse_scenario(FLOOR))
    inside = per_call(lambda: world.step(1000), 20) / 1000
    yield "a step of a world, from Python", 1e6 * (per_call(world.step, 20000) - inside), "us", "<= 2"
    result = snug.pack(scenario, "1", agent="margin", samples=0, robot="none", decision_time=0.01, threads=1)
    cell = snug.Cell(scenario, "1", result.program)
    cell.step(5000)
    inside = per_call(lambda: cell.step(500), 4) / 500
    ticks = per_call(lambda: [cell.step() for _ in range(500)], 4) / 500
    yield "a tick of a cell, from Python", 1e6 * max(0.0, ticks - inside), "us", "<= 2"
    yield f"  the tick itself, of {len(cell.names)} bodies", 1e6 * inside, "us", ""
    yield "all poses of the cell, a new array", 1e6 * per_call(cell.poses, 20000), "us", "<= 5"
    out = cell.poses()
    yield "  the same into an array", 1e6 * per_call(lambda: cell.poses(out=out), 20000), "us", ""


def episodes(environment, choose, seeds):
    """Steps a second of CPU time, resets included, and what the episodes packed, %."""
    taken, steps, packed = 0.0, 0, []
    for seed in seeds:
        start = time.process_time()
        _, info = environment.reset(seed=seed)
        ended = info["candidates"] == 0
        while not ended:
            _, _, terminated, truncated, info = environment.step(choose(info["candidates"]))
            steps += 1
            ended = terminated or truncated
        taken += time.process_time() - start
        packed.append(info["packed_percent"])
    return steps / taken, np.array(packed)


def geometric(scenario):
    rng = np.random.default_rng(1)
    for name, choose in (("first", lambda count: 0), ("random", lambda count: int(rng.random() * count))):
        for observation in ("height_map", "boxes"):
            environment = snug.env.Packing(scenario, observation=observation)
            rates, percents = zip(*(episodes(environment, choose, range(200 * i, 200 * i + 200)) for i in range(5)))
            percent = np.concatenate(percents)
            yield f"geometric steps, {name} candidates, {observation}", max(rates), "steps/s", ">= 20000"
            yield f"  packed: mean of {len(percent)} episodes ({percent.min():.1f} to {percent.max():.1f})", percent.mean(), "%", ""


def executed(scenario):
    program = snug.pack(scenario, "1", agent="margin", samples=0, robot="none", decision_time=0.05, threads=1).program
    best, result = 0.0, None
    for _ in range(5):
        start = time.process_time()
        result = snug.simulate(scenario, program, "1")
        packed = sum(box["state"] == "packed" for box in result.boxes)
        best = max(best, packed / (time.process_time() - start))
    yield "executed placements, program of sequence 1, tool without arm", best, "/s", ">= 20"
    yield f"  boxes packed; {result.filling_degree_percent:.1f} % of the container", packed, "", ""
    for mode in ("statics", "executed"):
        environment = snug.env.Packing(scenario, mode=mode, sequence="1")
        rate, percent = max(((rate, packed.mean()) for rate, packed in (episodes(environment, lambda count: 0, [seed]) for seed in range(5))))
        yield f"steps of mode {mode}, sequence 1, first candidates", rate, "steps/s", ""
        yield "  packed", percent, "%", ""


def vector(scenario, count=64, steps=300):
    rates, hashes = {1: [], 2: []}, {}
    many = {threads: snug.env.VectorPacking(scenario, count, threads=threads) for threads in rates}
    for _ in range(7):  # in turns: what else the machine does changes
        for threads, all_of_them in many.items():
            all_of_them.reset(seed=1)
            actions = np.zeros(count)
            start = time.perf_counter()
            for _ in range(steps):
                all_of_them.step(actions)
            rates[threads].append(steps * count / (time.perf_counter() - start))
            hashes[threads] = all_of_them.hashes
    yield f"vector of {count}, one thread (clock)", max(rates[1]), "steps/s", ""
    yield "  two threads over one", max(rates[2]) / max(rates[1]), "x", ">= 1.8"
    yield "  the same bytes", float(hashes[1] == hashes[2]), "", ">= 1"


def child_seconds(words, folder):
    """CPU time and clock of a program and its children."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(words, cwd=folder, check=True, capture_output=True)
    clock, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, clock


def study(_scenario, rows=4, rounds=3):
    """Rows of about a second: a heap that is simulated for longer; alone, and as a study on one thread."""
    program = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
    scene = ROOT / "scenarios" / "bench" / "s1-stack.yaml"
    with tempfile.TemporaryDirectory() as folder:
        def words(until):
            return [program, "simulate", str(scene), "--until", str(until), "--threads", "1", "--json"]

        until = 10.0
        until = round(min(1000.0, until / max(1e-3, child_seconds(words(until), folder)[0])), 3)
        Path(folder, "s.yaml").write_text(
            f"verb: simulate\nscenario: {scene}\noptions: {{--until: {until}, --threads: 1}}\n"
            f"factors: [{{option: --seed, values: {list(range(rows))}}}]\n", encoding="utf-8")
        alone, together = [], []
        for _ in range(rounds):
            alone.append(sum(np.array(child_seconds([*words(until), "--seed", str(k)], folder)) for k in range(rows)))
            subprocess.run(["rm", "-rf", "s.study"], cwd=folder, check=True)
            together.append(np.array(child_seconds([program, "study", "s.yaml", "--threads", "1"], folder)))
        cpu, clock = np.min(together, axis=0) / np.min(alone, axis=0) - 1.0
        yield f"  a row of a study alone, {rows} rows", np.min(alone, axis=0)[0] / rows, "s", ""
        yield "study over its rows alone, CPU time", 100.0 * cpu, "%", "<= 3"
        yield "  the same by the clock", 100.0 * clock, "%", ""


def main():
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("scenario", nargs="?", default=ROOT / "scenarios" / "box-demonstrator.yaml")
    words.add_argument("--only", default="", help="overheads, geometric, executed, vector or study")
    asked = words.parse_args()
    scenario = snug.load_scenario(asked.scenario)
    is_met = True
    for part in (overheads, geometric, executed, vector, study):
        if not part.__name__.startswith(asked.only):
            continue
        for name, value, unit, target in part(scenario):
            met = ""
            if target:
                sense, bound = target.split()
                good = value <= float(bound) if sense == "<=" else value >= float(bound)
                met, is_met = "yes" if good else "NO", is_met and good
            print(f"{name:<64} {value:>10.4g} {unit:<8} {target:<9} {met}", flush=True)
    return 0 if is_met else 1


if __name__ == "__main__":
    sys.exit(main())
