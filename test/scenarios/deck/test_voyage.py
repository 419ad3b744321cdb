"""Which contacts units have on a voyage."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from cargo_scenes import a_deck, box

from impact_predictor.prediction.scene import Chock, Lashing
from impact_predictor.scenarios.deck.voyage import sail

CHOCK = Chock((0.0, -0.4, -0.9), (0.0, 1.0, 0.0), 5000.0)
LASHING = Lashing((0.0, 0.4, 0.0), (0.0, 2.0, -1.0), 6000.0, 1000.0, 4e5)


def moved(contacts: str, held: dict[str, Any]) -> tuple[float, float]:
    """How far a unit has slid, and turned at most."""
    (unit,) = sail({"": box(friction=0.02, **held)}, a_deck(), 1.0, contacts).units
    return unit.moved, unit.most_turned


@pytest.mark.parametrize("held", [{"chocks": (CHOCK,)}, {"lashings": (LASHING,)}], ids=["chock", "lashing"])
def test_a_unit_that_is_held_has_compliant_contacts_on_a_deck_that_only_rolls(held: dict[str, Any]) -> None:
    assert moved("auto", held) == moved("compliant", held)


def test_a_unit_that_nothing_holds_has_rigid_contacts_on_a_deck_that_only_rolls() -> None:
    assert moved("auto", {}) == moved("rigid", {})
    assert not np.allclose(moved("auto", {}), moved("compliant", {}), rtol=0.0, atol=1e-9)


def test_a_unit_that_is_to_stand_again_later_lies_until_the_end_where_it_fell() -> None:
    for_good, until_later = (
        sail({"": box()}, a_deck(0.3), 3.0, "rigid", restand=restand).units[0] for restand in (None, 100.0)
    )
    assert (until_later.toppled, until_later.stood) == (1, for_good.time)
    assert until_later.time == 3.0 > for_good.time
    assert until_later.moved == for_good.moved != 0.0
