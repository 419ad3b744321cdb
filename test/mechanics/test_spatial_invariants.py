"""What holds for every impact in three dimensions, over random problems of up to eight contacts, by both laws."""

import json
from functools import partial

import numpy as np
import pytest
from spatial_invariants import LIMITS, SETTLED, broken_bounds, limits_of, main, violations
from spatial_problems import KINDS, ONE_FLOOR, problems_of

from impact_predictor import ContactPoints, solve_spatial_impact, solve_spatial_impacts
from impact_predictor.mechanics.types import ContactState

SEED, EACH = 20, 320
"""Problems of each kind and number of contacts: 20,480 in all."""


@pytest.mark.parametrize("law", ["path", "total"])
@pytest.mark.parametrize("kind", KINDS)
def test_twenty_thousand_random_impacts_violate_nothing(kind, law):
    source = np.random.default_rng(SEED)
    unanswered = []
    for n in range(1, 9):
        found = violations(problems_of(kind, n, source, EACH), law, otherwise=False)
        worst = {name: float(values.max()) for name, values in found.items()}
        unanswered += [float(found["unanswered"].mean())]
        assert {name: worst[name] for name, limit in limits_of(kind).items() if worst.get(name, 0.0) > limit} == {}
    if kind in ONE_FLOOR and law == "path":
        assert max(unanswered) == 0.0


@pytest.mark.parametrize("kind", ["floor", "nearly flat"])
@pytest.mark.parametrize("n", [1, 2, 4])
def test_an_impact_turned_mirrored_reordered_or_in_other_units_is_the_same(kind, n):
    # Steps so fine that the order in which the contacts are solved, and in which step a compression ends, count less
    # than the limit; they seldom count at all.
    solve = partial(solve_spatial_impacts, steps=128)
    found = violations(problems_of(kind, n, np.random.default_rng(SEED), EACH), "path", lambda *given: solve(*given))
    for name in ("turned", "mirrored", "reordered", "units"):
        assert found[name].max() <= LIMITS[name], name
        assert np.quantile(found[name], 0.9) <= 1e-9, name


@pytest.mark.parametrize("law", ["path", "total"])
def test_mechanisms_with_any_mobilities_gain_no_energy(law):
    # W = B B^T of as many rows as a mechanism has ways to move, and contact velocities that it can have.
    source = np.random.default_rng(SEED)
    for _ in range(500):
        n = int(source.integers(1, 9))
        rows = source.normal(size=(3 * n, int(source.integers(1, 3 * n + 1))))
        w, c = rows @ rows.T, rows @ source.normal(size=rows.shape[1])
        points = ContactPoints(np.zeros((n, 3)), source.uniform(0.0, 1.5, n), source.choice([0.0, 0.5, 1.0]))
        outcome = solve_spatial_impact(w, points, c, law)
        impulses, after = outcome.impulses, outcome.velocities
        size = np.abs(impulses).sum() + 1e-300
        speed = np.abs(c).max()
        assert after.ravel() == pytest.approx(c + w @ impulses.ravel(), abs=1e-12 * (speed + np.trace(w) * size))
        assert (np.hypot(*impulses[:, :2].T) <= points.friction * impulses[:, 2] + 1e-12 * size).all()
        work = 0.5 * impulses.ravel() @ (c + after.ravel())
        assert outcome.energy_lost == pytest.approx(-work, abs=1e-12 * size * speed)
        if not outcome.flags:
            assert work <= 1e-12 * size * speed
            assert after[:, 2].min() >= -LIMITS["approach"] * speed


@pytest.mark.parametrize("turns", [1, 3])
def test_a_contact_of_a_mechanism_may_be_seen_along_other_tangents(turns):
    source = np.random.default_rng(SEED)
    for _ in range(50):
        rows = source.normal(size=(9, 7))
        w, c = rows @ rows.T, rows @ source.normal(size=7)
        points = ContactPoints(np.zeros((3, 3)), 0.4, 0.5)
        seen = np.eye(9)
        for number in range(turns):
            angle = source.uniform(0.0, 2.0 * np.pi)
            cos, sin = np.cos(angle), np.sin(angle)
            seen[3 * number : 3 * number + 2, 3 * number : 3 * number + 2] = [[cos, -sin], [sin, cos]]
        one = solve_spatial_impact(w, points, c, steps=64)
        other = solve_spatial_impact(seen @ w @ seen.T, points, seen @ c, steps=64)
        assert other.velocities.ravel() @ seen == pytest.approx(one.velocities.ravel(), abs=SETTLED * np.abs(c).max())


@pytest.mark.parametrize(
    ("names", "change"),
    [
        (("finite",), lambda each: {"energy_lost": each.energy_lost * np.nan}),
        (("cone", "momentum"), lambda each: {"impulses": -each.impulses}),
        (("momentum", "velocities", "approach"), lambda each: {"twist": each.twist - [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]}),
        (("energy told",), lambda each: {"energy_lost": 1.1 * each.energy_lost}),
        (("states",), lambda each: {"states": np.full_like(each.states, int(ContactState.STICKS))}),
    ],
    ids=["not finite", "pulled", "pressed", "heated", "stuck"],
)
def test_an_impact_that_breaks_an_invariant_is_seen(names, change):
    def solve(*given):
        outcomes = solve_spatial_impacts(*given)
        return outcomes._replace(**change(outcomes))

    found = violations(problems_of("floor", 3, np.random.default_rng(SEED), 50), "path", solve, otherwise=False)
    for name in names:
        assert not (found[name] <= LIMITS[name]).all()


@pytest.mark.parametrize(
    ("tally", "broken"),
    [
        ({"cone": (50_000, 0, 0.0), "reordered, up to 1": (10_000, 100, 0.1), "unanswered": (9, 9, 1.0)}, []),
        ({"cone": (50_000, 1, 0.1), "reordered, up to 1": (10_000, 200, 0.1)}, ["cone", "reordered, up to 1"]),
        ({"turned, frictionless": (1_000, 7, 0.1)}, []),
        ({"turned, frictionless": (10_000, 70, 0.1)}, ["turned, frictionless"]),
    ],
    ids=["in bounds", "out of bounds", "chance", "no chance"],
)
def test_one_broken_limit_is_too_many_and_of_what_is_seldom_more_than_its_share(tally, broken):
    assert broken_bounds("path", "floor", tally) == broken


def test_a_count_that_breaks_a_bound_ends_with_its_name_and_the_next_goes_on_from_there(monkeypatch, tmp_path, capsys):
    resume = ["--resume", str(tmp_path / "state.json"), "--chunk", "20"]
    monkeypatch.setattr("sys.argv", ["spatial_invariants.py", "--problems", "60", *resume])
    main()
    monkeypatch.setattr("sys.argv", ["spatial_invariants.py", "--problems", "80", *resume])
    monkeypatch.setitem(LIMITS, "cone", -1.0)
    with pytest.raises(SystemExit, match="cone"):
        main()
    state = json.loads((tmp_path / "state.json").read_text())
    assert state["done"] == 4
    assert [sum(tally["cone"][1] for tally in state["tallies"].values() if tally)] == [40]
    assert "reordered" in capsys.readouterr().out
