"""Maps of modes: what the regions, the borders, the data and the pictures say."""

from __future__ import annotations

import csv
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.text import Text
from numpy.typing import NDArray

from impact_predictor import Flag, Mode, solve_impact, solve_impacts
from impact_predictor.mechanics.closed_forms import cylindrical
from impact_predictor.report.map import (
    SUBJECTS,
    Axis,
    ModeMap,
    axis_label,
    conditions,
    fixed_values,
    map_modes,
    middles,
    problem_at,
    summary_of,
    write_csv,
)
from impact_predictor.report.map_figure import borders_of, write_map

CELLS = 120


def a_map(
    name: str, x: Axis | None = None, y: Axis | None = None, law: str = "path", cells: int = CELLS, **given: float
) -> ModeMap:
    subject = SUBJECTS[name]
    axes = x or subject.x, y or subject.y
    return map_modes(name, *axes, fixed_values(subject, axes, given), law, cells)


def frictions(high: float) -> Axis:
    return Axis("friction", 0.0, high)


PLASTIC = {
    "Fig. 5": lambda: a_map("plate"),
    "Fig. 7": lambda: a_map("cylinder"),
    "rod": lambda: a_map("rod"),
    "asymmetric plate": lambda: a_map("plate", a=0.3, b=0.7),
    "heights": lambda: a_map("plate", Axis("height", 0.0, 3.0), length=2.0),
    "inertias": lambda: a_map("plate", Axis("inertia", 0.01, 0.5)),
    "two distances": lambda: a_map("rod", Axis("a", 0.0, 0.2), Axis("b", 0.0, 0.2), friction=0.3, thickness=0.02),
    "heavy rod": lambda: a_map("rod", y=frictions(0.2), inertia=0.02, thickness=0.02),
    "tube": lambda: a_map("cylinder", inertia=0.9),
    "heavy core": lambda: a_map("cylinder", inertia=0.3),
    "two angles": lambda: a_map("cylinder", Axis("gamma", 0.0, 90.0), Axis("gamma_new", 0.0, 90.0), friction=0.4),
    "different edges": lambda: a_map("cylinder", gamma_new=70.0),
}


@pytest.fixture(scope="module", params=PLASTIC)
def plastic(request: pytest.FixtureRequest) -> ModeMap:
    return PLASTIC[request.param]()


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("plate", {}),
        ("plate", {"restitution": 0.4, "friction_old": 0.2}),
        ("plate", {"slip": -1.0, "a": 0.2}),
        ("rod", {"thickness": 0.03, "b": 0.05}),
        ("cylinder", {"gamma_new": 40.0, "inertia": 0.7}),
        ("cylinder", {"slip": 0.5, "restitution": 0.3}),
    ],
)
def test_a_cell_has_what_solve_impact_says_of_its_middle(name: str, law: str, given: dict[str, float]) -> None:
    modes = a_map(name, law=law, cells=25, **given)
    x, y = middles(modes.x, 25), middles(modes.y, 25)
    for row, column in np.random.default_rng(3).integers(0, 25, (40, 2)):
        body, twist = problem_at(
            SUBJECTS[name], {**modes.fixed, modes.x.name: float(x[column]), modes.y.name: float(y[row])}
        )
        path, total = solve_impact(body, twist, "path"), solve_impact(body, twist, "total")
        outcome = path if law == "path" else total
        cell = row, column
        assert (modes.mode[cell], modes.unique[cell]) == (outcome.mode, outcome.unique)
        assert (modes.path_unique[cell], modes.total_unique[cell]) == (path.unique, total.unique)
        assert modes.jammed[cell] == bool(path.flags & Flag.JAMMED)
        # Sines and cosines of arrays may round differently from those of numbers.
        assert modes.omega_ratio[cell] == pytest.approx(outcome.twist.omega / twist.omega, abs=1e-12)
        energy = 0.5 * (body.mass * (twist.vx**2 + twist.vy**2) + body.inertia * twist.omega**2)
        assert modes.energy_lost[cell] == pytest.approx(outcome.energy_lost / energy, rel=1e-12, abs=1e-12)


def changes(modes: ModeMap) -> NDArray[np.float64]:
    """The middles of the edges between cells of different modes, in cells from the lower left corner."""
    mode = modes.mode
    upright = np.argwhere(mode[:, 1:] != mode[:, :-1])[:, ::-1] + (1.0, 0.5)
    level = np.argwhere(mode[1:] != mode[:-1])[:, ::-1] + (0.5, 1.0)
    return np.concatenate([upright, level])


