"""Which mode follows: a map
=========================

A plate turns about its left corner and strikes with the right one. Fields of bodies may be arrays, and
``solve_impacts`` solves all of them at once: here 300 heights by 300 frictions. ``impact-predictor map plate`` draws
the same with the paper's own borders on top.
"""

import matplotlib.pyplot as plt
import numpy as np

from impact_predictor import Mode, plate, solve_impacts

height, friction = np.linspace(0.05, 3.0, 300), np.linspace(0.0, 1.5, 300)
bodies = plate(length=1.0, height=height[:, None], mass=10.0, friction=friction)
outcomes = solve_impacts(bodies, bodies.turning(omega=-1.0))

figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
colors = plt.get_cmap("Set2", len(Mode))
drawn = axes.pcolormesh(height, friction, outcomes.mode.T, cmap=colors, vmin=-0.5, vmax=len(Mode) - 0.5)
bar = figure.colorbar(drawn, ticks=range(len(Mode)))
bar.ax.set_yticklabels([mode.name for mode in Mode])
axes.set(xlabel="height of the plate over its length", ylabel="friction")
for mode in Mode:
    print(f"{mode.name:12} {100 * np.mean(outcomes.mode == mode):5.1f} % of the map")
plt.show()
