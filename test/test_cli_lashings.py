"""`impact-predictor lashings`: the shipped scene against the calculated example of the Code, and what is refused."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from command_line import invoke

ROOT = Path(__file__).parents[1]
SCENE = str(ROOT / "config/deck_lashed.yaml")
VESSEL = ("--vessel", "120", "20", "1.4", "15", "--position", "0.7")

run = partial(invoke, "lashings")


def balances(*arguments: str) -> dict[str, Any]:
    answer = json.loads(run(SCENE, *VESSEL, *arguments, "--json").stdout)
    return {one["name"]: one for one in answer["units"]["transformer"]["balances"]}


def test_the_shipped_transformer_has_the_balances_of_the_calculated_example() -> None:
    found = balances("--spray", "8", "12")
    assert found["sliding to port"]["acts"] == pytest.approx(384e3, rel=2e-3)
    assert found["sliding to port"]["holds"] == pytest.approx(412e3, rel=2e-3)
    assert found["sliding to starboard"]["holds"] == pytest.approx(422e3, rel=2e-3)
    assert found["tipping to port"]["acts"] == pytest.approx(691e3, rel=2e-3)
    assert found["sliding aft"]["acts"] == pytest.approx(184e3, rel=2e-3)
    assert found["sliding aft"]["shares"][-2:] == [0.0, pytest.approx(100e3)]


def test_below_deck_there_is_no_wind_and_the_alternative_method_counts_more_of_the_msl() -> None:
    below = balances("--deck", "tween", "--spray", "8", "12")
    assert below["sliding to port"]["acts"] == pytest.approx(5.6 * 0.889 * 62e3, rel=1e-3)
    alternative = balances("--deck", "tween", "--method", "alternative")
    shares = zip(alternative["sliding to port"]["shares"], below["sliding to port"]["shares"], strict=True)
    assert [more / less for more, less in shares if less] == [pytest.approx(1.5 / 1.35)] * 4


def test_the_accelerations_of_a_bag_stand_beside_those_of_the_annex() -> None:
    bag = ("--bag", str(ROOT / "examples/vessel_deck"), "--remap", "support/odom:=/deck/odom")
    unit = json.loads(run(SCENE, *VESSEL, *bag, "--json").stdout)["units"]["transformer"]
    # It rolls by up to 3 degrees.
    assert 0.2 < unit["measured"]["across"] < 1.5
    assert all(unit["measured"][axis] < unit["accelerations"][axis] for axis in ("along", "across", "up"))


def test_a_person_gets_a_table_for_each_unit() -> None:
    result = run(SCENE, *VESSEL)
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert lines[0] == "transformer: 62,000 kg, friction 0.3"
    assert any(line.split() == ["sliding", "to", "port", "44", "12", "3.70", "does", "not", "hold"] for line in lines)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((SCENE, "--vessel", "30", "8", "1", "9", "--position", "0.5"), "vessels of 50 to 300 m"),
        ((SCENE, *VESSEL, "--spray", "-1", "0"), "areas of 0 or more"),
        ((str(ROOT / "config/deck_drum.yaml"), *VESSEL), "no unit with contact points"),
        ((SCENE, *VESSEL, "--bag", "nowhere"), "nowhere"),
    ],
)
def test_what_cannot_be_balanced_is_refused_in_one_sentence(arguments: tuple[str, ...], said: str) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == 1
