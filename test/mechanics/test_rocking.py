"""Rocking on a fixed support: golden sequences, accumulation, sliding, restitution, the disc over its edges.

golden/motion.json: the three rods of Fig. 2 of Polukoshko and Sokolova in 40-digit arithmetic.
"""

from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from impact_predictor import Contact, InputError, Mode, TwoPointBody, cylinder, plate, rod
from impact_predictor.mechanics.motion import End, PlanarState, rock, standing
from impact_predictor.mechanics.motion.equations import rocking_body
from impact_predictor.mechanics.motion.support import FixedSupport

GOLDEN = json.loads((Path(__file__).parent / "golden" / "motion.json").read_text())["rocking"]
G = 9.81
EXACT = 1e-12
"""Some thousand roundings: exact formulas, one after another."""
STICKS = 1e3
"""Friction that holds."""


@pytest.mark.parametrize("case", GOLDEN, ids=lambda case: f"a = {case['a']}")
def test_the_rods_of_figure_2_strike_and_come_to_rest_as_the_golden_ones(case: dict[str, Any]) -> None:
    body = rod(float(case["length"]), 0.0, float(case["a"]), float(case["b"]), mass=0.3, friction=STICKS)
    run = rock(body, standing(body, math.radians(float(case["release_angle_deg"]))))
    assert len(run.impacts) >= 8
    for strike, golden in zip(run.impacts, case["impacts"], strict=False):
        assert strike.time == pytest.approx(float(golden["time"]), rel=EXACT)
        assert abs(strike.before.omega) == pytest.approx(float(golden["omega_before"]), rel=EXACT)
        assert abs(strike.after.omega) == pytest.approx(float(golden["omega_after"]), rel=EXACT)
        assert strike.outcome.mode is Mode.PIVOT
    (accumulation,) = run.accumulations
    golden_time = float(case["accumulation_time"])
    assert accumulation.time == pytest.approx(golden_time, rel=EXACT)
    assert abs(accumulation.time - golden_time) <= accumulation.error + 1e-15
    assert accumulation.contacts == (0, 1)
    assert accumulation.states == "SS"
    assert not accumulation.slides
    assert run.end is End.RESTS
    assert run.time == accumulation.time


def test_a_plate_passes_its_accumulation_while_it_slides() -> None:
    """L = 1, H = 1.6, f = 0.05, released at 0.02 rad while it slides at 3 m/s."""
    body = plate(1.0, 1.6, mass=10.0, friction=0.05)
    run = rock(body, standing(body, 0.02, slip=3.0))
    (accumulation,) = run.accumulations
    assert round(accumulation.time, 4) == 0.0844
    assert accumulation.states == "++"
    assert accumulation.slides
    speed = run.state(accumulation.time).vx
    assert round(speed, 2) == 2.96
    # Then friction stops it: both contacts carry the weight.
    assert run.end is End.RESTS
    assert run.time == pytest.approx(accumulation.time + speed / (0.05 * G), rel=1e-9)


@pytest.mark.parametrize("e", [0.3, 0.6])
def test_a_block_that_bounces_on_one_contact_accumulates_by_the_restitution(e: float) -> None:
    """A slab that would stop at B without restitution turns back about A with it, e times as fast, again and again."""
    body = plate(1.0, 0.2, mass=1.0, friction=STICKS, restitution=e)
    run = rock(body, standing(body, 1e-4))
    rates = [abs(strike.after.omega) / abs(strike.before.omega) for strike in run.impacts]
    assert {strike.outcome.mode for strike in run.impacts} == {Mode.BACK_PIVOT}
    assert rates == pytest.approx([e] * len(rates), rel=1e-9)
    (accumulation,) = run.accumulations
    # Hops last 2 w / alpha each; alpha changes by 1e-4 of itself in the first fall.
    first = run.impacts[0].time
    assert accumulation.time == pytest.approx(first * (1.0 + 2.0 * e / (1.0 - e)), rel=1e-4)
    assert run.end is End.RESTS


def test_unequal_arms_lose_two_ratios_in_turn_and_the_sum_of_the_rest_agrees_with_them() -> None:
    a, b, square = 0.06, 0.09, 0.4**2 / 12.0
    body = rod(0.4, 0.0, a, b, mass=1.0, friction=STICKS)
    run = rock(body, standing(body, 0.1))
    wanted = {1: (square - a * b) / (square + b * b), 0: (square - a * b) / (square + a * a)}
    for strike in run.impacts:
        assert abs(strike.after.omega / strike.before.omega) == pytest.approx(wanted[strike.new], rel=EXACT)
    (accumulation,) = run.accumulations
    ratio, times = wanted[0] * wanted[1], [strike.time for strike in run.impacts]
    limit = times[-1] + (times[-1] - times[-3]) * ratio / (1.0 - ratio)
    assert accumulation.time == pytest.approx(limit, rel=1e-11)
    assert run.end is End.RESTS


