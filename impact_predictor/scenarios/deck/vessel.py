"""How a vessel answers to waves from the side, and its deck as a support that moves in its transverse plane.

A response is a complex number for each frequency: what it multiplies the amplitude of a wave by, and by how much it
leads the surface at the origin. Waves travel towards +y of the vessel (to port) in deep water, so the surface is
amplitude * exp(i (frequency t - k y)) with the wave number k = frequency^2 / g. Roll is about +x and raises port.
"""

from __future__ import annotations

from math import inf, pi
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...mechanics.support import MovingSupport, SupportMotion
from .sea import Array, Waves

Complex = NDArray[np.complex128]


class SecondOrder(NamedTuple):
    """A damped oscillator: natural frequency (rad/s), part of the critical damping, and its answer to a slow drive.

    `drive` is what drives it: the height of the "surface" (heave), its "slope" (roll), or the "drift" of the water to
    and fro (sway).
    """

    frequency: float
    damping: float
    gain: float = 1.0
    drive: str = "surface"

    def at(self, frequencies: Array, gravity: float) -> Complex:
        ratio = frequencies / self.frequency
        answer: Complex = np.divide(self.gain, 1.0 - ratio * ratio + 2j * self.damping * ratio)
        if self.drive == "slope":
            return answer * (-1j * frequencies**2 / gravity)
        return answer * -1j if self.drive == "drift" else answer


class Table(NamedTuple):
    """A response amplitude operator at increasing frequencies (rad/s): amplitude per wave amplitude, and phase (rad).

    Between them it is linear in the complex plane; outside it is that of the first or last one.
    """

    frequencies: tuple[float, ...]
    amplitudes: tuple[float, ...]
    phases: tuple[float, ...]

    def at(self, frequencies: Array, gravity: float) -> Complex:
        answers = np.array(self.amplitudes) * np.exp(1j * np.array(self.phases))
        found: Complex = np.interp(frequencies, self.frequencies, answers)
        return found


Response = SecondOrder | Table

PONTOON_ROLL: Final = SecondOrder(2.0 * pi / 4.0, 0.3, 0.6, "slope")
"""A pontoon narrower than the waves takes a part of their slope."""


class Vessel(NamedTuple):
    """The responses of a vessel in roll (rad per m), heave and sway (m per m), of the point about which it rolls.

    The deck lies `height` m above that point. Without a word it is a stiff pontoon of some ten metres.
    """

    roll: Response = PONTOON_ROLL
    heave: Response = SecondOrder(2.0 * pi / 3.0, 0.5, 1.0, "surface")
    sway: Response = SecondOrder(2.0 * pi / 3.0, 0.7, 1.0, "drift")
    height: float = 1.0


def deck_in(waves: Waves, vessel: Vessel, gravity: float = 9.81) -> MovingSupport:
    """The vessel's deck in a sea from the side, in its y-z plane: x of the support is y of the deck, y is z."""
    frequencies = waves.frequencies
    swings = waves.amplitudes * np.exp(1j * waves.phases)
    places = np.stack([r.at(frequencies, gravity) * swings for r in (vessel.roll, vessel.sway, vessel.heave)], axis=1)
    rates = 1j * frequencies[:, None] * places
    moves = np.hstack([places, rates, 1j * frequencies[:, None] * rates])
    # The real part of each complex swing times exp(i frequency t): all motions share its sine and cosine.
    parts = np.concatenate([moves.real, -moves.imag])

    def motion(time: Any) -> SupportMotion:
        turns = np.multiply.outer(np.asarray(time, dtype=float), frequencies)
        both = np.concatenate([np.cos(turns), np.sin(turns)], axis=-1)
        # Not as a product of matrices: its threads would wait for each other on a busy machine.
        now = np.einsum("...i,ij->j...", both, parts)
        # Numbers at a single time are Python's: they go through motions whose steps are too short for numpy.
        roll, sway, heave, roll_rate, sway_rate, heave_rate, *accelerations = now if now.ndim > 1 else now.tolist()
        roll_up, sway_up, heave_up = accelerations
        return SupportMotion(roll, roll_rate, roll_up, sway, heave, sway_rate, heave_rate, sway_up, heave_up)

    return MovingSupport(motion, 2.0 * pi / float(frequencies.max()), gravity, (0.0, vessel.height))


def read_vessel(path: str, height: float) -> Vessel:
    """A vessel of tables in a CSV file: frequency, roll, roll_phase, heave, heave_phase, sway, sway_phase.

    The first line names the columns; units are rad/s, rad/m, m/m and rad.

    Raises:
        InputError: the file cannot be read, or its numbers are no tables.
    """
    import csv
    from itertools import pairwise

    names = ("frequency", *(f"{motion}{part}" for motion in ("roll", "heave", "sway") for part in ("", "_phase")))
    try:
        with Path(path).open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        columns: dict[str, Any] = {name: tuple(float(row[name]) for row in rows) for name in names}
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}") from error
    except (KeyError, TypeError, ValueError, csv.Error) as error:
        raise InputError(f"{path} is no table of responses ({error}); give numbers under {','.join(names)}") from error
    frequencies = columns["frequency"]
    finite = all(-inf < number < inf for column in columns.values() for number in column)
    if len(rows) < 2 or not finite or not all(0.0 < one < two for one, two in pairwise(frequencies)):
        raise InputError(f"{path}: give finite numbers at two or more frequencies above 0, in increasing order")
    roll, heave, sway = (
        Table(frequencies, columns[motion], columns[f"{motion}_phase"]) for motion in ("roll", "heave", "sway")
    )
    return Vessel(roll, heave, sway, height)
