"""Which falls the methods are asked: those whose motion is what the scene is about, whatever any method says."""

from __future__ import annotations

from random import Random

from ...mechanics.motion import MotionKind
from .touchdown_equations import slip_of, stance_of
from .touchdown_scenes import SCENES, SEED, Falling

STEP = 5e-4
"""s, of the plain steps that look whether a stance goes on as it began: they need not be accurate."""

LONGEST = 20.0
"""s; a fall that takes longer hangs in its balance."""


def falls(name: str, count: int) -> list[Falling]:
    """`count` problems of a scene, always the same; a stance that slips, sticks or lifts on the way is left out."""
    _, _, _, draw, motion = SCENES[name]
    source, found = Random(f"{SEED} {name}"), list[Falling]()
    while len(found) < count:
        fall = draw(source, len(found))
        if motion is MotionKind.FLIGHT or all_the_way(fall):
            found.append(fall)
    return found


def all_the_way(fall: Falling) -> bool:
    """Whether a stance goes on to stick, or to slip as it does, until B touches, which is at the angle 0."""
    stance, slip = stance_of(fall), slip_of(fall)
    angle, omega, time = fall.state.angle, fall.state.omega, 0.0
    while angle > 0.0 and time < LONGEST:
        alpha, slide = stance.accelerations(angle, omega)
        x, y = stance.arm(angle)
        normal = alpha * x - omega * omega * y - stance.gravity
        tangential = slide - alpha * y - omega * omega * x
        if normal <= 0.0 or (stance.drag is None and abs(tangential) > fall.friction * normal):
            return False
        if slip * (slip + STEP * slide) < 0.0:
            return False
        slip, omega, time = slip + STEP * slide, omega + STEP * alpha, time + STEP
        angle += STEP * omega
    return angle <= 0.0
