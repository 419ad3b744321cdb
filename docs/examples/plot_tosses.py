"""Tosses of a cube, beside simple answers
=======================================

Each of the recorded touchdowns is predicted from the samples before it and scored by those after it. What a prediction
is worth shows only beside the answers that anybody would try first, on the same touchdowns.
"""

import matplotlib.pyplot as plt
import numpy as np

from impact_predictor import read_scenes, replay
from impact_predictor.resources import find

found = replay(find("examples/cube_tosses"), read_scenes(find("config/cube_tosses.yaml")))
touchdowns = [one.score for one in found.settled]
scored = [score.spatial for score in touchdowns if score.spatial and not score.leftover_6d]
print(f"{len(scored):,} of {len(touchdowns):,} touchdowns are scored; of the others the record does not tell enough")

errors = {"prediction": [one.error for one in scored]}
answers = "nothing happens", "all stops", "0.85 v, no turning", "no slip", "planar law"
errors |= dict(zip(answers, np.transpose([one.simple_errors for one in scored]), strict=True))
for name, values in errors.items():
    print(
        f"{name:20} {100 * np.median(values):5.1f} % in the median, 90 % below {100 * np.quantile(values, 0.9):5.1f} %"
    )

# %%
# What part of the touchdowns has a smaller error, and the velocity upwards after each.

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.5), layout="constrained")
for name, values in errors.items():
    left.plot(100 * np.sort(values), np.linspace(0, 100, len(values)), label=name)
left.set(xlabel="error of the whole twist (%)", ylabel="touchdowns with less (%)", xlim=(0, 120))
left.legend()
up = np.array([(one.measured.linear[2], one.predicted.linear[2]) for one in scored])
right.plot(*up.T, "o", markersize=3, alpha=0.4)
right.axline((0, 0), slope=1, color="black")
right.set(xlabel="measured upwards (m/s)", ylabel="predicted (m/s)")
plt.show()

# %%
# Of each component of the twist the mean error, and the part of the variance that is predicted (R2), beside that of the
# twist before the touchdown: below 0 an answer is worse than the mean of all.

told, seen, before = (
    np.array([[*twist.linear, *twist.angular] for twist in twists])
    for twists in zip(*((one.predicted, one.measured, one.told.before_6d) for one in scored), strict=True)
)
for k, name in enumerate(("vx (m/s)", "vy (m/s)", "vz (m/s)", "wx (rad/s)", "wy (rad/s)", "wz (rad/s)")):
    variance = seen[:, k].var()
    r2 = [1 - np.mean((answer[:, k] - seen[:, k]) ** 2) / variance for answer in (told, before)]
    print(f"{name:10}  bias {np.mean(told[:, k] - seen[:, k]):+6.3f}   R2 {r2[0]:5.2f}   as before {r2[1]:5.2f}")
