"""Values of the closed forms."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import bodies
from ..bodies import Number
from ..types import Mode

Modes = NDArray[np.uint8]
Truths = NDArray[np.bool_]

MODES = (Mode.STOP, Mode.SLIDE, Mode.PIVOT_SLIDE, Mode.PIVOT)
"""The modes of a plastic impact of a body that turned about its old contact at rest."""


class UnitImpact(NamedTuple):
    """What an impact does to a body of mass 1 kg that came with omega = -1 rad/s; a cylinder has the radius 1 m.

    Everything grows in proportion to the angular velocity before, impulses to the mass, lengths to the radius.
    `omega` after the impact in rad/s; `slip` of the contacts that stay, along their tangents in m/s; impulses on the
    body in N s along normals and tangents.
    """

    omega: Number
    slip: Number
    normal_old: Number
    friction_old: Number
    normal_new: Number
    friction_new: Number


class ClosedForm(NamedTuple):
    """An impact by the closed forms, over the broadcast shape (...) of what was asked.

    `mode` (...) numbers of Mode; `twist` (..., 3) as (vx, vy, omega) of the mass centre in m/s and rad/s; `slip` (...)
    of the contacts that stay, along their tangents in m/s; `impulses` (..., 2, 2) as ((N_old, T_old), (N_new, T_new))
    in N s.
    """

    mode: Modes
    twist: NDArray[np.float64]
    slip: NDArray[np.float64]
    impulses: NDArray[np.float64]


def speed(omega: Number) -> Number:
    """The clockwise speed of a body that turns towards its new contact; InputError if it turns away."""
    bodies.refuse({"omega": omega}, lambda value: (value < 0.0) & (value > -inf), "a finite number below 0 (clockwise)")
    return -omega


def select(domains: Sequence[Truths], impacts: Sequence[UnitImpact]) -> tuple[Modes, UnitImpact]:
    """Of impacts in the order of MODES, the one in whose domain a body lies, and its mode."""
    mode = np.select(domains, [np.uint8(mode) for mode in MODES], np.uint8(Mode.NO_IMPACT))
    return mode, UnitImpact(*(np.select(domains, parts) for parts in zip(*impacts, strict=True)))


def closed_form(mode: Modes, twist: Sequence[Number], slip: Number, push: Sequence[Number]) -> ClosedForm:
    """A ClosedForm from its parts, which broadcast: `push` is N_old, T_old, N_new, T_new."""
    modes, *parts = np.broadcast_arrays(mode, slip, *twist, *push)
    impulses = np.stack(parts[4:], axis=-1).reshape(*modes.shape, 2, 2)
    return ClosedForm(modes.copy(), np.stack(parts[1:4], axis=-1), parts[0].copy(), impulses)
