"""The balances of a lashed unit after Annex 13, as tables and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, atan2, degrees, isfinite
from typing import Any

from rich.console import Console

from ..mechanics.annex13 import Balance, Device, LashedUnit
from ..prediction.types import Vector3
from ..wording import NONE, fixed
from .table import Column, say, show, table_of

AXES = ("along", "across", "up")


def print_unit(
    name: str, unit: LashedUnit, accelerations: Vector3, measured: Vector3 | None, balances: Sequence[Balance]
) -> None:
    """Print what the Annex says of a unit: accelerations, balances, and what each lashing and stopper counts."""
    console = Console()
    say(console, f"{name}: {unit.mass:,.0f} kg, friction {unit.friction:g}")
    columns = [
        Column("", lambda k: AXES[k], left=True),
        Column("Annex 13\nm/s^2", lambda k: fixed(accelerations[k], 2)),
        Column("measured\nm/s^2", lambda k: fixed(None if measured is None else measured[k], 2), optional=True),
    ]
    show(console, table_of(columns, range(3)))
    columns = [
        Column("\nbalance", lambda one: one.name, left=True),
        Column("acts\nkN, kN m", lambda one: _kilo(one.acts)),
        Column("holds\nkN, kN m", lambda one: _kilo(one.holds)),
        Column("\nused", lambda one: fixed(used(one), 2)),
        Column("", lambda one: "holds" if used(one) <= 1.0 else "does not hold", left=True),
    ]
    show(console, table_of(columns, balances))
    if unit.devices:
        columns = [
            Column("\ndevice", str),
            Column("up\ndegrees", lambda k: fixed(_angles(unit.devices[k])[0], 0)),
            Column("from across\ndegrees", lambda k: fixed(_angles(unit.devices[k])[1], 0)),
            Column("MSL\nkN", lambda k: _kilo(unit.devices[k].msl)),
            *[_shares(one) for one in balances],
        ]
        show(console, table_of(columns, range(len(unit.devices))))
    console.print()


def fields(
    unit: LashedUnit, accelerations: Vector3, measured: Vector3 | None, forces: Vector3, balances: Sequence[Balance]
) -> dict[str, Any]:
    """The same for a program; None stands for a stopper without limit."""
    named = {"accelerations": accelerations, "measured": measured, "forces": forces}
    return {
        **{name: dict(zip(AXES, one, strict=True)) for name, one in named.items() if one is not None},
        "balances": [
            one._asdict() | {"holds": _finite(one.holds), "used": used(one), "shares": [*map(_finite, one.shares)]}
            for one in balances
        ],
        "devices": [
            {"up": _angles(one)[0], "from_across": _angles(one)[1], "msl": _finite(one.msl)} for one in unit.devices
        ],
    }


def used(balance: Balance) -> float:
    """The part of what holds that is used up, at most 99."""
    return min(99.0, balance.acts / balance.holds) if balance.holds > 0.0 else 99.0


def _shares(balance: Balance) -> Column:
    shares = [NONE if share == 0.0 else _kilo(share) for share in balance.shares]
    return Column(balance.name.replace(" ", "\n", 1), lambda k: shares[k])


def _angles(device: Device) -> tuple[float, float]:
    x, y, z = device.direction
    return degrees(asin(max(-1.0, min(1.0, -z)))), degrees(atan2(abs(x), abs(y)))


def _kilo(value: float) -> str:
    return fixed(value / 1e3, 0) if isfinite(value) else "any"


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None
