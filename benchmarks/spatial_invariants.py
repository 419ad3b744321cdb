"""What holds for every impact in three dimensions, counted over many random problems of up to eight contacts.

    python benchmarks/spatial_invariants.py --problems 50000000 --chunk 2000 --resume spatial.json

For each law and kind of problem it prints how many violate each invariant, and the worst violation: numbers that
rounding alone keeps from being zero, relative to the terms that they are the sum of. The invariants are computed from
the statements of mechanics, without the law's code. The exit status is 1 if one is violated, or if the axes and the
order of the contacts matter in more problems than they are known to.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table
from spatial_problems import KINDS, ONE_FLOOR, ROUND, Array, Problems, in_units, problems_of, turned

from impact_predictor import ContactPoints, solve_spatial_impacts
from impact_predictor.files import whole
from impact_predictor.mechanics.impact.spatial import SpatialOutcomes
from impact_predictor.mechanics.invariants import UNITS
from impact_predictor.mechanics.types import ContactState, Flag

ROUNDED, SETTLED = 1e-9, 1e-5
LIMITS: dict[str, float] = dict.fromkeys(("finite", "cone", "momentum", "velocities", "energy", "energy told"), ROUNDED)
SURE = set(LIMITS)
"""What holds without an answer, too."""

LIMITS |= {
    "approach": SETTLED,
    "states": 10.0 * SETTLED,
    "mirrored": 1e-12,
    "units": 1e-12,
    "turned": 1e-3,
    "reordered": 1e-3,
}
"""Roundings of sums of some tens of terms where every digit counts; 1e-5 of the speeds where the iterations of the law
end, and 1e-4 where it calls a contact at rest. In each step one contact is solved after the other, and a rounding
decides whether a compression ends in it or in the next: so their order and the axes may count as much as the steps
do, and in some problems more (`SELDOM`)."""

SELDOM = ("turned", "reordered")

FRICTIONS = {"frictionless": 0.0, "up to 1": 1.0, "up to 3": np.inf}
"""The greatest coefficient of a problem's contacts, by which `SELDOM` is told."""

SHARES: dict[str, dict[str, tuple[float, float, float]]] = {
    "path, one floor": {"turned": (0.002, 0.003, 0.004), "reordered": (0.004, 0.01, 0.02)},
    "path, any normals": {"turned": (0.004, 0.004, 0.007), "reordered": (0.005, 0.012, 0.05)},
    "total, one floor": {"turned": (5e-4, 5e-4, 5e-4), "reordered": (5e-4, 0.03, 0.03)},
    "total, any normals": {"turned": (5e-4, 5e-4, 5e-4), "reordered": (5e-4, 5e-4, 0.005)},
}
"""In how many problems of a kind these may be beyond their limits, for each of `FRICTIONS`: about twice what was
counted of the worst kind, and 5e-4 where hardly any were."""

UNANSWERED = int(Flag.NO_SOLUTION | Flag.INVALID_INPUT | Flag.NOT_CONVERGED)

OFTEN = 20
"""One of so many problems is seen otherwise, too: turned, mirrored, reordered and in other units."""


def limits_of(kind: str) -> dict[str, float]:
    """Of supports that move apart impulses have no bound, as they may do any work, nor have the roundings of these."""
    return {
        name: limit for name, limit in LIMITS.items() if kind != "apart" or name not in ("velocities", "energy told")
    }


