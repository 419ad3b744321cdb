"""`impact-predictor bench invariants`: what it reports, and that a law that is wrong does not pass."""

from __future__ import annotations

import json
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import invoke

from impact_predictor import Contact, Outcomes, Twist, TwoPointBody, solve_impacts
from impact_predictor.commands import bench
from impact_predictor.mechanics import invariants
from impact_predictor.mechanics.invariants import CLAIMED, LIMITS, violations
from impact_predictor.mechanics.random_problems import KINDS, random_problems

BROKEN = 1
NAMES = {"Contact": Contact, "Twist": Twist, "TwoPointBody": TwoPointBody, "violations": violations}
"""What a line that computes a violation again uses."""

run = partial(invoke, "bench", "invariants")


@pytest.fixture
def loose(monkeypatch: pytest.MonkeyPatch) -> None:
    """Limits that nothing exceeds, for tests that are about the report."""
    monkeypatch.setattr(invariants, "LIMITS", dict.fromkeys(LIMITS, np.inf))


def wrong(change: dict[str, Any]) -> Any:
    """A law whose outcomes are changed: field -> what is done to it."""

    def solve(body: TwoPointBody, twist: Twist, law: str) -> Outcomes:
        outcomes = solve_impacts(body, twist, law)
        return outcomes._replace(**{name: how(getattr(outcomes, name)) for name, how in change.items()})

    return solve


def stopped_after(chunks: int) -> Any:
    """Random problems that Ctrl-C ends after so many chunks."""

    def some(*given: Any) -> Any:
        yield from islice(random_problems(*given), chunks)
        raise KeyboardInterrupt

    return some


def slipping_out(impulses: Any) -> Any:
    """Friction half as great again."""
    return impulses * (1.0, 1.5)


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"impulses": slipping_out}, "cone"),
        ({"twist": lambda twist: -twist}, "approach"),
        ({"twist": lambda twist: np.where(twist > 1.0, np.nan, twist)}, "finite"),
    ],
)
def test_a_law_that_is_wrong_is_caught(monkeypatch: pytest.MonkeyPatch, change: dict[str, Any], name: str) -> None:
    monkeypatch.setattr(invariants, "violations", partial(violations, solve=wrong(change)))
    result = run("--count", "1200", "--json")
    assert result.exit_code == BROKEN
    assert name in {one["invariant"] for one in json.loads(result.stdout)["invariants"] if one["broken_by"]}


def test_the_report_is_json_alone_if_asked_for(loose: None) -> None:
    result = run("--count", "2e3", "--seed", "5", "--law", "total", "--json")
    assert result.exit_code == 0
    report = json.loads(result.stdout)
    assert (report["problems"], report["seed"], report["laws"]) == (2000, 5, ["total"])
    assert not report["interrupted"]
    assert report["problems_per_second"] == pytest.approx(2000 / report["seconds"])
    assert [one["invariant"] for one in report["invariants"]] == list(LIMITS)
    assert all(one["law"] == "total" and not one["broken_by"] for one in report["invariants"])


def test_each_violation_has_the_problem_that_makes_it_again_to_the_last_bit(loose: None) -> None:
    report = json.loads(run("--count", "3400", "--json").stdout)
    made = [one for one in report["invariants"] if one["replay"] is not None]
    assert len(made) >= 8
    for one in made:
        with np.errstate(all="ignore"):
            assert float(eval(one["replay"], NAMES)) == one["worst"]
        assert one["invariant"] in CLAIMED.get(one["kind"], LIMITS)


def test_the_table_names_both_laws_and_the_worst_kind(loose: None) -> None:
    result = run("--count", "1e3")
    assert result.exit_code == 0
    assert "1,000 problems; " in result.stdout
    assert all(result.stdout.count(f"  {name}  ") == 2 for name in LIMITS)
    assert "from impact_predictor.mechanics.invariants import violations\nviolations(TwoPointBody(" in result.stdout


def test_what_exceeds_its_limit_is_said_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(invariants, "LIMITS", {**dict.fromkeys(LIMITS, np.inf), "momentum": 0.0})
    result = run("--count", "500", "--law", "path")
    assert result.exit_code == BROKEN
    *_, title, line = result.stdout.splitlines()
    assert title.startswith("Violated by more than rounding explains")
    law, _, kinds = line.partition(": ")
    assert law == "  momentum, path law"
    assert set(kinds.split(", ")) <= set(KINDS)
    assert len(kinds.split(", ")) > 6
    assert not any(kind.startswith("extreme") for kind in kinds.split(", "))  # nothing is claimed of their momentum


def test_ctrl_c_tells_what_was_found_so_far(loose: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(invariants, "random_problems", stopped_after(1))
    result = run("--count", "1200")
    assert result.exit_code == 130
    assert "\nInterrupted: 100 problems; " in result.stdout


def test_a_soak_that_was_stopped_goes_on_where_it_stood(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    arguments = "--count", "2400", "--seed", "3", "--json"
    at_once = json.loads(run(*arguments).stdout)
    file = tmp_path / "soak.json"
    monkeypatch.setattr(bench, "SAVE_EVERY", 0.0)
    with monkeypatch.context() as stopping:
        stopping.setattr(invariants, "random_problems", stopped_after(5))
        assert json.loads(run(*arguments, "--resume", str(file)).stdout)["problems"] == 1000
    resumed = json.loads(run(*arguments, "--resume", str(file)).stdout)
    assert resumed["problems"] == 2400
    assert resumed["invariants"] == at_once["invariants"]


@pytest.mark.parametrize("text", ["", "{}", '{"problems": [1, 2, "path"]}'])
def test_a_file_of_another_soak_is_refused_in_one_sentence(text: str, tmp_path: Path) -> None:
    file = tmp_path / "soak.json"
    file.write_text(text)
    result = run("--count", "100", "--resume", str(file))
    assert (result.exit_code, result.stdout) == (2, "")
    assert "cannot be gone on from" in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_a_violation_that_is_no_number_counts_as_endless(monkeypatch: pytest.MonkeyPatch) -> None:
    def all_nan(body: TwoPointBody, twist: Twist, law: str, names: Any) -> tuple[None, dict[str, Any]]:
        return None, {name: np.full(np.shape(body.mass), np.nan) for name in names}

    monkeypatch.setattr(invariants, "violations", all_nan)
    result = run("--count", "50", "--json")
    assert result.exit_code == BROKEN
    work = next(one for one in json.loads(result.stdout)["invariants"] if one["invariant"] == "work")
    assert (work["worst"], work["broken_by"]) == (None, [kind for kind in KINDS if "work" in CLAIMED.get(kind, LIMITS)])


@pytest.mark.parametrize("count", ["0", "-1", "1.5", "nan", "inf"])
def test_a_count_that_is_none_is_refused_in_one_sentence(count: str) -> None:
    result = run("--count", count)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "is not a whole number above 0, such as 1000000 or 1e6" in result.stderr
    assert len(result.stderr.splitlines()) == 1