def test_on_a_steep_slope_a_body_slides_for_ever() -> None:
    body = plate(1.0, 0.3, mass=1.0, friction=0.2)
    slope = math.radians(-20.0)  # the x axis falls
    run = rock(body, standing(body, 0.0), FixedSupport(slope), duration=7.0)
    assert run.end is End.TIME_UP
    assert [phase.states for phase in run.phases] == ["++"]
    drive = G * (math.sin(-slope) - 0.2 * math.cos(slope))
    assert run.state(7.0).vx == pytest.approx(7.0 * drive, rel=EXACT)
    assert run.state(7.0).x - run.state(0.0).x == pytest.approx(0.5 * 49.0 * drive, rel=EXACT)


def test_on_a_gentle_slope_it_slides_to_a_stop() -> None:
    body = plate(1.0, 0.3, mass=1.0, friction=0.5)
    slope = math.radians(-10.0)
    run = rock(body, standing(body, 0.0, slip=1.5), FixedSupport(slope))
    drag = G * (0.5 * math.cos(slope) - math.sin(-slope))
    assert [phase.states for phase in run.phases] == ["++", "SS"]
    assert run.end is End.RESTS
    assert run.time == pytest.approx(1.5 / drag, rel=EXACT)
    assert run.states(run.time + 1.0) == "SS"
    assert run.state(run.time + 5.0) == pytest.approx(run.state(run.time))


def test_a_tall_body_pushed_too_hard_overturns() -> None:
    body = plate(0.5, 2.0, mass=1.0, friction=1.0)
    run = rock(body, standing(body, 0.0, 2.0))
    assert run.end is End.OVERTURNED
    assert run.state(run.time).angle == pytest.approx(0.5 * math.pi, rel=EXACT)
    assert run.impacts == ()
    held = rock(body, standing(body, 0.0, 0.3))
    assert held.end is End.RESTS


def test_bouncing_on_one_edge_within_bouncing_on_both_comes_to_rest() -> None:
    """Each touchdown on edge 0 is followed by infinitely many hops on edge 1, and there are infinitely many such."""
    body = cylinder(1.0, 0.5, mass=1.0, friction=1.3, gamma_new=0.6, restitution=0.16)
    start = standing(body, 0.0)
    run = rock(body, start._replace(y=start.y + 0.3))
    inner = [accumulation for accumulation in run.accumulations if accumulation.contacts == (1,)]
    assert len(inner) > 3
    assert run.accumulations[-1].contacts == (0, 1)
    assert run.end is End.RESTS
    assert len(run.impacts) < 500
    spans = [other.time - one.time for one, other in pairwise(inner)]
    assert all(later < earlier for earlier, later in pairwise(spans))


def test_a_flat_drop_strikes_both_contacts_at_once() -> None:
    body = plate(1.0, 0.4, mass=1.0, friction=0.3)
    start = standing(body, 0.0)
    run = rock(body, start._replace(y=start.y + 0.5))
    assert run.impacts[0].time == pytest.approx(math.sqrt(2.0 * 0.5 / G), rel=EXACT)
    assert len(run.impacts) == 1
    assert run.end is End.RESTS


@pytest.mark.parametrize("inertia", [1e-9, 1e-6])
def test_a_point_mass_that_slips_before_its_impact_is_caught_by_both_contacts_and_slides(inertia: float) -> None:
    """An error of 1e-8 of the rate before the impact, which a stiff slip easily makes, would let it pivot."""
    x, y = math.sin(math.pi / 8.0), -math.cos(math.pi / 8.0)
    body = TwoPointBody(1.0, inertia, Contact(-x, y, 0.4), Contact(x, y, 0.4))
    run = rock(body, standing(body, math.pi / 8.0), FixedSupport(-0.08, 9.8))
    assert [impact.outcome.mode for impact in run.impacts] == [Mode.SLIDE]
    assert run.end is End.RESTS


