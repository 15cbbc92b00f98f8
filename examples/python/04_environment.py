"""Plays episodes in many environments at once, each with its own friction. Words: scenario
(box-demonstrator)."""
import sys
import numpy as np
import snug

many = snug.env.VectorPacking(snug.load_scenario((sys.argv[1:] or ["box-demonstrator"])[0]), 16, threads=2,
                              parameters=[{"friction_scale": 0.8 + 0.025 * i} for i in range(16)])
observation, _ = many.reset(seed=1)
ends = []
while len(ends) < 32:
    lowest = np.zeros(16)  # candidates come lowest first
    observation, reward, terminated, truncated, _ = many.step(lowest)
    ends += list(many.packed_percent[terminated | truncated])
print(f"{np.mean(ends):.1f} % of the container on average, {min(ends):.1f} to {max(ends):.1f}")
