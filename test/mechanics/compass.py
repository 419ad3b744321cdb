"""The compass gait: two straight legs that are jointed at the hip walk down a slope, driven by their weight alone.

Goswami, Thuilot and Espiau, "A study of the passive gait of a compass-like biped robot", Int. J. Robotics Research
17(12), 1998. With all the legs' mass in the feet and hardly any of it this is the simplest walker: Garcia, Chatterjee,
Ruina and Coleman, "The simplest walking model: stability, complexity, and scaling", J. Biomechanical Engineering
120(2), 1998.
"""

from __future__ import annotations

from math import cos, sin
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from impact_predictor.mechanics.contact_space import ContactOutcome, solve


class Compass(NamedTuple):
    """A compass with a point mass at the hip and the mass centre of each leg `to_foot` and `to_hip` away; SI units.

    `slope` in rad, positive downhill ahead; `leg_inertia` of a leg about its mass centre.
    """

    hip_mass: float = 10.0
    leg_mass: float = 5.0
    to_foot: float = 0.5
    to_hip: float = 0.5
    slope: float = 0.05
    gravity: float = 9.81
    leg_inertia: float = 0.0

    @property
    def leg(self) -> float:
        return self.to_foot + self.to_hip


def after_impact(compass: Compass, angles: tuple[float, float], rates: tuple[float, float]) -> tuple[float, float]:
    """Rates of the new standing leg and of the old one after an impact without slip, the old foot leaving.

    The angular momentum of the whole about the new foot stays, and that of the old standing leg about the hip. `angles`
    and `rates` are those of the old standing leg and of the new one right before.
    """
    theta, psi = angles
    inertia = inertia_of(compass, theta, psi)
    momentum = inertia @ _free_rates(compass, theta, *rates)
    # What the legs do about the new foot, as velocities of the hip and rates of the legs.
    pinned = np.array([[0.0, compass.leg * cos(psi)], [0.0, -compass.leg * sin(psi)], [1.0, 0.0], [0.0, 1.0]])
    old, new = np.linalg.solve(pinned.T @ inertia @ pinned, pinned.T @ momentum)
    return float(new), float(old)


def strike(
    compass: Compass, angles: tuple[float, float], rates: tuple[float, float], friction: float, law: str = "path"
) -> tuple[ContactOutcome, tuple[float, float]]:
    """The impact by its contacts: the outcome, and the rates after it of the new standing leg and of the old one.

    Friction may be too small to hold the feet. Arguments as those of `after_impact`; the legs must have mass.
    """
    rows = contact_rows(compass, *angles)
    velocity = _free_rates(compass, angles[0], *rates)
    response = np.linalg.solve(inertia_of(compass, *angles), rows.T)
    speeds = rows @ velocity
    outcome = solve(rows @ response, (0.0, 0.0, speeds[2], speeds[3]), (friction, friction), law=law)
    after = velocity + response @ np.array([*outcome.impulses[0], *outcome.impulses[1]])
    return outcome, (float(after[3]), float(after[2]))


def contact_rows(compass: Compass, theta: float, psi: float) -> NDArray[np.float64]:
    """Velocities of the feet (4, 4) by those of the hip, ahead and up, and rates of the legs at two angles.

    Along the slope's normal and ahead: of the foot of the first leg, and of the other one.
    """
    return np.array(
        [
            [0.0, 1.0, compass.leg * sin(theta), 0.0],
            [1.0, 0.0, -compass.leg * cos(theta), 0.0],
            [0.0, 1.0, 0.0, compass.leg * sin(psi)],
            [1.0, 0.0, 0.0, -compass.leg * cos(psi)],
        ]
    )


def inertia_of(compass: Compass, theta: float, psi: float) -> NDArray[np.float64]:
    """Inertia for velocities of the hip, ahead and up, and rates of the legs at two angles."""
    m, b = compass.leg_mass, compass.to_hip
    whole, own = compass.hip_mass + 2.0 * m, m * b * b + compass.leg_inertia
    return np.array(
        [
            [whole, 0.0, -m * b * cos(theta), -m * b * cos(psi)],
            [0.0, whole, m * b * sin(theta), m * b * sin(psi)],
            [-m * b * cos(theta), m * b * sin(theta), own, 0.0],
            [-m * b * cos(psi), m * b * sin(psi), 0.0, own],
        ]
    )


def _free_rates(compass: Compass, theta: float, stance: float, swing: float) -> NDArray[np.float64]:
    """Velocities of the hip and rates of the legs while the foot of the first one stands."""
    return np.array([compass.leg * cos(theta) * stance, -compass.leg * sin(theta) * stance, stance, swing])


def step(compass: Compass, gait: NDArray[np.float64], law: str) -> NDArray[np.float64]:
    """The gait after one more step without slip, its impact by contacts; NaN where the compass falls.

    A gait is how far the legs lean right after an impact, the standing one by minus that, and the rates of the standing
    leg and of the other one. That one scuffs the ground as it swings past, and strikes when it comes down ahead.
    """

    def lands(_: float, state: NDArray[np.float64]) -> float:
        return float(state[0] + state[1]) if state[0] > state[1] else 1.0

    lands.terminal, lands.direction = True, 1.0  # type: ignore[attr-defined]
    start = [-gait[0], *gait]
    found: Any = solve_ivp(
        lambda _, state: [state[2], state[3], *_accelerations(compass, *state)],
        (0.0, 10.0),
        start,
        "DOP853",
        events=lands,
        rtol=3e-14,
        atol=1e-15,
    )
    if not len(found.t_events[0]):
        return np.full(3, np.nan)
    theta, psi, stance, swing = found.y_events[0][0].tolist()
    _, after = strike(compass, (theta, psi), (stance, swing), 10.0, law)
    return np.array([theta, *after])


def _accelerations(compass: Compass, theta: float, psi: float, stance: float, swing: float) -> tuple[float, float]:
    """Angular accelerations of the legs while the foot of the first one stands; the second row is for unit mass."""
    m, a, b, leg, g = compass.leg_mass, compass.to_foot, compass.to_hip, compass.leg, compass.gravity
    own, coupling = compass.hip_mass * leg * leg + m * (a * a + leg * leg), -leg * b * cos(theta - psi)
    turn = leg * b * sin(theta - psi)
    weight = (compass.hip_mass * leg + m * (a + leg)) * g * sin(theta + compass.slope)
    turning, swinging = m * turn * swing * swing + weight, -turn * stance * stance - b * g * sin(psi + compass.slope)
    determinant = own * b * b - m * coupling * coupling
    return (
        (b * b * turning - m * coupling * swinging) / determinant,
        (own * swinging - coupling * turning) / determinant,
    )
