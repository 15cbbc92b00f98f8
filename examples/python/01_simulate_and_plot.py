"""Simulates a scene and plots the heights of its bodies. Words: scenario, picture to write (drop, heights.png)."""
import sys
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import snug

scenario, picture = sys.argv[1:3] or ("drop", "heights.png")
world, times, heights = snug.World(snug.load_scenario(scenario)), [], []
while world.time < 2.0:
    world.step(10)
    times.append(world.time)
    heights.append(world.positions[:, 2].copy())  # a view: copy what is to be kept
plt.plot(times, heights, label=world.names)
plt.xlabel("time, s"), plt.ylabel("height of the centre of mass, m"), plt.legend(fontsize=6)
plt.savefig(picture)
