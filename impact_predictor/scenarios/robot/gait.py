"""How a robot is told to walk: where its feet are to be, phase by phase, and the joint positions for that."""

from __future__ import annotations

from math import sqrt
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .description import Values
from .machine import Machine

PHASES: Final = 400
"""Into which a stride is divided."""

REACHED: Final = 2e-3
"""m: so near to where it is to be a foot has to come."""

_CLEARANCE: Final = 0.17
_SPEED: Final = 0.12

OFFSETS: Final = {"trot": (0.0, 0.5, 0.5, 0.0), "amble": (0.0, 0.5, 0.75, 0.25), "step": (0.0, 0.5)}
"""When in a stride each foot lands: left and right ones in turn, front ones first."""

DUTY: Final = {"trot": 0.55, "amble": 0.6, "step": 0.6}
"""The part of a stride for which each foot stands."""


class PlannedGait(NamedTuple):
    """A gait by name, with `swing` in s.

    At the end of its swing a foot is to come down with a speed of `strike` in m/s, 0 to brake to rest. Of a robot of
    its size where None: `speed` ahead in m/s and `clearance` in m, how high feet swing.
    """

    name: str
    swing: float = 0.2
    strike: float = 0.6
    speed: float | None = None
    clearance: float | None = None

    @property
    def offsets(self) -> tuple[float, ...]:
        """When in a stride each foot lands."""
        return OFFSETS[self.name]

    @property
    def duty(self) -> float:
        """The part of a stride for which each foot stands."""
        return DUTY[self.name]

    @property
    def period(self) -> float:
        """Seconds of a stride."""
        return self.swing / (1.0 - self.duty)

    def stands(self, times: Values) -> NDArray[np.bool_]:
        """Which feet are to stand (n, feet) at times (n,) in s after the first stride has begun."""
        phases = (times[:, None] / self.period - np.array(self.offsets)) % 1.0
        stands: NDArray[np.bool_] = phases < self.duty
        return stands

    def shares(self, phase: float) -> Values:
        """The part of the weight (feet,) that each foot is to carry: less where its stance begins or ends."""
        phases = (phase - np.array(self.offsets)) % 1.0
        ramp = max(self.duty - 0.5, 0.05)
        carried: Values = np.clip(np.minimum(phases, self.duty - phases) / ramp, 0.0, 1.0)
        return carried / max(float(carried.sum()), 1e-9)


class References(NamedTuple):
    """Joint positions (rad or m) and velocities (PHASES, joints) over a stride of `period` s."""

    period: float
    positions: Values
    velocities: Values

    def at(self, time: float) -> tuple[Values, Values]:
        """Those at a time in s since the first stride began."""
        place = time / self.period % 1.0 * PHASES
        k = int(place) % PHASES
        part, following = place - int(place), (k + 1) % PHASES
        positions, velocities = ((1.0 - part) * one[k] + part * one[following] for one in self[1:])
        return positions, velocities


def references(machine: Machine, gait: PlannedGait, slope: float, obstacle: float) -> References:
    """What the drives of a machine are told, over and over; `obstacle` in m is what feet have to clear besides.

    The feet are below the mass centre along the vertical, on ground that rises ahead by `slope` (rad). InputError where
    the gait is that of another number of feet, or the legs do not reach so far.
    """
    offsets = gait.offsets
    if len(offsets) != len(machine.feet):
        raise InputError(f"{gait.name} is a gait for {len(offsets)} feet, but the robot has {len(machine.feet)}")
    height = machine.height
    speed = _SPEED * sqrt(9.81 * height) if gait.speed is None else gait.speed
    clearance = _CLEARANCE * height + obstacle if gait.clearance is None else gait.clearance
    stride = speed * gait.period * gait.duty
    middle = machine.at_rest(machine.posture)
    center = machine.inertia()[0]
    middle[:, :, 0] += center[0] - middle[:, :, 0].mean() - (center[2] + height) * np.tan(slope)
    climb = _rise(gait, clearance)
    positions, start = np.zeros((PHASES, len(machine.joints))), machine.posture
    # Once around for the start, and once more from there, so that the end meets the beginning.
    for k in [*range(PHASES), *range(PHASES)]:
        targets = middle.copy()
        for foot, offset in enumerate(offsets):
            phase = (k / PHASES - offset) % 1.0
            if phase < gait.duty:
                targets[foot, :, 0] += stride * (0.5 - phase / gait.duty)
            else:
                s = (phase - gait.duty) / (1.0 - gait.duty)
                targets[foot, :, 0] += stride * (s * s * (3.0 - 2.0 * s) - 0.5)
                targets[foot, :, 2] += climb(s)
        shares = gait.shares(k / PHASES)
        start = machine.reach(targets, start)
        if np.abs(machine.at_rest(start) - targets).max() > REACHED:
            raise InputError("the legs do not reach where the gait wants the feet; give a lower --speed or --clearance")
        positions[k] = start + machine.sag(start, shares, slope)
    ahead, behind = np.roll(positions, -1, axis=0), np.roll(positions, 1, axis=0)
    return References(gait.period, positions, (ahead - behind) * PHASES / (2.0 * gait.period))


def _rise(gait: PlannedGait, clearance: float) -> np.poly1d:
    """The height in m of a swinging foot over the part s of its swing: s (1 - s) (a (1 - s) + b s).

    It comes down with b over the time of the swing, and a lifts it as high as the clearance.
    """
    down, s = gait.strike * gait.swing, np.poly1d([1.0, 0.0])
    shape = s * (1.0 - s)
    grid = np.linspace(0.0, 1.0, 201)
    low, high = 0.0, 20.0 * clearance
    for _ in range(50):
        lift = 0.5 * (low + high)
        if (shape * (lift * (1.0 - s) + down * s))(grid).max() < clearance:
            low = lift
        else:
            high = lift
    return shape * (high * (1.0 - s) + down * s)
