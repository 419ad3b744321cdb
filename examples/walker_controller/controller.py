"""A trot whose feet brake before they land and bear once they have: one law, for any source that tells when they land.

It knows nothing of the simulation, nor of who tells: copy it, and give it a `Source` of your own.
"""

from __future__ import annotations

from typing import Final, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEET: Final = ("FL", "FR", "HL", "HR")
TICK: Final = 0.002
"""Seconds from one command to the next."""
GRAVITY: Final = 9.81
HEIGHT: Final = 0.238
"""m, of the trunk above the lowest points of the feet."""
CLEARANCE: Final = 0.045
SWING: Final = 0.18
"""Planned seconds of a swing; pairs of feet swing in turn."""
PATIENCE: Final = 0.06
"""Seconds after a planned landing from which on a foot bears in any case."""
RAMP: Final = 0.02
"""Seconds over which a foot that has landed takes its load, from a fifth on."""
PAIRS: Final = ((0, 3), (1, 2))
HIPS: Final = np.array([[0.1946, 0.14695], [0.1946, -0.14695], [-0.1946, 0.14695], [-0.1946, -0.14695]])
"""m, where the feet are to stand at rest."""
STIFFNESS, DAMPING = 600.0, 14.0
"""N/m and N s/m of a foot that swings."""
START: Final = 0.3
"""Seconds to stand before the first swing."""


class Measured(NamedTuple):
    """What the robot knows at a tick.

    `position`, `velocity` of the trunk (m, m/s) and its angular velocity `spin` (rad/s) in the world; `axes` turn from
    the trunk to the world; `feet` and `feet_velocity` against the trunk along its axes, of the lowest points of the
    balls; `felt` is what the contact sensors say.
    """

    tick: int
    position: Array
    velocity: Array
    axes: Array
    spin: Array
    feet: Array
    feet_velocity: Array
    felt: tuple[bool, ...]


class Command(NamedTuple):
    """What a foot is to do, along the trunk's axes: its drives' stiffness (N/m) and damping (N s/m) pull it to a
    `reference` that `moves` (m, m/s against the trunk), and a `force` (N) is added.
    """

    reference: Array
    moves: Array
    stiffness: float
    damping: float
    force: Array


class Gains(NamedTuple):
    """What is tuned, of every source alike."""

    descent: float = 0.5
    """m/s, with which a swing is planned to end, and goes on after its plan."""
    lead: float = 0.03
    """Seconds before the landing that is told at which a foot begins to brake ..."""
    speed: float = 0.15
    """... evenly, to this speed at the ground, m/s ..."""
    soft: float = 0.5
    """... with this part of its stiffness."""
    late: float = 0.03
    """Seconds after the end of its braking from which on it bears though nothing is felt; negative before it."""


class Landing(NamedTuple):
    """What is told of a foot in the air: `time` in s until it lands, its `gap` (m) and `speed` (m/s) to the ground."""

    time: float
    gap: float
    speed: float


class Source(Protocol):
    """Tells when feet land."""

    senses: bool
    """Whether a foot also bears as soon as its sensor feels the ground."""

    def tell(self, measured: Measured, planned: Landing) -> list[Landing | None]:
        """The landing of each foot, where it is known; by the plan it is the `planned` one."""
        ...


class Brake(NamedTuple):
    """How a foot brakes: from a time on (s) from one speed to another (m/s), for so long (s)."""

    since: float
    first: float
    last: float
    lasts: float

    def speed(self, now: float) -> float:
        """The speed to the ground at a time in s."""
        return self.first + min((now - self.since) / self.lasts, 1.0) * (self.last - self.first)


