"""A robot's feet land
===================

The plan of the quadruped HyQ: the poses of trunk and feet are samples, its contact flags the truth. Each landing is
announced again with every sample; how far is the announced time from the one at which the foot's motion ends?
"""

from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np

from impact_predictor import read_scenes, replay
from impact_predictor.resources import find

found = replay(find("examples/hyq/hyq.bag"), read_scenes(find("config/walker_hyq.yaml")))
landings = [one.score.landing for one in found.settled]
print(f"{len(landings)} landings, {found.truth.found} of {found.truth.touchdowns} true ones, {found.truth.false} false")

ahead, error = 1e3 * np.array([made for landing in landings for made in landing.history]).T
edges = np.arange(0.0, 101.0, 10.0)
spans = [np.abs(error[(ahead >= low) & (ahead < high)]) for low, high in pairwise(edges)]
for low, values in zip(edges, spans, strict=False):
    print(f"{low:3.0f} to {low + 10:3.0f} ms ahead: {np.median(values):.1f} ms wrong in the median")

# %%
# When the feet stand, and how wrong the announcements are. ``python benchmarks/walker_times.py`` prints the errors of
# simple answers, such as the gap over its speed, beside them.

(gait,) = found.gaits.values()
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained", width_ratios=(2, 1))
for foot, begin, end in gait.stances:
    left.barh(foot, (end - begin) / 1e9, left=(begin - gait.begin) / 1e9, color="steelblue")
left.set_yticks(range(len(gait.feet)), gait.feet)
left.set(xlabel="time (s)", title="Stances, as the motion shows them")
right.boxplot(spans, positions=edges[:-1] + 5, widths=7, showfliers=False, manage_ticks=False)
right.set(xlabel="announced ahead (ms)", ylabel="error of the time (ms)", xlim=(100, 0))
plt.show()
