"""A deck warns before its cargo moves
===================================

A crate stands on the deck of a vessel in a sea that is made here. The watch knows the samples of crate and deck alone;
when the crate truly lifts is in the bag for the comparison.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

from impact_predictor import read_scenes, replay
from impact_predictor.resources import find

bag = Path(tempfile.mkdtemp()) / "cargo.mcap"
sea = ["--seed", "49", "--duration", "60", "--rate", "20", "--deck-rate", "50"]
command = [sys.executable, "-m", "impact_predictor", "simulate", "deck", *sea, "-o", str(bag)]
print(subprocess.run(command, capture_output=True, text=True, check=True).stdout.replace(str(bag), bag.name))

# %%
# The margins are the parts of what holds the crate that are used: at 1 it slides or tips. A warning is a level above
# OK.

watch = replay(bag, read_scenes(find("config/deck_crate.yaml"))).watch
start = watch.stamps[0]
level, slide, tip, probability = watch.units[:, 0].T
seconds = (watch.stamps - start) / 1e9

figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(9, 5), layout="constrained")
above.plot(seconds, watch.deck[:, 3], color="gray")
above.set(ylabel="felt across (m/s^2)")
below.plot(seconds, tip, label="margin used against tipping")
below.plot(seconds, slide, label="against sliding")
below.plot(seconds, probability, ":", label="probability of an onset")
below.fill_between(seconds, 0, 1.5, where=(level == 1) | (level == 2), color="orange", alpha=0.3, label="warning")
for unit, events in watch.events.items():
    for stamp, what in events.items():
        stands = [one for one in watch.spells if one.unit == unit and one.begin < stamp <= one.end]
        warned = [one for one in stands if one.level in (1, 2)]
        stood = f"a warning had stood {(stamp - warned[0].begin) / 1e9:.1f} s" if warned else "no warning stood"
        print(f"{(stamp - start) / 1e9:.1f} s: the crate {what}; {stood}")
        below.axvline((stamp - start) / 1e9, color="red")
below.set(xlabel="time (s)", ylim=(0, 1.5))
below.legend(loc="upper right")
plt.show()
