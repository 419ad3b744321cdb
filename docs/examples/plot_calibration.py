"""Friction and restitution of a body
==================================

``impact-predictor calibrate`` finds them from recorded touchdowns, and tells how far to trust them. Here is what it
does at heart, for friction: predict with several values, and see which one errs least.
"""

import matplotlib.pyplot as plt
import numpy as np

from impact_predictor import read_scenes, replay
from impact_predictor.resources import find

(scene,) = read_scenes(find("config/cube_tosses.yaml")).values()
frictions = 0.08, scene.friction, 0.3
medians = []
for friction in frictions:
    found = replay(find("examples/cube_tosses"), scene._replace(friction=friction, samples=0))
    errors = [one.score.spatial.error for one in found.settled if one.score.spatial and not one.score.leftover_6d]
    medians.append(100 * np.median(errors))
    print(f"friction {friction:.3f}: {medians[-1]:.1f} % in the median of {len(errors):,} touchdowns")

figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
axes.plot(frictions, medians, "o-")
axes.axvline(scene.friction, color="gray", linestyle=":", label="in config/cube_tosses.yaml")
axes.set(xlabel="friction", ylabel="error of the twist after, median (%)", ylim=(0, None))
axes.legend()
plt.show()