class Trot:
    """Trots along x with a speed (m/s): `gains` and `source` say how its feet land. `mass` in kg."""

    def __init__(self, mass: float, speed: float, gains: Gains, source: Source) -> None:
        self._mass, self._speed, self._gains, self._source = mass, speed, gains, source
        self.stands = [True] * 4
        self._pair, self._since = 1, 0.0
        self._from, self._landed = np.zeros((4, 3)), [-1.0] * 4
        self._brakes: list[Brake | None] = [None] * 4
        self._heights = [0.0] * 4
        """m, of the references of feet that brake, against the trunk."""
        self._velocity, self._lag = np.zeros(3), 0.0

    def commands(self, measured: Measured) -> list[Command]:
        """What each foot is to do at a tick."""
        now, gains = measured.tick * TICK, self._gains
        self._velocity += 0.1 * (measured.velocity - self._velocity)
        self._lag = min(max(self._lag + 0.5 * TICK * (self._speed - self._velocity[0]), -0.15), 0.15)
        elapsed = now - self._since
        told = self._source.tell(measured, Landing(SWING - elapsed, gains.descent * (SWING - elapsed), gains.descent))
        for i in [i for i in range(4) if not self.stands[i]]:
            brake, landing = self._brakes[i], told[i]
            if brake is None and landing is not None and landing.time <= gains.lead and elapsed > 0.5 * SWING:
                first = max(landing.speed, 0.05)
                last = min(gains.speed, first)
                brake = Brake(now, first, last, max(2.0 * landing.gap / (first + last), TICK))
                self._brakes[i], self._heights[i] = brake, measured.feet[i][2]
            due = brake is not None and now >= brake.since + brake.lasts + gains.late
            felt = self._source.senses and measured.felt[i] and elapsed > 0.4 * SWING
            if due or felt or elapsed >= SWING + PATIENCE:
                self.stands[i], self._landed[i] = True, now
        if all(self.stands) and elapsed >= SWING and now > START:
            self._pair, self._since, elapsed = 1 - self._pair, now, 0.0
            for i in PAIRS[self._pair]:
                self.stands[i], self._from[i], self._brakes[i] = False, measured.feet[i], None
        bears = self._bear(measured, now)
        return [bears[i] if self.stands[i] else self._swing(i, measured, now) for i in range(4)]

    def _swing(self, i: int, measured: Measured, now: float) -> Command:
        elapsed, start, brake, stiffness = now - self._since, self._from[i], self._brakes[i], STIFFNESS
        part = min(elapsed / SWING, 1.0)
        velocity = measured.axes.T @ self._velocity
        # Where a foot keeps the speed, and a little further ahead to lose what is too much (Raibert).
        goal = HIPS[i] + 0.5 * SWING * velocity[:2] + 0.06 * (velocity[:2] - (self._speed + self._lag, 0.0))
        smooth, rate = part * part * (3.0 - 2.0 * part), 6.0 * part * (1.0 - part) / SWING
        reference, moves = np.empty(3), np.empty(3)
        reference[:2] = start[:2] + smooth * (goal - start[:2])
        moves[:2] = rate * (goal - start[:2]) if part < 1.0 else -velocity[:2]
        reference[2], moves[2] = planned_height(start[2], elapsed, self._gains.descent)
        if brake is not None:
            # The trunk carries the foot along, and it is the ground that it is to meet slowly.
            carried = self._velocity + np.cross(measured.spin, measured.axes @ measured.feet[i])
            moves[2] = -brake.speed(now) - measured.axes[:, 2] @ carried
            self._heights[i] += TICK * moves[2]
            reference[2], stiffness = self._heights[i], self._gains.soft * STIFFNESS
        return Command(reference, moves, stiffness, DAMPING, np.zeros(3))

    def _bear(self, measured: Measured, now: float) -> dict[int, Command]:
        """How the feet that stand hold the trunk: least squares of the forces that make the wrench it wants."""
        axes, velocity, mass = measured.axes, self._velocity, self._mass
        standing = [i for i in range(4) if self.stands[i]]
        arms = measured.feet[standing] @ axes.T
        if not standing:
            return {}
        roll, pitch, yaw = axes[2, 1], -axes[2, 0], float(np.arctan2(axes[1, 0], axes[0, 0]))
        ahead = (self._speed + self._lag) * axes[:, 0]
        wrench = np.array(
            [
                8.0 * mass * (ahead[0] - velocity[0]),
                8.0 * mass * (ahead[1] - velocity[1]) - 4.0 * measured.position[1],
                mass * (GRAVITY + 150.0 * (HEIGHT + np.mean(arms[:, 2])) - 15.0 * velocity[2]),
                *(axes @ (-16.0 * roll, -24.0 * pitch, -4.0 * yaw) - (0.9, 1.4, 0.4) * measured.spin),
            ]
        )
        grasp = np.concatenate(
            [np.vstack([np.eye(3), ((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0))]) for x, y, z in arms], axis=1
        )
        # A moment of 0.1 N m counts as much as a force of 1 N.
        weights = np.array([1.0, 1.0, 1.0, 10.0, 10.0, 10.0])
        grasp *= weights[:, None]
        forces = grasp.T @ np.linalg.solve(grasp @ grasp.T + 1e-3 * np.eye(6), weights * wrench)
        commands = {}
        for i, (x, y, z) in zip(standing, forces.reshape(-1, 3).tolist(), strict=True):
            z = min(max(z, 0.0), 1.5 * mass * GRAVITY) * min(0.2 + 0.8 * (now - self._landed[i]) / RAMP, 1.0)
            x, y = (min(max(each, -0.6 * z), 0.6 * z) for each in (x, y))
            commands[i] = Command(np.zeros(3), np.zeros(3), 0.0, 0.0, -axes.T @ (x, y, z))
        return commands


def planned_height(start: float, elapsed: float, descent: float) -> tuple[float, float]:
    """Height against the trunk (m) of a foot that swings, and its rate (m/s), so many seconds after its liftoff.

    Two cubics: up to rest at the top, and down to the level ground, where it arrives with the `descent`; it goes on
    with that for 4 cm.
    """
    half, top = 0.5 * SWING, CLEARANCE - HEIGHT
    if elapsed < half:
        part = elapsed / half
        return start + (top - start) * part**2 * (3.0 - 2.0 * part), 6.0 * (top - start) * part * (1.0 - part) / half
    beyond = descent * (elapsed - SWING)
    if beyond > 0.0:
        return (-HEIGHT - beyond, -descent) if beyond < 0.04 else (-HEIGHT - 0.04, 0.0)
    part = (elapsed - half) / half
    square, cube = descent * half - 3.0 * CLEARANCE, 2.0 * CLEARANCE - descent * half
    return top + square * part**2 + cube * part**3, (2.0 * square * part + 3.0 * cube * part**2) / half
