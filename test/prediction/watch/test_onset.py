"""OnsetMargins against sliding and tipping: against the planar formulas, statics in space, and the simulated motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from harmonic_deck import Wave, harmonic_support
from scipy.optimize import brentq, linprog, minimize_scalar
from scipy.spatial.transform import Rotation

from impact_predictor import TwoPointBody, cylinder, plate
from impact_predictor.mechanics.motion import rock, standing
from impact_predictor.mechanics.motion.support import MovingSupport
from impact_predictor.prediction.watch.onset import FULL, Onset, OnsetMargins, first_times, motions
from impact_predictor.prediction.watch.stance import Edge, StandingBody, edges_of, outline

ROUNDING = 1e-11
"""Some thousands of roundings of numbers of size one: a ratio divides by levers down to a tenth."""

UP = (0.0, 0.0, 1.0)
RANDOM_STANCES = 200
FIVE = [(-0.4, -0.3, 0.0), (0.5, -0.3, 0.0), (0.6, 0.1, 0.0), (0.4, 0.4, 0.0), (-0.4, 0.3, 0.0)]


def motion(gravity: Any, angular: Any = (0.0, 0.0, 0.0), turning: Any = (0.0, 0.0, 0.0)) -> Any:
    return motions(*(np.array([part], dtype=float) for part in (gravity, angular, turning)))[:, 0]


def on_points(points: Any, center: Any, mass: float, inertia: Any, friction: float, normal: Any = UP) -> StandingBody:
    """A body on points of the support."""
    corners = outline([tuple(map(float, point)) for point in points], normal)
    edges = tuple(edge for edge, _ in edges_of(corners, normal))
    return StandingBody(mass, friction, normal, tuple(map(float, center)), tuple(map(tuple, inertia)), edges)


def of_one(stance: StandingBody, *felt: Any) -> OnsetMargins:
    return Onset([stance]).margins(motion(*felt))


def planar(body: TwoPointBody, x: float = 0.0) -> StandingBody:
    """A body of the plane (y forward, z up) with contact 0 at x, by its two points alone."""
    assert body.old is not None
    feet = [(0.0, x, 0.0), (0.0, x + body.new.x - body.old.x, 0.0)]
    tensor = np.diag([body.inertia, 1.0, 1.0])
    return on_points(feet, (0.0, x - body.old.x, -body.old.y), body.mass, tensor, body.old.friction)


def on_edges(body: TwoPointBody) -> StandingBody:
    """A cylinder in the same plane over two edges of the support, the first one at the origin."""
    assert body.old is not None
    line = [(0.0, 0.0, 0.0), (0.0, body.new.x - body.old.x, body.new.y - body.old.y)]
    edges = tuple(edge for edge, _ in edges_of(line, UP))
    center = (0.0, -body.old.x, -body.old.y)
    inertia = tuple(map(tuple, np.diag([body.inertia, 1.0, 1.0]).tolist()))
    radius = math.hypot(body.old.x, body.old.y)
    return StandingBody(body.mass, body.old.friction, UP, center, inertia, edges, radius)


def test_in_a_plane_the_margins_are_those_of_the_planar_formulas() -> None:
    rng = np.random.default_rng(1)
    for _ in range(RANDOM_STANCES):
        back, ahead, h, y = *rng.uniform(0.1, 0.5, 2), rng.uniform(0.2, 1.0), rng.uniform(-5.0, 5.0)
        mass, rho, friction = rng.uniform(1.0, 50.0), rng.uniform(0.1, 0.5), rng.uniform(0.1, 1.0)
        fy, fz = rng.uniform(-4.0, 4.0), rng.uniform(-12.0, -8.0)
        rate, spin_up = rng.uniform(-0.5, 0.5, 2)
        feet = [(0.0, y - back, 0.0), (0.0, y + ahead, 0.0)]
        stance = on_points(feet, (0.0, y, h), mass, np.diag([mass * rho**2, 1.0, 1.0]), friction)
        found = of_one(stance, (0.0, fy, fz), (rate, 0.0, 0.0), (spin_up, 0.0, 0.0))
        a_t = fy + spin_up * h + rate**2 * y
        a_n = -(fz - spin_up * y + rate**2 * h)
        forth = (h * a_t + rho**2 * spin_up) / (ahead * a_n)
        back_again = (-h * a_t - rho**2 * spin_up) / (back * a_n)
        assert found.slide[0] == pytest.approx(abs(a_t) / (friction * a_n), rel=ROUNDING)
        assert found.tip[0] == pytest.approx(max(forth, back_again), rel=ROUNDING)
        assert stance.edges[found.edge[0]].name == ("port" if forth > back_again else "starboard")


def test_in_space_it_tips_where_no_pushing_reactions_can_hold_it() -> None:
    rng = np.random.default_rng(2)
    tipping = 0
    for _ in range(RANDOM_STANCES):
        turn = Rotation.random(random_state=rng.integers(2**31)).as_matrix()
        normal = turn[:, 2]
        feet = [turn @ [*rng.uniform(-0.5, 0.5, 2), 0.0] for _ in range(rng.integers(3, 8))]
        middle = np.mean(feet, axis=0)
        center = middle + normal * rng.uniform(0.3, 1.0)
        spread = rng.uniform(-1.0, 1.0, (3, 3))
        mass, inertia = rng.uniform(1.0, 20.0), spread @ spread.T + 0.1 * np.eye(3)
        gravity = turn @ [*rng.uniform(-3.0, 3.0, 2), -9.81]
        angular, turning = rng.uniform(-0.7, 0.7, (2, 3))
        felt = gravity - np.cross(turning, center) - np.cross(angular, np.cross(angular, center))
        moment = inertia @ turning + np.cross(angular, inertia @ angular)
        # Reactions: one push at each foot and a force along the support, that hold the body where the support takes it.
        along = [turn[:, 0], turn[:, 1]]
        pushes = [np.concatenate((normal, np.cross(foot - center, normal))) for foot in feet]
        drags = [np.concatenate((way, np.cross(middle - center, way))) for way in along]
        yaw = np.concatenate((np.zeros(3), normal))
        holds = linprog(
            np.zeros(len(feet) + 3),
            A_eq=np.array([*pushes, *drags, yaw]).T,
            b_eq=np.concatenate((-mass * felt, moment)),
            bounds=[(0.0, None)] * len(feet) + [(None, None)] * 3,
        ).success
        stance = on_points(feet, center, mass, inertia, 0.5, tuple(normal))
        found = of_one(stance, gravity, angular, turning)
        if abs(found.tip[0] - 1.0) > 1e-6:  # the linear program's own tolerance
            assert holds == (found.tip[0] < 1.0)
            tipping += not holds
    assert RANDOM_STANCES // 10 < tipping < RANDOM_STANCES - RANDOM_STANCES // 10


def first_onset(stance: StandingBody, support: MovingSupport, end: float) -> tuple[float, OnsetMargins]:
    """The first time at which a ratio reaches 1 over a planar support, and the margins then."""
    onset = Onset([stance])

    def margins(time: float) -> OnsetMargins:
        x, y, rate, spin_up = support.felt_exactly(time)
        return onset.margins(motion((0.0, x, y), (rate, 0.0, 0.0), (spin_up, 0.0, 0.0)))

    def most(time: float) -> float:
        found = margins(time)
        return max(float(found.slide[0]), float(found.tip[0])) - 1.0

    times = np.linspace(0.0, end, 2001)
    k = next(k for k, time in enumerate(times) if most(time) > 0.0)
    time = float(brentq(most, times[k - 1], times[k], xtol=1e-12))
    return time, margins(time)


CRATE = plate(length=0.8, height=1.0, mass=50.0, friction=0.9)
SMOOTH = plate(length=0.8, height=0.5, mass=50.0, friction=0.3)
FLYWHEEL = plate(length=0.8, height=1.0, mass=50.0, friction=0.9, inertia=60.0)
DRUM = cylinder(radius=0.3, gamma=0.3, gamma_new=0.4, mass=40.0, friction=0.3)
SLICK = cylinder(radius=0.3, gamma=0.7, mass=40.0, friction=0.004)
BRISK = harmonic_support(angle=(Wave(0.3, 1.6), Wave(0.05, 3.1)), x=(Wave(1.2, 1.3),), y=(Wave(0.8, 1.1),))
ROLL = harmonic_support(angle=(Wave(0.5, 1.2),), y=(Wave(0.5, 1.7),))
"""At rest at the start, and later far from it: the first onset is a crossing, not a graze."""


@pytest.mark.parametrize(
    ("body", "stance_of", "support", "kind"),
    [
        (CRATE, planar, BRISK.at(4.0, 2.5), "tip"),
        (CRATE, planar, ROLL.at(-3.0, 1.0), "tip"),
        (FLYWHEEL, planar, ROLL.at(-3.0, 1.0), "tip"),
        (SMOOTH, planar, BRISK.at(4.0, 2.5), "slide"),
        (SMOOTH, planar, ROLL.at(-3.0, 1.0), "slide"),
        (DRUM, on_edges, ROLL.at(2.0, 1.0), "tip"),
        (DRUM, on_edges, BRISK.at(-2.0, 1.0), "tip"),
        # It spins where friction on both edges no longer turns it with the support.
        (SLICK, on_edges, harmonic_support(angle=(Wave(0.05, 3.0),)), "slide"),
    ],
)
def test_a_simulated_body_leaves_its_rest_when_the_ratio_reaches_one(
    body: TwoPointBody, stance_of: Callable[[TwoPointBody], StandingBody], support: MovingSupport, kind: str
) -> None:
    """The simulation is told nothing of margins: it looks for the reactions that hold the body."""
    run = rock(body, standing(body, 0.0), support, duration=10.0)
    assert run.phases[0].states == "SS"
    time, margins = first_onset(stance_of(body), support, 10.0)
    assert getattr(margins, kind)[0] == pytest.approx(1.0, abs=1e-8)
    assert run.phases[0].end == pytest.approx(time, abs=1e-6)


def test_a_drum_slips_along_its_axis_by_friction_on_both_edges() -> None:
    body = cylinder(radius=0.3, gamma=math.pi / 3.0, mass=40.0, friction=0.5)
    # Each edge carries the whole weight: two reactions at 60 degrees to the vertical.
    assert of_one(on_edges(body), (3.0, 0.0, -9.81)).slide[0] == pytest.approx(3.0 / (0.5 * 2.0 * 9.81))


def test_a_drum_without_friction_slips_with_the_least_push_along_its_axis_and_rests_without_one() -> None:
    body = on_edges(cylinder(radius=0.3, gamma=0.3, mass=40.0, friction=0.0))
    assert of_one(body, (0.0, 0.0, -9.81)).slide[0] == 0.0
    assert of_one(body, (1e-3, 0.0, -9.81)).slide[0] == FULL


@pytest.mark.parametrize("felt", [(0.0, 1.0, 0.5), (0.0, 0.0, 0.0)])
def test_what_weighs_nothing_on_the_deck_has_lifted_with_finite_ratios(felt: Any) -> None:
    found = of_one(planar(CRATE), felt)
    assert found.lifted[0]
    assert found.slide[0] == found.tip[0] == FULL


def test_without_friction_anything_but_a_level_deck_makes_it_slide() -> None:
    stance = planar(CRATE)._replace(friction=0.0)
    assert of_one(stance, (0.0, 0.0, -9.81)).slide[0] == 0.0
    assert of_one(stance, (0.0, 1e-6, -9.81)).slide[0] == FULL


def test_on_points_of_a_line_only_the_plane_of_the_line_is_judged() -> None:
    stance = planar(CRATE)
    assert [edge.name for edge in stance.edges] == ["starboard", "port"]
    assert of_one(stance, (9.0, 0.0, -9.81)).tip[0] == 0.0
    third = [(0.0, -0.4, 0.0), (0.0, 0.1, 0.0), (0.0, 0.4, 0.0)]
    assert on_points(third, (0.0, 0.0, 0.5), 1.0, np.eye(3), 0.5).edges == planar(CRATE, -0.4).edges


def test_the_outline_is_the_convex_hull_whatever_lies_within_it() -> None:
    rng = np.random.default_rng(3)
    square = [(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)]
    within = [(*rng.uniform(-0.9, 0.9, 2), 0.0) for _ in range(20)] + [(0.0, -1.0, 0.0)]
    corners = outline(within[:10] + square + within[10:], UP)
    assert set(corners) == set(square)
    assert sorted(edge.name for edge, _ in edges_of(corners, UP)) == ["aft", "fore", "port", "starboard"]


def test_edges_are_named_by_the_axes_of_the_deck() -> None:
    around = [(math.cos(k * math.pi / 4), math.sin(k * math.pi / 4), 0.0) for k in range(8)]
    octagon = [Rotation.from_euler("z", 22.5, degrees=True).apply(point).tolist() for point in around]
    names = [edge.name for edge, _ in edges_of([tuple(point) for point in octagon], UP)]
    assert names == ["fore-port", "port", "aft-port", "aft", "aft-starboard", "starboard", "fore-starboard", "fore"]
    # With an axis that points down y is starboard.
    corners = [(1.0, 1.0, 0.0), (1.0, -1.0, 0.0), (-1.0, -1.0, 0.0), (-1.0, 1.0, 0.0)]
    sides = {edge.name: edge.outward[1] for edge, _ in edges_of(corners, (0.0, 0.0, -1.0))}
    assert sides["port"] < 0.0 < sides["starboard"]


def test_the_energy_to_topple_is_what_lifts_the_mass_centre_over_the_easiest_edge() -> None:
    rng = np.random.default_rng(4)
    for _ in range(20):
        feet = [(-0.4, -0.3, 0.0), (0.5, -0.3, 0.0), (0.4, 0.4, 0.0), (-0.4, 0.3, 0.0)]
        center, gravity = np.array([0.0, 0.0, 0.7]), np.array([*rng.uniform(-2.0, 2.0, 2), -9.81])
        stance = on_points(feet, center, 30.0, np.eye(3), 0.5)
        (least,), (easiest,) = Onset([stance]).barriers(motion(gravity))

        def work(edge: Edge, center: Any = center, gravity: Any = gravity) -> float:
            along = np.cross(UP, edge.outward)

            def potential(angle: float) -> float:
                arm = Rotation.from_rotvec(angle * along).apply(center - edge.point)
                return 30.0 * float(gravity @ arm)

            return potential(0.0) + minimize_scalar(potential, bounds=(0.0, 1.5), method="bounded").fun * -1.0

        works = [work(edge) for edge in stance.edges]
        # The search for the highest point stops at 1e-5 rad, where the energy is flat to the square of that.
        assert least == pytest.approx(min(works), rel=1e-6)
        assert easiest == int(np.argmin(works))


@pytest.mark.parametrize("felt", [(20.0, 0.0, -9.81), (0.0, 0.0, 1.0)], ids=["tips", "lifts"])
def test_a_body_that_tips_or_lifts_needs_no_energy_to_topple(felt: Any) -> None:
    (least,), _ = Onset([on_points(FIVE, (0.0, 0.0, 0.7), 30.0, np.eye(3), 0.5)]).barriers(motion(np.array(felt)))
    assert least == 0.0


def test_many_bodies_at_many_times_are_as_each_alone() -> None:
    rng = np.random.default_rng(5)
    stances = [planar(CRATE), on_edges(DRUM), planar(SMOOTH, 3.0)._replace(friction=0.0), on_edges(DRUM)]
    stances.append(on_points(FIVE, (0.0, 0.0, 0.7), 30.0, np.eye(3), 0.5))
    stances.append(on_edges(DRUM)._replace(edges=on_edges(DRUM).edges[:1]))
    felt = np.array([0.0, 0.0, -9.81]) + rng.uniform(-3.0, 3.0, (20, 3)), *rng.uniform(-0.5, 0.5, (2, 20, 3))
    together = Onset(stances).margins(motions(*felt))
    # Two rest first on three points, the drum on one edge, and all are replaced: some at once, one by one the others.
    begun = [planar(CRATE, 3.0)] * 2 + [stances[0], stances[5], stances[0], on_edges(DRUM)]
    onset = Onset(begun)
    for numbers in ((0, 1), (2,), (3, 4, 5)):
        for number in numbers:
            onset.replace(number, stances[number])
        changed = onset.margins(motions(*felt))
    for part, other in zip(together, changed, strict=True):
        assert part == pytest.approx(other, rel=ROUNDING, abs=ROUNDING)
    for n, stance in enumerate(stances):
        for k in range(20):
            alone = of_one(stance, *(part[k] for part in felt))
            assert together.slide[n, k] == pytest.approx(alone.slide[0], rel=ROUNDING)
            assert together.tip[n, k] == pytest.approx(alone.tip[0], rel=ROUNDING, abs=ROUNDING)
            assert together.lifted[n, k] == alone.lifted[0]


def test_the_time_at_which_a_margin_is_used_up_is_that_of_a_line_between_two_times() -> None:
    ratios = np.array([[1.5, 2.0, 0.0], [1.0, 1.0, 1.0], [0.5, 0.75, 1.25], [0.0, 1.0, 0.5], [0.0, 0.9, 0.5]])
    # Used up from the start, or never.
    assert first_times(ratios, np.array([2.0, 3.0, 5.0])).tolist() == [2.0, 2.0, 4.0, 3.0, math.inf]