def violations(
    problems: Problems, law: str, solve: Callable[..., Any] = solve_spatial_impacts, otherwise: bool = True
) -> dict[str, Array]:
    """By how much each problem violates each of the `LIMITS`, the last four of them only when seen `otherwise`, too.

    Where the law says that it found no answer it may leave an approach or another state, but no other violation.
    """
    (mass, inertia), contacts, before = problems
    outcome: SpatialOutcomes = solve(*problems, law)
    twist, impulses, normals = outcome.twist, outcome.impulses, contacts.normals
    c, after = problems.seen(before), problems.seen(twist)
    lengths = np.linalg.norm(contacts.positions, axis=-1)
    speed = np.linalg.norm(before[:, :3], axis=1)[:, None] + np.linalg.norm(before[:, 3:], axis=1)[:, None] * lengths
    speed = (speed + np.linalg.norm(contacts.velocities, axis=-1)).max(1)
    along, normal_after = (impulses * normals).sum(-1), (after * normals).sum(-1)
    across = np.linalg.norm(impulses - along[..., None] * normals, axis=-1)
    slip = np.linalg.norm(after - normal_after[..., None] * normals, axis=-1)
    size = np.linalg.norm(impulses, axis=-1)
    work = 0.5 * (impulses * (c + after)).sum((1, 2))
    work_scale = 0.5 * (size * (np.linalg.norm(c, axis=-1) + np.linalg.norm(after, axis=-1))).sum(1) + 1e-300
    moments = np.cross(contacts.positions, impulses)
    left = np.abs(mass[:, None] * (twist - before)[:, :3] - impulses.sum(1)).max(1) / (size.sum(1) + mass * speed)
    turns_left = np.abs((inertia @ (twist - before)[:, 3:, None])[..., 0] - moments.sum(1)).max(1)
    turns_left /= np.linalg.norm(moments, axis=-1).sum(1) + np.linalg.norm(inertia, axis=(1, 2)) * speed / lengths.max(
        1
    )
    slips, sticks = outcome.states == ContactState.SLIPS, outcome.states == ContactState.STICKS
    state_error = np.maximum(np.where(slips | sticks, np.abs(normal_after), 0.0), np.where(sticks, slip, 0.0)).max(1)
    finite = np.isfinite(twist).all(1) & np.isfinite(impulses).all((1, 2)) & np.isfinite(outcome.energy_lost)
    may_gain = (law == "total") & (outcome.flags & int(Flag.ENERGY_GAINED) > 0)
    found = {
        "finite": np.where(finite, 0.0, 1.0),
        "approach": np.maximum(-normal_after, 0.0).max(1) / speed,
        "cone": np.maximum(np.maximum(across - contacts.friction * along, -along), 0.0).max(1) / (size.max(1) + 1e-300),
        "momentum": np.maximum(left, turns_left),
        "velocities": np.abs(outcome.velocities - after).max((1, 2)) / speed,
        "energy": np.where(may_gain, 0.0, np.maximum(work, 0.0)) / work_scale,
        "energy told": np.abs(outcome.energy_lost + work) / work_scale,
        "states": state_error / speed,
    }
    answered = outcome.flags & UNANSWERED == 0
    if otherwise:

        def same(other: Problems, back: Callable[[Array], Array]) -> Array:
            again = solve(*other, law)
            difference = np.abs(back(again.velocities) - outcome.velocities).max((1, 2)) / speed
            return np.where(again.flags & UNANSWERED == 0, difference, 0.0)

        turn = np.array([[0.28, -0.96, 0.0], [0.96, 0.28, 0.0], [0.0, 0.0, 1.0]])
        mirror = np.diag([1.0, -1.0, 1.0])
        backwards = problems._replace(contacts=ContactPoints(*(each[:, ::-1] for each in contacts[:-1])))
        found["turned"] = same(turned(problems, turn), lambda velocities: velocities @ turn)
        found["mirrored"] = same(turned(problems, mirror), lambda velocities: velocities @ mirror)
        found["reordered"] = same(backwards, lambda velocities: velocities[:, ::-1])
        found["units"] = same(in_units(problems), lambda velocities: velocities * (UNITS[2] / UNITS[1]))
    for name in found.keys() - SURE:
        found[name] = np.where(answered, found[name], 0.0)
    return {**found, "unanswered": np.where(answered, 0.0, 1.0)}


def by_friction(found: dict[str, Array], friction: Array) -> dict[str, Array]:
    """What was found, with each of `SELDOM` apart for each of `FRICTIONS`."""
    told = {name: values for name, values in found.items() if name not in SELDOM}
    number = np.searchsorted(list(FRICTIONS.values()), friction)
    for place, words in enumerate(FRICTIONS):
        told |= {f"{name}, {words}": found[name][number == place] for name in SELDOM}
    return told


