"""Three rods until they rest
==========================

The paper's Fig. 2: a rod of 0.4 m stands on two edges, is turned by 30 degrees and let go. The nearer the edges are to
each other, the more it rocks: far apart it stops at the first impact.
"""

from math import radians

import matplotlib.pyplot as plt
import numpy as np

from impact_predictor import rock, rod, standing

figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
for edge in (0.1, 0.075, 0.05):  # m from the mass centre to each edge
    body = rod(length=0.4, thickness=0.0, a=edge, b=edge, mass=0.3, friction=100.0)
    motion = rock(body, standing(body, angle=radians(30.0)))
    print(f"edges at {edge} m: {len(motion.impacts)} impacts, {motion.end.name} after {motion.time:.3f} s")
    times = np.linspace(0.0, min(motion.time, 2.0), 500)
    axes.plot(times, np.degrees(motion.state(times).angle), label=f"a = b = {edge} m")
axes.set(xlabel="time (s)", ylabel="angle of the rod (degrees)")
axes.legend()
plt.show()
