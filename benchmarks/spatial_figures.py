"""The figures of docs/spatial.md: python benchmarks/spatial_figures.py [FOLDER]

What goes on within an impact is read from the law as it runs, step by step, and so not compiled.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

from impact_predictor.mechanics.compiled import without_numba
from impact_predictor.mechanics.impact import spatial as law
from impact_predictor.mechanics.impact.spatial import Body, ContactPoints, SpatialOutcome, solve_spatial_impact
from impact_predictor.mechanics.types import ContactState
from impact_predictor.native import as_python
from impact_predictor.report.accuracy import problems, spatial
from impact_predictor.report.modes import PALETTE
from impact_predictor.report.plot import picture

spatial_path, BODY_LAW = (as_python(f"mechanics.impact.{name}") for name in ("spatial_path", "spatial_body"))

SIDES = np.array([0.4, 0.3, 0.2])
MASS = 2.0
BOX = Body(MASS, MASS / 12.0 * (SIDES @ SIDES - SIDES**2))
CORNERS = 0.5 * SIDES * np.array([(-1, -1, -1), (-1, 1, -1), (1, -1, -1), (1, 1, -1)])
NAMES = "A, stands", "B, stands", "C, strikes", "D, strikes"

COUNTS = 2 ** np.arange(1, 9)
"""Steps of the figure of errors."""

PROBLEMS = 24


def turning(omega: float, yaw: float, slip: tuple[float, float]) -> NDArray[np.float64]:
    """The twist of the box that turns about the edge from A to B, which slips and turns about the normal too."""
    spin = np.array([0.0, omega, yaw])
    middle = 0.5 * (CORNERS[0] + CORNERS[1])
    return np.concatenate(([*slip, 0.0] - np.cross(spin, middle), spin))


def along(body: Body, contacts: ContactPoints, twist: NDArray[np.float64], steps: int) -> tuple[NDArray[Any], ...]:
    """Impulses and velocities (k, n, 3) of the contacts, tangents and normal, after each step of an impact."""
    solved: list[tuple[Any, ...]] = []
    work = spatial_path.sweep

    def recorded(*given: Any) -> int:
        done: int = work(*given)
        system, before, motion, impulse = given[1], given[3], given[-2], given[-1]
        velocity = [0.0] * len(before)
        spatial_path.velocities(system, motion, velocity)
        # A step that is cut is solved again from where it began.
        if solved and np.array_equal(solved[-1][0], before):
            solved.pop()
        solved.append(tuple(np.array(one) for one in (before, velocity, impulse)))
        return done

    plain = without_numba(BODY_LAW.strike_all)
    with patch.object(spatial_path, "sweep", recorded), patch.object(law, "solver", lambda: plain):
        solve_spatial_impact(body, contacts, twist, steps=steps)
    first = solved[0][0]
    impulses = np.cumsum([np.zeros_like(first), *(impulse for _, _, impulse in solved)], axis=0)
    velocities = np.array([first, *(velocity for _, velocity, _ in solved)])
    return impulses.reshape(len(impulses), -1, 3), velocities.reshape(len(velocities), -1, 3)


def headline(figure: Any, text: str) -> None:
    """Write what a figure says above it."""
    figure.suptitle(text, x=0.01, ha="left", fontweight="bold", fontsize=11)


def draw_path(file: Path) -> None:
    """Impulses and speeds along the impact of a corner beside a standing edge."""
    contacts = ContactPoints(CORNERS[:3], friction=0.45, restitution=0.4)
    impulses, velocities = along(BOX, contacts, turning(4.0, 1.0, (0.3, 0.4)), 64)
    struck = impulses[:, 2, 2]
    with picture(file, 10.0, 3.6) as figure:
        headline(figure, "A corner strikes beside an edge that stands")
        axes = figure.subplots(1, 3)
        titles = "normal impulse, N s", "impulse of friction, N s", "speeds, m/s"
        for one, title in zip(axes, titles, strict=True):
            one.set(title=title, xlabel="normal impulse of C, N s")
        for k, name in enumerate(NAMES[:3]):
            look = {"color": PALETTE[k], "label": name}
            axes[0].plot(struck, impulses[:, k, 2], **look)
            axes[1].plot(struck, np.hypot(impulses[:, k, 0], impulses[:, k, 1]), **look)
            axes[2].plot(struck, velocities[:, k, 2], **look)
            axes[2].plot(struck, np.hypot(velocities[:, k, 0], velocities[:, k, 1]), "--", color=PALETTE[k])
        axes[2].plot([], [], color="grey", label="along the normal")
        axes[2].plot([], [], "--", color="grey", label="slip")
        axes[0].legend()
        axes[2].legend(handles=axes[2].get_lines()[-2:])
        for one in axes:
            one.axvline(struck[int(np.argmax(velocities[:, 2, 2] >= 0.0))], color="grey", linewidth=0.8, linestyle=":")


def over_gap(gap: float) -> SpatialOutcome:
    """The outcome where D is still open by a gap in m when C closes, or C by its opposite."""
    gaps = [0.0, 0.0, max(0.0, -gap), max(0.0, gap)]
    contacts = ContactPoints(CORNERS, friction=0.2, restitution=0.3, gaps=gaps)
    return solve_spatial_impact(BOX, contacts, turning(4.0, 0.0, (0.2, 0.2)), steps=32)


def draw_gaps(file: Path) -> None:
    """What each contact of a landing edge does after it, over the gap between its ends."""
    gaps = np.linspace(-4e-3, 4e-3, 161)
    outcomes = [over_gap(gap) for gap in gaps]
    leaves = np.array([[one is ContactState.LEAVES for one in outcome.states] for outcome in outcomes])
    with picture(file, 8.0, 4.4) as figure:
        headline(figure, "An edge lands beside one that stands: which end closes first decides what leaves")
        speeds, states = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
        for k, name in enumerate(NAMES):
            speeds.plot(1e3 * gaps, [outcome.velocities[k, 2] for outcome in outcomes], color=PALETTE[k], label=name)
            states.scatter(1e3 * gaps[leaves[:, k]], np.full(leaves[:, k].sum(), -k), s=9, color=PALETTE[k], marker="s")
        speeds.set_ylabel("speed away, m/s")
        speeds.legend(ncols=4, loc="upper center")
        speeds.set_ylim(top=1.25 * speeds.get_ylim()[1])
        states.set(xlabel="gap of D when C closes, mm (left of 0: of C when D closes)", ylim=(-3.6, 0.6))
        states.set_yticks([0, -1, -2, -3], ["A leaves", "B leaves", "C leaves", "D leaves"])


def draw_errors(file: Path) -> None:
    """Errors over the steps."""
    with picture(file, 7.0, 4.2) as figure:
        headline(figure, "Median error of the twist, of the size before the impact")
        axes = figure.subplots()
        for k, (scene, draw) in enumerate(spatial.SCENES.items()):
            boxes = problems(draw, scene.name, PROBLEMS)
            right = [spatial.reference_of(one) for one in boxes]
            errors = [
                np.median(
                    [
                        spatial.errors_of(one, spatial.solved(one, steps=int(steps)), exact)["twist_error"]
                        for one, exact in zip(boxes, right, strict=True)
                    ]
                )
                for steps in COUNTS
            ]
            axes.loglog(COUNTS, errors, "o-", color=PALETTE[k], label=scene.title)
        for power, start in ((1, 4e-2), (2, 1.2e-2)):
            axes.loglog(COUNTS, start * (COUNTS / COUNTS[0]) ** -float(power), ":", color="grey")
            axes.annotate(f"power {power}", (COUNTS[-1], start * (COUNTS[-1] / COUNTS[0]) ** -float(power)))
        axes.set_xticks(COUNTS, map(str, COUNTS))
        axes.set(xlabel="steps of a quarter of an oscillation")
        axes.minorticks_off()
        axes.legend()


def main() -> None:
    """Draw the figures."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs")
    draw_path(folder / "spatial_path.png")
    draw_gaps(folder / "spatial_gaps.png")
    draw_errors(folder / "spatial_steps.png")


if __name__ == "__main__":
    main()