def test_the_cylinder_rolls_from_edge_to_edge_with_the_papers_ratio() -> None:
    """PIVOT of section 4: w1 / w = (3 - t^2) / (3 (1 + t^2)), t = tan gamma; the centre's speed is R w."""
    gamma = 0.6
    body = cylinder(0.3, gamma, mass=2.0, friction=STICKS)
    run = rock(body, standing(body, 0.2))
    t = math.tan(gamma)
    ratio = (3.0 - t * t) / (3.0 * (1.0 + t * t))
    for strike in run.impacts:
        assert strike.outcome.mode is Mode.PIVOT
        assert strike.after.omega / strike.before.omega == pytest.approx(ratio, rel=EXACT)
    assert len(run.accumulations) == 1
    assert run.end is End.RESTS
    # The first fall turns about edge 0, from rest: energy.
    first = run.impacts[0]
    drop = 0.3 * (math.cos(gamma - 0.2) - math.cos(gamma))
    assert 0.5 * 1.5 * (0.3 * first.before.omega) ** 2 == pytest.approx(G * drop, rel=EXACT)


def test_a_disc_that_spins_between_its_edges_is_braked_by_both() -> None:
    """Both contacts slip; the two normal forces carry the weight, friction on the rim stops the spin."""
    gamma, f, radius = 0.5, 0.2, 0.3
    body = cylinder(radius, gamma, mass=2.0, friction=f)
    run = rock(body, standing(body, 0.0, slip=1.5))
    assert [phase.states for phase in run.phases] == ["++", "SS"]
    # N0 + N1 from the balance of forces on the two lines n - f t.
    c, s = math.cos(gamma), math.sin(gamma)
    forces = np.linalg.solve(np.array([[s - f * c, -s - f * c], [c + f * s, c - f * s]]), np.array([0.0, G]))
    brake = f * forces.sum() * radius / (0.5 * radius)  # of the rim's speed: R times the torque over J
    assert run.time == pytest.approx(1.5 / brake, rel=EXACT)
    assert run.end is End.RESTS
    state = run.state(0.5 * run.time)
    assert (state.vx, state.vy) == (0.0, 0.0)
    assert state.omega == pytest.approx(0.5 * 1.5 / radius, rel=EXACT)


def test_a_disc_may_roll_out_of_its_gap() -> None:
    body = cylinder(0.3, 0.3, mass=2.0, friction=STICKS)
    run = rock(body, standing(body, 0.1, 4.0))
    assert run.end is End.OVERTURNED
    assert run.state(run.time).x < 0.0


def test_the_state_may_be_asked_for_at_one_time_or_at_many() -> None:
    body = plate(1.0, 1.6, mass=1.0, friction=0.1)
    run = rock(body, standing(body, 0.3, slip=0.4))
    times = np.linspace(-1.0, run.time + 1.0, 60).reshape(3, 20)
    many = run.state(times)
    for index in np.ndindex(3, 20):
        one = run.state(float(times[index]))
        assert all(isinstance(value, float) for value in one)
        assert [part[index] for part in many] == pytest.approx(list(one), abs=1e-15)
    assert many.x.shape == (3, 20)
    assert run.state(-1.0) == run.state(0.0)
    assert run.state(0.0) == pytest.approx(standing(body, 0.3, slip=0.4), abs=1e-12)


def test_at_an_impact_the_state_is_the_one_after_it() -> None:
    body = plate(1.0, 1.6, mass=1.0, friction=0.5)
    run = rock(body, standing(body, 0.3))
    for strike in run.impacts[:5]:
        assert run.state(strike.time) == pytest.approx(strike.after, rel=1e-12, abs=1e-12)


def test_both_laws_answer_the_impacts() -> None:
    body = plate(1.0, 1.6, mass=1.0, friction=0.5)
    one, other = (rock(body, standing(body, 0.2), law=law) for law in ("path", "total"))
    assert {strike.outcome.law for strike in other.impacts} == {"total"}
    # For the paper's plate both laws give the same velocity.
    assert other.accumulations[0].time == pytest.approx(one.accumulations[0].time, rel=1e-12)


def test_uneven_feet_rest_at_an_angle() -> None:
    body = TwoPointBody(1.0, 0.2, Contact(-0.5, -0.4, 0.5), Contact(0.5, -0.5, 0.5))
    start = standing(body, 0.0)
    assert start.angle == pytest.approx(math.atan(0.1))
    run = rock(body, standing(body, 0.1))
    assert run.end is End.RESTS
    assert run.state(run.time).angle == pytest.approx(start.angle, abs=1e-12)


