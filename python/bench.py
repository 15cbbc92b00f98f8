#!/usr/bin/env python3
"""bench.py: what the Python module costs, beside its targets. Words: scenario (default: the demonstrator's). Prints a table."""
import sys
import time
from pathlib import Path

import numpy as np

import snug

SCENARIO = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[1] / "scenarios" / "box-demonstrator.yaml"


def per_call(work, count):
    """The best of five, s."""
    best = float("inf")
    for _ in range(5):
        start = time.process_time()
        for _ in range(count):
            work()
        best = min(best, (time.process_time() - start) / count)
    return best


def geometric_rate(scenario, **settings):
    """Steps a second of episodes with random candidates, resets included."""
    environment = snug.env.Packing(scenario, **settings)
    best = 0.0
    for seed in range(5):
        rng = np.random.default_rng(seed)
        _, info = environment.reset(seed=seed)
        start, steps = time.process_time(), 0
        while steps < 20000:
            _, _, terminated, truncated, info = environment.step(int(rng.random() * info["candidates"]))
            steps += 1
            if terminated or truncated:
                _, info = environment.reset()
        best = max(best, steps / (time.process_time() - start))
    return best


def executed_rate(scenario):
    """Placements a second in sequence 1, first candidates; simulated seconds a second."""
    environment = snug.env.Packing(scenario, mode="executed", sequence="1")
    best, speed = 0.0, 0.0
    for seed in range(3):
        environment.reset(seed=seed)
        start, placed, ended = time.process_time(), 0, False
        while not ended:
            _, _, ended, _, info = environment.step(0)
            placed += info["is_placed"]
        taken = time.process_time() - start
        best, speed = max(best, placed / taken), max(speed, info["time"] / taken)
    return best, speed


def vector_rate(scenario, threads, count=64, steps=300):
    many = snug.env.VectorPacking(scenario, count, threads=threads)
    best = 0.0
    for _ in range(5):
        many.reset(seed=1)
        start = time.perf_counter()
        for step in range(steps):
            many.step(np.zeros(count))
        best = max(best, steps * count / (time.perf_counter() - start))
    return best, many.hashes


def main():
    scenario = snug.load_scenario(SCENARIO)
    rows = []

    def row(what, value, target):
        rows.append((what, value, target))
        print(f"{what:<62} {value:>14}   {target}", flush=True)

    floor = "materials: [{name: m}]\ncontacts: {default: {friction: 0.3}}\nbodies:\n" \
            "  - {name: floor, kind: static, material: m, shapes: [{box: [2, 2, 0.1]}]}\n"
    world = snug.World(snug.parse_scenario(floor))
    many = per_call(lambda: world.step(1000), 20) / 1000
    row("overhead of a step", f"{1e6 * (per_call(world.step, 20000) - many):.2f} us", "<= 2 us")
    result = snug.pack(scenario, "1", agent="margin", samples=0, robot="none", decision_time=0.01, threads=1)
    cell = snug.Cell(scenario, "1", result.program)
    cell.step(5000)
    row(f"all poses of the cell, {len(cell.names)} bodies, a new array", f"{1e6 * per_call(cell.poses, 20000):.2f} us", "<= 5 us")
    out = cell.poses()
    row("  the same into an array", f"{1e6 * per_call(lambda: cell.poses(out=out), 20000):.2f} us", "")
    row("geometric environment, height map", f"{geometric_rate(scenario):.0f} steps/s", ">= 20000 a core")
    row("geometric environment, boxes", f"{geometric_rate(scenario, observation='boxes'):.0f} steps/s", "")
    rate, speed = executed_rate(scenario)
    row("executed placements, sequence 1, tool without arm", f"{rate:.1f} /s", ">= 20 /s")
    row("  simulated seconds a second", f"{speed:.0f}", "")
    one, hashes_one = vector_rate(scenario, 1)
    two, hashes_two = vector_rate(scenario, 2)
    row("vector environment, 64, one thread (wall clock)", f"{one:.0f} steps/s", "")
    row("  two threads, same bytes: " + str(hashes_one == hashes_two), f"{two / one:.2f} x", ">= 1.8 x")


if __name__ == "__main__":
    main()
