"""The balance of forces of lashed cargo after the CSS Code, Annex 13 (MSC.1/Circ.1623, 2020): tables and sums, in SI.

Directions are x forward, y to port and z up, all from a vessel that is upright.
"""

from __future__ import annotations

from math import fsum, hypot, sqrt
from typing import Final, NamedTuple

from ..errors import InputError

_Triple = tuple[float, float, float]

GRAVITY: Final = 9.81
POSITIONS: Final = tuple([0.1 * k for k in range(1, 10)])
"""Of the columns of table 2, as parts of the vessel's length from aft."""

RATIOS: Final = tuple([float(k) for k in range(3, 14)])
"""B/GM of the columns of table 4."""

TRANSVERSE: Final = {
    "high": (7.1, 6.9, 6.8, 6.7, 6.7, 6.8, 6.9, 7.1, 7.4),
    "low": (6.5, 6.3, 6.1, 6.1, 6.1, 6.1, 6.3, 6.5, 6.7),
    "tween": (5.9, 5.6, 5.5, 5.4, 5.4, 5.5, 5.6, 5.9, 6.2),
    "hold": (5.5, 5.3, 5.1, 5.0, 5.0, 5.1, 5.3, 5.5, 5.9),
}
"""m/s^2 on deck (high, low), in the 'tween deck and in the lower hold: table 2, for 100 m and 15 knots."""

LONGITUDINAL: Final = {"high": 3.8, "low": 2.9, "tween": 2.0, "hold": 1.5}
VERTICAL: Final = (7.6, 6.2, 5.0, 4.3, 4.3, 5.0, 6.2, 7.6, 9.2)

STIFF: Final = {
    "high": (2.64, 2.28, 1.98, 1.74, 1.56, 1.40, 1.27, 1.19, 1.11, 1.05, 1.0),
    "low": (2.18, 1.93, 1.72, 1.55, 1.42, 1.30, 1.21, 1.14, 1.09, 1.04, 1.0),
    "tween": (1.62, 1.51, 1.41, 1.33, 1.26, 1.19, 1.14, 1.09, 1.06, 1.03, 1.0),
    "hold": (1.24, 1.23, 1.20, 1.18, 1.15, 1.12, 1.09, 1.06, 1.04, 1.02, 1.0),
}
"""By how much more a stiff vessel accelerates across: table 4."""

LIFTED: Final = (0.0, 0.1, 0.2, 0.3, 0.4, 0.6), (0.20, 0.50, 0.70, 0.80, 0.85, 0.90)
"""Friction, and the part of the vertical force that counts where a unit slides along the vessel."""

PRESSURE: Final = 1000.0  # N/m^2 of wind, and of spray
ALONG: Final = 0.8660254037844386  # cos 30 degrees: what deviates more does not count in the advanced method
STEEP: Final = 0.8660254037844386  # sin 60 degrees: steeper lashings do not count against sliding

METHODS: Final = {"advanced": (1.5, 1.0), "alternative": (1.35, 0.9)}
"""What an MSL is divided by, and the part of the result that counts against tipping."""

WAYS: Final = {
    "to port": (0.0, 1.0, 0.0),
    "to starboard": (0.0, -1.0, 0.0),
    "forward": (1.0, 0.0, 0.0),
    "aft": (-1.0, 0.0, 0.0),
}


class VesselData(NamedTuple):
    """Length between perpendiculars, breadth and metacentric height in m, service speed in knots."""

    length: float
    breadth: float
    gm: float
    speed: float


class Device(NamedTuple):
    """A lashing or a stopper: where it takes hold of the unit (m), the direction of its force on it, its MSL in N."""

    point: _Triple
    direction: _Triple
    msl: float


class LashedUnit(NamedTuple):
    """A unit: mass in kg, friction, mass centre in m, the rectangle that it stands on as least x, greatest x, least y,
    greatest y, the height of the deck, and its areas in m^2 in the wind and in the spray along x and along y.
    """

    mass: float
    friction: float
    center: _Triple
    footprint: tuple[float, float, float, float]
    deck: float
    devices: tuple[Device, ...]
    wind: tuple[float, float] = (0.0, 0.0)
    spray: tuple[float, float] = (0.0, 0.0)


class Balance(NamedTuple):
    """One balance: its name, what acts and what holds (N, or N m of tipping), and what each device holds of it."""

    name: str
    acts: float
    holds: float
    shares: tuple[float, ...]