def test_full_turns_in_the_given_angle_stay_in_the_answer() -> None:
    body = plate(1.0, 1.6, mass=1.0, friction=0.5)
    start = standing(body, 0.2)
    turned = rock(body, start._replace(angle=start.angle + 4.0 * math.pi))
    plain = rock(body, start)
    assert turned.impacts[0].before.angle == pytest.approx(4.0 * math.pi, abs=1e-12)
    assert turned.time == pytest.approx(plain.time, rel=1e-9)  # 4 pi takes two digits from the angle


def test_slip_that_jams_stops_at_once() -> None:
    """A contact with much friction that is pushed ahead of the mass centre: no finite reaction (Painleve)."""
    body = TwoPointBody(1.0, 0.05, Contact(-0.1, -1.0, 3.0), Contact(1.0, -1.0, 3.0))
    run = rock(body, standing(body, 0.3, slip=1.0))
    assert run.jams
    assert run.jams[0] == 0.0
    after = run.state(0.0)
    before = standing(body, 0.3, slip=1.0)
    arm = (before.x - 0.0, before.y)
    # The contact stops; the angular momentum about it stays.
    assert after.vx + after.omega * after.y == pytest.approx(0.0, abs=1e-12)
    momentum = [0.05 * s.omega + arm[0] * s.vy - arm[1] * s.vx for s in (before, after)]
    assert momentum[0] == pytest.approx(momentum[1], rel=1e-12)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_numbers_that_are_none_give_a_named_end(value: float) -> None:
    body = plate(1.0, 1.6, mass=1.0, friction=0.5)
    start = standing(body, 0.2)
    run = rock(body, start._replace(vx=value))
    assert run.end is End.INVALID_INPUT
    assert run.impacts == ()
    assert run.phases == ()
    assert rock(body, start, duration=value).end is End.INVALID_INPUT
    assert rock(body._replace(mass=-1.0), start).end is End.INVALID_INPUT


def test_what_does_not_rock_is_refused() -> None:
    one = TwoPointBody(1.0, 1.0, None, Contact(0.0, -1.0, 0.5))
    with pytest.raises(InputError, match="two contacts"):
        standing(one, 0.0)
    wedge = TwoPointBody(1.0, 1.0, Contact(-1.0, -1.0, 0.5, (0.6, 0.8)), Contact(1.0, -1.0, 0.5))
    with pytest.raises(InputError, match="neither"):
        rock(wedge, PlanarState(0.0, 1.0, 0.0, 0.0, 0.0, 0.0))
    same = TwoPointBody(1.0, 1.0, Contact(0.0, -1.0, 0.5), Contact(0.0, -1.0, 0.5))
    with pytest.raises(InputError, match="one place"):
        standing(same, 0.0)
    body = plate(1.0, 1.6, mass=1.0, friction=0.5)
    with pytest.raises(ValueError, match="law"):
        rock(body, standing(body, 0.1), law="neither")


@pytest.mark.parametrize("turn", [-0.6, 0.0, 0.6])
def test_a_disc_rocks_on_edges_anywhere_about_it_if_the_new_one_is_ahead(turn: float) -> None:
    def edge(angle: float) -> Contact:
        sine, cosine = math.sin(turn + angle), math.cos(turn + angle)
        return Contact(0.2 * sine, -0.2 * cosine, 0.5, (-sine, cosine))

    disc = rocking_body(TwoPointBody(1.0, 0.02, edge(-0.3), edge(0.4)))
    assert disc.rolls
    with pytest.raises(InputError, match="contact 1 ahead"):
        rocking_body(TwoPointBody(1.0, 0.02, edge(0.4), edge(-0.3)))


def test_an_endless_motion_ends_with_the_events_allowed() -> None:
    body = plate(1.0, 0.2, mass=1.0, friction=STICKS, restitution=1.0)
    run = rock(body, standing(body, 0.01), duration=1e6, max_events=500)
    assert run.end is End.TOO_MANY_EVENTS


def test_a_body_that_trembles_takes_as_many_steps_in_all_as_events_are_allowed() -> None:
    # m l^2 is 1e13 times the inertia, and nothing holds the foot: to follow what happens in 2 s would take minutes.
    x, y = 100.0 * math.sin(math.pi / 3.0), -50.0
    light = TwoPointBody(1e6, 1e-3, Contact(-x, y, 0.0), Contact(x, y, 0.0))
    run = rock(light, standing(light, -math.pi / 3.0), FixedSupport(0.3, 1e-3), duration=2.0, max_events=300)
    assert run.end is End.TOO_MANY_EVENTS
    assert 0.0 < run.time < 2.0