def beside_borders(modes: ModeMap, step: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points `step` cells to the left and to the right of the borders, in cells from the lower left corner."""
    corner = modes.x.low, modes.y.low
    size = (modes.x.high - modes.x.low) / CELLS, (modes.y.high - modes.y.low) / CELLS
    left, right = [], []
    for curves in borders_of(modes).values():
        for curve in curves:
            places = (curve - corner) / size
            places = places[np.append(True, np.any(places[1:] != places[:-1], axis=1))]
            along = np.diff(places, axis=0)
            across = step * np.stack([-along[:, 1], along[:, 0]], 1) / np.hypot(*along.T)[:, None]
            left.append(places[:-1] + 0.5 * along + across)
            right.append(places[:-1] + 0.5 * along - across)
    return np.concatenate(left), np.concatenate(right)


def test_where_modes_change_a_border_by_a_formula_is_within_a_cell(plastic: ModeMap) -> None:
    drawn, _ = beside_borders(plastic, 0.0)
    assert max(np.min(np.hypot(*(drawn - place).T)) for place in changes(plastic)) < 1.0


def test_a_border_by_a_formula_has_another_mode_on_either_side(plastic: ModeMap) -> None:
    # A curve between points 0.3 cells apart is off by less than 0.3^2 cells over its radius.
    left, right = beside_borders(plastic, 0.01)
    inside = np.all((np.minimum(left, right) > 0.0) & (np.maximum(left, right) < CELLS), axis=1)
    assert np.mean(inside) > 0.9
    modes = []
    for x, y in (left[inside].T / CELLS, right[inside].T / CELLS):
        places = zip((plastic.x, plastic.y), (x, y), strict=True)
        values = {axis.name: axis.low + (axis.high - axis.low) * place for axis, place in places} | plastic.fixed
        modes.append(solve_impacts(*problem_at(SUBJECTS[plastic.subject], values)).mode)
    assert np.all(modes[0] != modes[1])


def test_the_domains_of_fig_5_are_where_the_paper_has_them() -> None:
    modes, delta = a_map("plate"), middles(Axis("delta", 0.0, 2.0), CELLS)
    f = middles(frictions(1.5), CELLS)[:, None]
    tall = delta > 1.0 / np.sqrt(2.0)
    assert np.array_equal(modes.mode == Mode.STOP, ~tall & (f >= delta))
    assert np.array_equal(modes.mode == Mode.PIVOT, tall & (f >= 3.0 * delta / (4.0 * delta**2 + 1.0)))


def test_a_rod_of_400_mm_stops_from_115_5_mm_on_as_in_the_experiment() -> None:
    modes = a_map("rod", Axis("a", 0.11, 0.12))
    stops = middles(modes.x, CELLS)[np.any(modes.mode == Mode.STOP, axis=0)]
    assert np.min(stops) == pytest.approx(0.1155, abs=0.0001)


@pytest.mark.parametrize("given", [{"restitution": 0.1}, {"slip": 0.1}, {"friction_old": 0.1}, {"friction_new": 0.1}])
def test_no_border_is_drawn_where_its_formula_does_not_hold(given: dict[str, float]) -> None:
    assert borders_of(a_map("plate", cells=10, **given)) == {}
    (name,) = given
    assert borders_of(a_map("plate", Axis(name, 0.0, 1.0), cells=10)) == {}


def test_the_path_of_a_plate_that_slides_backwards_jams_where_painleve_says() -> None:
    modes = a_map("plate", Axis("delta", 0.05, 6.0), frictions(4.0), slip=-1.0)
    delta, f = middles(modes.x, CELLS), middles(modes.y, CELLS)[:, None]
    a, h, square = 0.5, 0.5 * delta, (1.0 + delta**2) / 12.0
    presses = f > (square + a * a) / (a * h)
    assert np.array_equal(modes.jammed, presses & (square < a * a + f * a * h))
    assert 0.2 < np.mean(modes.jammed) < 0.8


def test_the_path_of_a_plate_that_slides_backwards_is_not_unique_where_painleve_says() -> None:
    modes = a_map(
        "plate", Axis("inertia", 0.1, 2.0), Axis("friction_old", 0.0, 3.0), slip=-1.0, delta=4.0, friction_new=0.2
    )
    square, f = middles(modes.x, CELLS), middles(modes.y, CELLS)[:, None]
    a, h = 0.5, 2.0
    presses, many = f > (square + a * a) / (a * h), square > a * a + 0.2 * a * h
    assert np.array_equal(~modes.path_unique, presses & many)
    assert np.array_equal(modes.jammed, presses & ~many)
    assert np.mean(~modes.path_unique) > 0.3
    assert np.mean(modes.jammed) > 0.05


def test_the_total_law_of_a_cylinder_is_not_unique_where_its_edges_can_hold_it_and_it_need_not_stop() -> None:
    modes = a_map("cylinder")
    t, f = np.tan(np.radians(middles(modes.x, CELLS))), middles(modes.y, CELLS)[:, None]
    locks = cylindrical.locks(t, f) & (modes.mode != Mode.STOP)
    assert np.array_equal(~modes.total_unique, locks)
    assert np.mean(locks) > 0.1
    assert np.all(modes.path_unique)


def test_csv_has_a_line_for_each_cell(tmp_path: Path) -> None:
    modes = a_map("plate", Axis("delta", 0.05, 6.0), frictions(4.0), "total", 9, slip=-1.0)
    write_csv(tmp_path / "map.csv", modes)
    with (tmp_path / "map.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    truths = ("unique", "jammed", "path_unique", "total_unique")
    assert list(lines[0]) == ["delta", "friction", "mode", "segments", *truths, "omega_ratio", "energy_lost"]
    assert len(lines) == 81
    x, y = middles(modes.x, 9), middles(modes.y, 9)
    for number, line in enumerate(lines):
        cell = divmod(number, 9)
        assert [float(line["friction"]), float(line["delta"])] == [y[cell[0]], x[cell[1]]]
        assert Mode[line["mode"]] == modes.mode[cell]
        assert all(line[name] == str(int(getattr(modes, name)[cell])) for name in truths)
        assert all(float(line[name]) == getattr(modes, name)[cell] for name in ("omega_ratio", "energy_lost"))
        assert all(set(states) <= set("OS+-") for states in line["segments"].split())
    assert {line["jammed"] for line in lines} == {"0", "1"}


def test_the_summary_has_the_shares_of_the_modes() -> None:
    summary = summary_of(a_map("cylinder"))
    assert summary["shares"].keys() == {"STOP", "SLIDE", "PIVOT_SLIDE", "PIVOT"}  # as in the paper's figures
    assert sum(summary["shares"].values()) == pytest.approx(1.0)
    # Left of 60 degrees all above f = t / 3, whose integral is ln 2 / 3.
    left = 60.0 / 90.0 - np.degrees(np.log(2.0) / 3.0) / (90.0 * 1.5)
    assert summary["shares"]["PIVOT"] == pytest.approx(left, abs=0.005)
    assert summary["total_not_unique"] > 0.1
    assert summary["fixed"] == {"radius": 1.0, "restitution": 0.0, "slip": 0.0}


PICTURED = {
    "Fig. 5": PLASTIC["Fig. 5"],
    "tube": PLASTIC["tube"],
    "jams": lambda: a_map("plate", Axis("delta", 0.05, 6.0), frictions(4.0), slip=-1.0),
    "one mode": lambda: a_map("plate", Axis("delta", 0.1, 0.2), Axis("friction", 1.0, 2.0)),
    "two cells": lambda: a_map("cylinder", cells=2),
}


@pytest.mark.parametrize("shown", PICTURED)
def test_every_map_makes_a_picture_without_a_warning_and_writes_formulas_along_their_borders(
    tmp_path: Path, shown: str, recwarn: pytest.WarningsRecorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    modes, turned, turn = PICTURED[shown](), dict[str, tuple[float, float, float]](), Text.set_rotation

    def seen(text: Text, angle: float) -> None:
        turned[text.get_text().strip()] = (*text.get_position(), angle)
        turn(text, angle)

    monkeypatch.setattr(Text, "set_rotation", seen)
    write_map(tmp_path / "map.png", modes)
    for formula, curves in borders_of(modes).items():
        *place, angle = turned[formula]
        curve = max(curves, key=len)
        nearest = np.abs(curve - place).sum(axis=1).argmin()
        along = np.gradient(curve, axis=0)[nearest]
        assert abs(np.sin(np.arctan2(along[1], along[0]) - np.radians(angle))) < 0.5
        assert -90.0 < angle <= 90.0  # never upside down
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
    write_map(tmp_path / "map.svg", modes)
    first = (tmp_path / "map.svg").read_bytes()
    assert ElementTree.fromstring(first).tag.endswith("svg")
    write_map(tmp_path / "map.svg", modes)
    assert (tmp_path / "map.svg").read_bytes() == first
    # What is deprecated is between matplotlib and its own libraries.
    assert [str(one.message) for one in recwarn if not issubclass(one.category, DeprecationWarning)] == []


def test_the_sketch_of_a_cylinder_is_a_circle_about_its_mass_centre_through_the_edge_it_stands_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, file, **_: drawn.append(figure) or file.write_bytes(b""))
    write_map(tmp_path / "map.png", a_map("cylinder", cells=2))
    axes, sketch, side = drawn[0].axes
    whole, above, below = (one.get_position() for one in (axes, sketch, side))
    assert whole.x1 < min(above.x0, below.x0)
    assert below.y1 < above.y0
    (outline,) = sketch.patches
    assert isinstance(outline, Polygon)
    center, edge = (np.ravel(line.get_xydata()) for line in sketch.lines[:2])
    assert np.hypot(*(outline.get_xy() - center).T) == pytest.approx(np.hypot(*(edge - center)))


def test_axes_and_conditions_are_said_as_the_paper_does() -> None:
    plate, cylinder = a_map("plate", cells=2), a_map("cylinder", cells=2)
    assert axis_label(plate.x, plate).startswith("δ = H/L, ")
    assert axis_label(plate.y, plate).startswith("$f$, ")
    assert axis_label(cylinder.x, cylinder).startswith("$γ_1$, ")
    assert (
        conditions(plate) == "$L$ = 1 m, $a$ = L/2, $b$ = L/2, J/m = (L² + H²)/12, $e$ = 0, $v_{tA}$ = 0 m/s, path law"
    )
    one = a_map("cylinder", Axis("inertia", 0.1, 1.0), cells=2, slip=0.5, law="total")
    assert conditions(one) == "$γ_1$ = 45 °, $γ_2$ = $γ_1$, $R$ = 1 m, $e$ = 0, $v_{tA}$ = 0.5 m/s, total law"
