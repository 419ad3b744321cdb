"""What is told of a foot is a record: it has names, a value, and is as it was made."""

from __future__ import annotations

import pickle
from copy import deepcopy

from impact_predictor import Foot

SWINGS = Foot("left", stands=False, since=5, gap=0.1, approach=0.4, lead_time=0.25, place=(1.0, 2.0, 3.0))


def test_feet_are_equal_where_all_that_is_told_of_them_is() -> None:
    same = Foot("left", stands=False, since=5, gap=0.1, approach=0.4, lead_time=0.25, place=(1.0, 2.0, 3.0))
    assert same == SWINGS
    assert hash(same) == hash(SWINGS)
    others = {"name": "right", "stands": True, "since": 6, "gap": 0.2, "lead_time": None, "late": 0.1, "strikes": 0.5}
    for name, value in others.items():
        assert SWINGS._replace(**{name: value}) != SWINGS
        assert SWINGS._replace(**{name: getattr(SWINGS, name)}) == SWINGS
    assert tuple(SWINGS._asdict().values()) != SWINGS


def test_a_foot_is_printed_with_the_names_of_its_numbers_as_it_is_made() -> None:
    assert repr(SWINGS).startswith("Foot(name='left', stands=False, since=5, gap=0.1, approach=0.4, lead_time=0.25, ")
    assert eval(repr(SWINGS), {"Foot": Foot}) == SWINGS


def test_a_foot_has_the_fields_of_its_dictionary_in_the_order_in_which_it_is_made() -> None:
    assert tuple(SWINGS._asdict()) == Foot._fields
    assert Foot(*SWINGS._asdict().values()) == SWINGS  # type: ignore[arg-type]


def test_a_foot_can_be_copied_and_kept() -> None:
    assert deepcopy(SWINGS) == SWINGS
    assert pickle.loads(pickle.dumps(SWINGS)) == SWINGS