def design_accelerations(vessel: VesselData, position: float, deck: str) -> _Triple:
    """The design accelerations in m/s^2 along, across and up, at a part of the length from aft and on a deck by its
    name; tables 2 to 4, linear between their columns.

    Raises:
        InputError: the tables do not hold for the vessel.
    """
    length, breadth, gm, speed = vessel
    if not 50.0 <= length <= 300.0:
        raise InputError(f"Annex 13 is for vessels of 50 to 300 m, and this one has {length:g} m")
    if not (0.0 < speed < 100.0 and gm > 0.0 and 0.0 <= position <= 1.0 and breadth >= RATIOS[0] * gm):
        raise InputError(
            "Annex 13 needs a speed in knots above 0, a position from 0 (aft) to 1, and a GM above 0 and at most a "
            f"third of the breadth, not {speed:g} knots, {position:g}, {gm:g} m and {breadth:g} m"
        )
    factor = 0.345 * speed / sqrt(length) + (58.62 * length - 1034.5) / length**2
    across = factor * _between(position, POSITIONS, TRANSVERSE[deck]) * _between(breadth / gm, RATIOS, STIFF[deck])
    return factor * LONGITUDINAL[deck], across, factor * _between(position, POSITIONS, VERTICAL)


def external_forces(unit: LashedUnit, accelerations: _Triple) -> _Triple:
    """The forces in N along, across and up that act on a unit: inertia, wind and spray (7.1)."""
    along, across, up = [unit.mass * a for a in accelerations]
    return along + PRESSURE * (unit.wind[0] + unit.spray[0]), across + PRESSURE * (unit.wind[1] + unit.spray[1]), up


def balances(unit: LashedUnit, forces: _Triple, method: str = "advanced") -> list[Balance]:
    """The balances of a unit under forces (N): sliding to each side, tipping across, by either of the METHODS.

    A device counts against sliding where it pulls against it, with f = cos a + mu sin a of its vertical angle a in the
    advanced method (7.2), and with the part of cos a along the way in the alternative one (7.3).
    """
    safety, tips = METHODS[method]
    weight, mu = unit.mass * GRAVITY, unit.friction
    found = []
    for name, way in WAYS.items():
        across = way[1] != 0.0
        acts = forces[1] if across else forces[0]
        pressing = weight - (0.0 if across else _between(mu, *LIFTED) * forces[2])
        shares = [_share(device, safety, _against(device, way, mu, method)) for device in unit.devices]
        held = mu * max(0.0, pressing)
        found.append(Balance(f"sliding {name}", acts, held + fsum(shares), tuple(shares)))
        if across:
            left, right = unit.footprint[2:]
            edge = right if way[1] > 0.0 else left
            lever = way[1] * (edge - unit.center[1])
            shares = [_share(device, safety / tips, _arm(device, way[1], edge, unit.deck)) for device in unit.devices]
            moment = forces[1] * (unit.center[2] - unit.deck)
            found.append(Balance(f"tipping {name}", moment, lever * weight + fsum(shares), tuple(shares)))
    return found


def _share(device: Device, safety: float, factor: float) -> float:
    """What counts of a device: the MSL of a stopper may be without limit."""
    return device.msl / safety * factor if factor > 0.0 else 0.0


def _against(device: Device, way: _Triple, mu: float, method: str) -> float:
    """What a force of 1 in a device holds against sliding a way, with the friction that it presses for."""
    x, y, z = device.direction
    pull, flat = -(x * way[0] + y * way[1]), hypot(x, y)
    if pull <= 0.0 or -z > STEEP or (method == "advanced" and pull < ALONG * flat - 1e-9):
        return 0.0
    return (flat if method == "advanced" else pull) - mu * z


def _arm(device: Device, side: float, edge: float, deck: float) -> float:
    """The lever arm in m of a device about the edge at y on a side (1: port, -1: starboard), 0 where it has none."""
    (_, y, z), (_, to_y, to_z) = device.point, device.direction
    return max(0.0, -side * (edge - y) * to_z - side * (z - deck) * to_y)


def _between(x: float, places: tuple[float, ...], values: tuple[float, ...]) -> float:
    """The value at x, linear between places and constant beyond them."""
    for k in range(1, len(places)):
        if x < places[k]:
            part = max(0.0, (x - places[k - 1]) / (places[k] - places[k - 1]))
            return values[k - 1] + part * (values[k] - values[k - 1])
    return values[-1]
