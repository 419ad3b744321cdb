"""A deck that moves as sums of waves: what benchmarks and tests stand bodies on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from impact_predictor.mechanics.bodies import sine_and_cosine
from impact_predictor.mechanics.motion import PlanarState
from impact_predictor.mechanics.motion.support import MovingSupport, SupportMotion


class Wave(NamedTuple):
    """amplitude * sin(frequency * time + phase); `frequency` in rad/s, `phase` in rad."""

    amplitude: float
    frequency: float
    phase: float = 0.0


def harmonic_support(
    angle: Sequence[Wave] = (), x: Sequence[Wave] = (), y: Sequence[Wave] = (), gravity: float = 9.81
) -> MovingSupport:
    """A support whose angle (rad) and origin (m, in the world's axes) are sums of waves."""
    columns = [np.array([*waves, Wave(0.0, 0.0)]).T for waves in (angle, x, y)]
    each = [[*waves] for waves in (angle, x, y)]
    fastest = max(float(np.abs(frequency).max()) for _, frequency, _ in columns)

    def motion(time: Any) -> SupportMotion:
        sums: list[tuple[Any, Any, Any]] = []
        if isinstance(time, float):  # arrays of two or three numbers take ten times as long
            for waves in each:
                swing = slope = bend = 0.0
                for amplitude, frequency, phase in waves:
                    turn = frequency * time + phase
                    part, rate = amplitude * math.sin(turn), amplitude * frequency
                    swing, slope, bend = swing + part, slope + rate * math.cos(turn), bend - frequency**2 * part
                sums.append((swing, slope, bend))
            return told(*sums)
        for amplitude, frequency, phase in columns:
            turns = np.multiply.outer(np.asarray(time, dtype=float), frequency) + phase
            swing, slope = amplitude * np.sin(turns), amplitude * frequency * np.cos(turns)
            sums.append((swing.sum(axis=-1), slope.sum(axis=-1), -(frequency**2 * swing).sum(axis=-1)))
        return told(*sums)

    def told(turns: tuple[Any, Any, Any], along: tuple[Any, Any, Any], up: tuple[Any, Any, Any]) -> SupportMotion:
        (a, da, dda), (px, vx, ax), (py, vy, ay) = turns, along, up
        return SupportMotion(angle=a, rate=da, acceleration=dda, x=px, y=py, vx=vx, vy=vy, ax=ax, ay=ay)

    return MovingSupport(motion, 2.0 * math.pi / fastest, gravity)


def from_world(motion: SupportMotion, state: PlanarState) -> PlanarState:
    """A state in the world's axes as one in a support's frame."""
    x, y, angle, vx, vy, omega = state
    sine, cosine = sine_and_cosine(motion.angle)
    px, py = x - motion.x, y - motion.y
    ux, uy = vx - motion.vx + motion.rate * py, vy - motion.vy - motion.rate * px
    return PlanarState(
        cosine * px + sine * py,
        cosine * py - sine * px,
        angle - motion.angle,
        cosine * ux + sine * uy,
        cosine * uy - sine * ux,
        omega - motion.rate,
    )
