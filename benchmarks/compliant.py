"""What impacts on compliant contacts come to, and at what cost, beside the rigid laws.

    python benchmarks/compliant.py [TABLE ...] [--count 200] [--picture docs/compliant.png]

Without names it prints all tables: stiffness, ratio, law, restitution, springs, friction, special, slow, cost, motion,
rocking.
Differences of two twists are the largest difference of a contact velocity over V, the sum of the contact speeds before
the impact. "Firm" contacts have 50 times the critical damping and rebound by a ten-thousandth.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import click
import numpy as np
from compliant_cases import BODIES, FIRM, FIRMER, cases, difference, disputed, moving, place
from compliant_impact import METHODS, STAYS, compliant_impact, velocities
from compliant_motion import compliant_motion, damping_ratio
from harmonic_deck import Wave, harmonic_support
from rich.console import Console
from rich.table import Table

from impact_predictor.mechanics.bodies import cylinder, plate, rod
from impact_predictor.mechanics.impact import see, solve_impact
from impact_predictor.mechanics.impact.answer import mode_of
from impact_predictor.mechanics.motion import rock, standing
from impact_predictor.mechanics.motion.support import FixedSupport
from impact_predictor.mechanics.types import Flag, Mode, Twist, Vector

STIFFNESSES = (1e4, 1e6, 1e8, 1e10, 1e12)
RATIOS = (1e-8, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e8)
KINDS = ("plate", "cylinder", "floor", "wedge", "tilted")
DOWN = (0.0, -9.81)


def orders(errors: list[float]) -> str:
    """The order of convergence in 1 / k, between the second and the last but one of `STIFFNESSES`."""
    if not (errors[1] > 0.0 and errors[-2] > 0.0):
        return "-"
    return f"{math.log(errors[1] / errors[-2]) / math.log(STIFFNESSES[-2] / STIFFNESSES[1]):.2f}"


def stiffness_errors(name: str, gravity: Vector, loaded: bool = True) -> tuple[list[float], list[float]]:
    """Differences from the limit and from the path law at each of the `STIFFNESSES`."""
    body, twist = moving(name)
    limit, path = compliant_impact(body, twist, math.inf, tolerance=1e-10), solve_impact(body, twist)
    found = [
        compliant_impact(body, twist, k, gravity=gravity, tolerance=1e-10, start_loaded=loaded).twist
        for k in STIFFNESSES
    ]
    return [difference(body, one, limit.twist, twist) for one in found], [
        difference(body, one, path.twist, twist) for one in found
    ]


def stiffness_table(count: int) -> Table:
    table = Table("impact", "gravity", "from", *(f"{k:.0e}" for k in STIFFNESSES), "order", title="Stiffness, N/m")
    settings = (("none", (0.0, 0.0), True), ("with its load", DOWN, True), ("without", DOWN, False))
    for name in BODIES:
        for words, gravity, loaded in settings:
            for law, errors in zip(("limit", "path law"), stiffness_errors(name, gravity, loaded), strict=True):
                order = orders(errors) if law == "limit" else ""
                table.add_row(name, words, law, *(f"{error:.1e}" for error in errors), order)
    return table


def ratio_table(count: int) -> Table:
    table = Table("problems", "", *(f"{ratio:g}" for ratio in RATIOS), title="Stiffness of the old contact / new, firm")
    for kind in KINDS:
        some = list(cases(kind, count // 2))
        ends = [
            [compliant_impact(case.body, case.twist, math.inf, ratio=ratio, damping=FIRM) for case in some]
            for ratio in RATIOS
        ]
        for law in ("path", "total"):
            answers = [case.path if law == "path" else case.total for case in some]
            modes, middles, worst = [], [], []
            for found in ends:
                errors = [
                    difference(case.body, end.twist, answer.twist, case.twist)
                    for case, end, answer in zip(some, found, answers, strict=True)
                ]
                same = [
                    end.mode == mode_of(STAYS * case.speed, *velocities(case.body, answer.twist))
                    for case, end, answer in zip(some, found, answers, strict=True)
                ]
                modes.append(f"{100.0 * float(np.mean(same)):.0f}")
                middles.append(f"{median(errors):.4f}")
                worst.append(f"{np.percentile(errors, 90):.4f}")
            name = f"{kind} ({len(some)})"
            table.add_row(name, f"{law} law's mode, %", *modes)
            table.add_row(name, f"from {law} law, median", *middles)
            table.add_row(name, f"from {law} law, 90 %", *worst)
    some = disputed(count)
    places = [np.array([place(case, ratio) for case in some]) for ratio in RATIOS]
    path = [found[:, 1] < 0.1 for found in places]
    total = [found[:, 2] < 0.1 for found in places]
    name = f"laws differ ({len(some)})"
    table.add_row(name, "the path law's, %", *(f"{100.0 * found.mean():.0f}" for found in path))
    table.add_row(name, "the total law's, %", *(f"{100.0 * found.mean():.0f}" for found in total))
    table.add_row(name, "median place", *(f"{np.median(found[:, 0]):.3f}" for found in places))
    return table


def closes_again(segments: tuple[str, ...]) -> bool:
    """Whether the old contact opens and closes again on the path."""
    states = "".join(segment[0] for segment in segments).lstrip("S+-")
    return bool(states.lstrip("O"))


def law_table(count: int) -> Table:
    table = Table(
        "problems", "of", "median", "99 %", "worst", "above 0.01", title="Stiff old contact, from the path law"
    )
    for again in (False, True):
        for kind in KINDS:
            errors = []
            for case in cases(kind, 2 * count):
                if closes_again(case.path.segments) == again:
                    end = compliant_impact(
                        case.body, case.twist, math.inf, ratio=1e12, damping=FIRMER, regularisation=1e-5
                    )
                    if end.over:
                        errors.append(difference(case.body, end.twist, case.path.twist, case.twist))
            if errors:
                name = f"{kind}, A opens and closes again" if again else kind
                values = (f"{value:.1e}" for value in (median(errors), np.percentile(errors, 99), max(errors)))
                table.add_row(name, str(len(errors)), *values, str(sum(error > 0.01 for error in errors)))
    return table


def restitution_table(count: int) -> Table:
    table = Table(
        "impact", "ratio", "e old", "e new", "damping", "mode", "path law", "c_nA'/V", "c_nB'/V", title="Restitution"
    )
    for name, ratio in (("STOP", 0.01), ("STOP", 1.0), ("STOP", 100.0), ("PIVOT", 1.0)):
        body, twist = moving(name)
        assert body.old is not None
        for old, new in ((0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5), (1.0, 1.0)):
            able = body._replace(old=body.old._replace(restitution=old), new=body.new._replace(restitution=new))
            end = compliant_impact(able, twist, math.inf, ratio=ratio)
            speed = float(np.abs(velocities(body, twist)).sum())
            damping = f"{damping_ratio(old):.3g}, {damping_ratio(new):.3g}"
            row = f"{ratio:g}", f"{old:g}", f"{new:g}", damping, end.mode.name, solve_impact(able, twist).mode.name
            table.add_row(name, *row, f"{end.velocities[0] / speed:.3f}", f"{end.velocities[2] / speed:.3f}")
    return table


def springs_table(count: int) -> Table:
    table = Table("impacts on one undamped spring", "of", "median", "worst", title="From the path law with e = 1")
    errors: dict[str, list[float]] = {}
    for kind in ("floor", "wedge", "tilted"):
        for case in cases(kind, count):
            body = case.body._replace(old=None, new=case.body.new._replace(restitution=1.0))
            path = solve_impact(body, case.twist)
            if path.mode is Mode.NO_IMPACT:
                continue
            end = compliant_impact(body, case.twist, math.inf)
            _, cn, ct, *_ = see(body.new, case.twist)
            change = max(abs(a - b) for a, b in zip(end.velocities[2:], see(body.new, path.twist)[1:3], strict=True))
            name = "the work returned ends it" if path.flags & Flag.WORK_LIMITED else "Poisson's impulse ends it"
            errors.setdefault(name, []).append(change / (abs(cn) + abs(ct)))
    for name, some in errors.items():
        table.add_row(name, str(len(some)), f"{median(some):.1e}", f"{max(some):.1e}")
    return table


def friction_table(count: int) -> Table:
    widths = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
    table = Table("impact", *(f"{width:.0e}" for width in widths), title="Regularisation: from that of 1e-7")
    for name in BODIES:
        body, twist = moving(name)
        ends = [
            compliant_impact(body, twist, math.inf, regularisation=width, tolerance=1e-10).twist
            for width in (*widths, 1e-7)
        ]
        table.add_row(name, *(f"{difference(body, end, ends[-1], twist):.1e}" for end in ends[:-1]))
    return table


def special_table(count: int) -> Table:
    table = Table("case", "setting", "compliant", "path law", "total law", "difference from path", title="Special")
    jam = plate(1.0, 2.0, 10.0, 2.0)
    wedge = cylinder(0.5, math.radians(40.0), 10.0, 1.5)
    thin = rod(0.4, 0.002, 0.15, 0.15, 0.3, 0.3)
    assert thin.old is not None
    springy = thin._replace(old=thin.old._replace(restitution=0.5), new=thin.new._replace(restitution=0.5))
    for name, body, twist in (
        ("jam", jam, Twist(-1.2, -0.5, -1.0)),
        ("PIVOT or locked", wedge, wedge.turning(-1.0)),
        ("thin rod, e = 0", thin, thin.turning(-1.0)),
        ("thin rod, e = 0.5", springy, springy.turning(-1.0)),
    ):
        path, total = solve_impact(body, twist), solve_impact(body, twist, "total")
        others = "" if total.unique else "/" + "/".join(one.mode.name for one in total.alternatives)
        for ratio in (0.01, 1.0, 100.0, 1e6):
            end = compliant_impact(body, twist, math.inf, ratio=ratio)
            error = difference(body, end.twist, path.twist, twist)
            names = end.mode.name, path.mode.name, total.mode.name + others
            table.add_row(name, f"ratio {ratio:g}", *names, f"{error:.4f}")
    return table


def slow_table(count: int) -> Table:
    speeds = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0)
    table = Table("k, N/m", "e", *(f"{omega:g} rad/s" for omega in speeds), title="Rod of 400 mm, a = b = 10 mm")
    for k in (1e5, 1e6, 1e7):
        for e in (0.1, 0.5):
            body = rod(0.4, 0.005, 0.01, 0.01, 0.3, 0.3, restitution=e)
            assert body.old is not None
            body = body._replace(old=body.old._replace(restitution=e))
            row = []
            for omega in speeds:
                end = compliant_impact(body, body.turning(-omega), k, gravity=DOWN)
                mode = end.mode.name if end.over else "no end"
                row.append(f"{mode} {9.81 * math.sqrt(0.3 / k) / (0.02 * omega):.2g}")
            table.add_row(f"{k:.0e}", f"{e:g}", *row)
    table.caption = "After the mode: g sqrt(m / k) / V. The rigid law gives FLIGHT at any speed."
    return table


def timed(call: Callable[[], Any], repeats: int) -> tuple[Any, float]:
    """What a call returns, and its median time in ms."""
    times = []
    for _ in range(repeats):
        start = perf_counter()
        result = call()
        times.append(1e3 * (perf_counter() - start))
    return result, median(times)


def cost_table(count: int) -> Table:
    table = Table("method", *(f"{k:.0e}" for k in STIFFNESSES), title="STOP: right-hand sides, ms and error at k")
    body, twist = moving("STOP")
    exact = {k: compliant_impact(body, twist, k, method="Radau", tolerance=1e-11).twist for k in STIFFNESSES}
    for method in METHODS:
        row = []
        for k in STIFFNESSES:
            end, ms = timed(partial(compliant_impact, body, twist, k, method=method), 3)
            error = difference(body, end.twist, exact[k], twist)
            row.append(f"{end.evaluations} {ms:.0f} ms {error:.0e}" if end.over else "no end")
        table.add_row(method, *row)
    return table


def motion_table(count: int) -> Table:
    table = Table("method", *(f"{k:.0e}" for k in STIFFNESSES[:4]), title="1 s of a rocking plate: right-hand sides, s")
    body = plate(1.0, 2.0, 10.0, 0.9)
    start = standing(body, 0.1)
    for method in METHODS:
        row = []
        for k in STIFFNESSES[:4]:
            call = partial(compliant_motion, body, start, FixedSupport(), 1.0, stiffness=k, method=method)
            try:
                run, ms = timed(call, 1)
            except ValueError:  # Radau's equations have no finite solution
                row.append("failed")
            else:
                row.append(f"{run.evaluations} {1e-3 * ms:.2f} s" if run.complete else "failed")
        table.add_row(method, *row)
    return table


def rocking_table(count: int) -> Table:
    times = (0.2, 0.5, 1.0, 1.5, 2.0)
    table = Table(
        "support", "k, N/m", *(f"{t} s" for t in times), title="Rocking plate: from the rigid motion, m ... rad/s"
    )
    deck = harmonic_support(angle=(Wave(0.1, 2.0, 0.3),), x=(Wave(0.5, 1.3),), y=(Wave(0.3, 0.9, 1.0),))
    body = plate(1.0, 2.0, 10.0, 0.9)
    start = standing(body, 0.1)
    for name, support in (("floor", FixedSupport()), ("slope", FixedSupport(-0.1)), ("deck", deck)):
        rigid = rock(body, start, support, duration=times[-1])
        for k in (1e6, 1e8, 1e10):
            run = compliant_motion(body, start, support, times[-1], stiffness=k, regularisation=1e-6)
            errors = (np.abs(np.subtract(run.state(t), rigid.state(t))).max() for t in times)
            table.add_row(f"{name}, {len(rigid.impacts)} impacts", f"{k:.0e}", *(f"{error:.1e}" for error in errors))
    return table


def picture(file: Path, count: int) -> None:
    """Draw what converges with stiffness, and which law the ratio of the stiffnesses chooses."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    blue, orange, grey = "#0072b2", "#d55e00", "#777777"
    plt.rcParams.update({"font.size": 14})
    figure, (left, right) = plt.subplots(1, 2, figsize=(13.5, 5.6), layout="constrained")
    path: list[float] = []
    for words, gravity, colour, mark in (("no gravity", (0.0, 0.0), blue, "o"), ("gravity", DOWN, orange, "s")):
        limit, path = stiffness_errors("PIVOT_SLIDE", gravity)
        left.loglog(STIFFNESSES, limit, mark + "-", color=colour, lw=2.5, label=f"from the stiff limit, {words}")
    left.loglog(STIFFNESSES, path, "s--", color=orange, lw=1.5, label="from the path law, gravity")
    left.loglog(STIFFNESSES, [0.3 * k**-0.5 for k in STIFFNESSES], ":", color=grey, lw=2, label="$k^{-1/2}$")
    left.text(1e12, 2e-3, "the contacts' own rebound", ha="right", va="bottom", color=orange, fontsize=12)
    left.set(xlabel="stiffness k of both contacts (N/m)", ylabel="difference after the impact / speed before")
    left.set_title("More stiffness brings an impact to its limit")
    left.legend(fontsize=12, loc="lower left")

    differ = disputed(2 * count)
    some = [case for case in differ if place(case, RATIOS[0])[2] < 0.1]
    click.echo(f"of {len(differ)} impacts of which the laws differ, {len(some)} go to the total law if A is soft")
    ratios = np.logspace(-6.0, 8.0, 15)
    places = np.array([[place(case, ratio)[0] for case in some] for ratio in ratios])
    low, middle, high = np.percentile(places, (10, 50, 90), axis=1)
    right.fill_between(ratios, low, high, color=blue, alpha=0.2, lw=0, label=f"80 % of {len(some)} impacts")
    right.semilogx(ratios, middle, "o-", color=blue, lw=2.5, label="median")
    right.axhline(1.0, color=grey, lw=1)
    right.axhline(0.0, color=grey, lw=1)
    right.set_yticks((0.0, 0.5, 1.0), ("total law", "half-way", "path law"))
    right.set(xlabel="stiffness of the old contact / that of the new one", ylim=(-0.2, 1.2))
    right.set_title("The ratio of the stiffnesses says which limit")
    right.legend(loc="lower right", fontsize=12)
    figure.savefig(file, dpi=100)


TABLES = {
    "stiffness": stiffness_table,
    "ratio": ratio_table,
    "law": law_table,
    "restitution": restitution_table,
    "springs": springs_table,
    "friction": friction_table,
    "special": special_table,
    "slow": slow_table,
    "cost": cost_table,
    "motion": motion_table,
    "rocking": rocking_table,
}


@click.command()
@click.argument("tables", nargs=-1, type=click.Choice(list(TABLES)))
@click.option("--count", default=200, show_default=True, help="Random problems of each kind.")
@click.option("--picture", "file", type=click.Path(path_type=Path), help="Draw the picture there instead.")
def main(tables: tuple[str, ...], count: int, file: Path | None) -> None:
    """Print the tables."""
    if file is not None:
        picture(file, count)
        return
    console = Console()
    for name in tables or TABLES:
        console.print(TABLES[name](count))


if __name__ == "__main__":
    main()