Tally = dict[str, tuple[int, int, float]]
"""Of each name how many problems there were, how many were beyond the limit, and the worst of them."""


def broken_bounds(law: str, kind: str, tally: Tally) -> list[str]:
    """What is beyond its limit, of `SELDOM` in more problems than chance would make of their `SHARES`."""
    shares = SHARES[f"{law}, {'one floor' if kind in ONE_FLOOR else 'any normals'}"]
    allowed = dict.fromkeys(limits_of(kind), 0.0)
    for name in SELDOM:
        allowed |= {f"{name}, {words}": share for words, share in zip(FRICTIONS, shares[name], strict=True)}
    return [
        name
        for name, (count, bad, _) in tally.items()
        if bad > (expected := allowed.get(name, 1.0) * count) + 4.0 * math.sqrt(expected)
    ]


def table_of(law: str, names: list[str], tallies: dict[str, Tally]) -> Table:
    table = Table("law " + law, *names)
    for kind in KINDS:
        tally = tallies[f"{law} {kind}"]
        row = []
        for name in names:
            count, bad, worst = tally.get("finite" if name == "problems" else name, (0, 0, 0.0))
            told = f"{bad} of {count}\n{worst:.0e}" if bad else f"{worst:.0e}"
            row.append(f"{count}" if name == "problems" else told)
        table.add_row(kind, *row)
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--problems", type=int, default=400_000)
    parser.add_argument("--chunk", type=int, default=1_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--law", action="append", choices=["path", "total"])
    parser.add_argument("--steps", type=int, default=8, help="of the path law, in a quarter of an oscillation")
    parser.add_argument("--resume", type=Path, help="where it stands, kept as it goes; it goes on from there")
    given = parser.parse_args()
    laws = given.law or ["path", "total"]
    of = [given.seed, given.chunk, given.steps, *laws]
    solve = partial(solve_spatial_impacts, steps=given.steps)
    state: dict[str, Any] = {"of": of, "done": 0, "tallies": {f"{law} {kind}": {} for law in laws for kind in KINDS}}
    if given.resume is not None and given.resume.exists():
        state = json.loads(given.resume.read_text())
        if state["of"] != of:
            parser.error(f"{given.resume} is of another seed, chunk, number of steps or law")
    for number in track(range(state["done"], -(-given.problems // given.chunk)), console=Console(stderr=True)):
        kind, n = ROUND[number % len(ROUND)]
        problems = problems_of(kind, n, np.random.default_rng((given.seed, number)), given.chunk)
        some = problems.first(-(-given.chunk // OFTEN))
        for law in laws:
            tally = state["tallies"][f"{law} {kind}"]
            found = violations(problems, law, solve, otherwise=False)
            found = violations(some, law, solve) | found
            for name, values in by_friction(found, some.contacts.friction.max(1)).items():
                count, bad, worst = tally.get(name, (0, 0, 0.0))
                values = np.nan_to_num(values, nan=np.inf)
                bad += int(np.count_nonzero(values > LIMITS.get(name.partition(",")[0], 0.0)))
                tally[name] = count + len(values), bad, max(worst, float(values.max(initial=0.0)))
        state["done"] = number + 1
        if given.resume is not None:
            with whole(given.resume) as unfinished:
                unfinished.write_text(json.dumps(state))
    always = ["problems", *(name for name in LIMITS if name not in SELDOM), "unanswered"]
    seldom = [f"{name}, {words}" for name in SELDOM for words in FRICTIONS]
    console, broken = Console(width=200), []
    for law in laws:
        console.print(table_of(law, always, state["tallies"]))
        console.print(table_of(law, seldom, state["tallies"]))
        for kind in KINDS:
            tally = state["tallies"][f"{law} {kind}"]
            broken += [f"{law} {kind}: {name}" for name in broken_bounds(law, kind, tally)]
    if broken:
        sys.exit("broken: " + "; ".join(broken))


if __name__ == "__main__":
    main()
