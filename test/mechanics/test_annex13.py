"""The balance of forces of Annex 13 against the calculated examples of the Code, a LASHCON sheet and sums by hand."""

from __future__ import annotations

from itertools import pairwise
from math import cos, hypot, inf, radians, sin

import pytest

from impact_predictor.errors import InputError
from impact_predictor.mechanics.annex13 import (
    POSITIONS,
    RATIOS,
    STIFF,
    Balance,
    Device,
    LashedUnit,
    VesselData,
    balances,
    design_accelerations,
    external_forces,
)

DECK = -2.0
"""Of units whose frame is at half of their height."""


def lashing(msl: float, alpha: float, beta: float, side: float, ahead: float = 1.0) -> Device:
    """By its angles in degrees from the deck and from the transverse; it pulls to a side (1: port)."""
    a, b = radians(alpha), radians(beta)
    return Device((0.0, side * 2.0, DECK), (ahead * cos(a) * sin(b), side * cos(a) * cos(b), -sin(a)), 1e3 * msl)


def by_name(found: list[Balance]) -> dict[str, Balance]:
    return {balance.name: balance for balance in found}


def kilo(*numbers: float) -> list[int]:
    return [round(number / 1e3) for number in numbers]


def test_calculated_example_1_of_the_code_has_its_forces_and_balances() -> None:
    """Appendix 1, example 1, in the edition of 2003 and in that of MSC.1/Circ.1623: 384 kN against 412 and 422 kN."""
    accelerations = design_accelerations(VesselData(120.0, 20.0, 1.4, 15.0), 0.7, "low")
    assert accelerations == pytest.approx((2.9 * 0.889, 6.3 * 0.889, 6.2 * 0.889), rel=1e-4)
    starboard = [lashing(90.0, 40.0, 0.0, -1.0)] * 4
    port = [lashing(90.0, 40.0, 0.0, 1.0)] * 2 + [lashing(90.0, 10.0, 0.0, 1.0)] * 2
    unit = LashedUnit(
        62e3, 0.3, (0.0, 0.0, -0.2), (-3.0, 3.0, -2.0, 2.0), DECK, (*starboard, *port), (16.0, 24.0), (8.0, 12.0)
    )
    # The Code rounds the factor 0.889 up to 0.89.
    forces = external_forces(unit, (2.9 * 0.89, 6.3 * 0.89, 6.2 * 0.89))
    assert kilo(*forces) == [184, 384, 342]
    found = by_name(balances(unit, forces))
    assert kilo(found["sliding to port"].acts, found["sliding to port"].holds) == [384, 413]
    assert found["sliding to port"].holds == pytest.approx(412e3, rel=2e-3)  # 412 with f rounded to 0.96
    assert kilo(found["sliding to starboard"].holds) == [422]
    assert kilo(found["tipping to port"].acts, 2.0 * 62e3 * 9.81) == [691, 1216]
    assert found["tipping to port"].holds >= 1216e3  # no tipping, even without lashings


@pytest.mark.parametrize("position", POSITIONS)
def test_the_stiffer_a_vessel_and_the_higher_its_deck_the_more_it_accelerates_across(position: float) -> None:
    vessels = [VesselData(100.0, 20.0, 20.0 / ratio, 15.0) for ratio in RATIOS]
    across = [[design_accelerations(vessel, position, deck)[1] for deck in STIFF] for vessel in vessels]
    assert all(stiffer > softer for one, other in pairwise(across) for stiffer, softer in zip(one, other, strict=True))
    assert all(higher > lower for decks in across for higher, lower in pairwise(decks))


def test_calculated_example_2_of_the_code_has_its_forces_and_the_factors_of_its_first_lashing() -> None:
    """Appendix 1, example 2 (alternative method): Fx 112, Fy 312, Fz 346 kN, fz 0.8, CS 80 kN at 40 and 30 degrees."""
    accelerations = design_accelerations(VesselData(160.0, 24.0, 1.5, 18.0), 0.7, "tween")
    unit = LashedUnit(68e3, 0.3, (0.0, 0.0, -0.8), (-3.0, 3.0, -0.9, 0.9), DECK, (lashing(108.0, 40.0, 30.0, -1.0),))
    forces = external_forces(unit, accelerations)
    assert forces == pytest.approx((112e3, 312e3, 346e3), rel=0.01)
    found = by_name(balances(unit, forces, "alternative"))
    a, b = radians(40.0), radians(30.0)
    across, along = cos(a) * cos(b) + 0.3 * sin(a), cos(a) * sin(b) + 0.3 * sin(a)
    assert found["sliding to port"].shares == pytest.approx((80e3 * across,))
    assert found["sliding to port"].holds == pytest.approx(0.3 * 68e3 * 9.81 + 80e3 * across)
    assert found["sliding aft"].holds == pytest.approx(0.3 * (68e3 * 9.81 - 0.8 * forces[2]) + 80e3 * along)
    assert found["sliding to starboard"].shares == found["sliding forward"].shares == (0.0,)


def test_a_published_sheet_of_lashcon_has_the_same_forces_and_capacities() -> None:
    """LASHCON IMO 9.10, alternative method: 9 t on deck high at the end of a vessel of 210.10 m, 12 knots."""
    accelerations = design_accelerations(VesselData(210.1, 36.0, 2.4, 12.0), 0.9, "high")
    assert accelerations == pytest.approx((2.06, 4.00, 4.98), abs=6e-3)
    devices = tuple([lashing(55.0, 0.0, 45.0, side, ahead) for side in (1.0, -1.0) for ahead in (1.0, -1.0)])
    unit = LashedUnit(9e3, 0.1, (0.0, 0.0, DECK + 1.38), (-3.0, 3.0, -1.23, 1.23), DECK, devices, (16.64, 6.74))
    forces = external_forces(unit, accelerations)
    found = by_name(balances(unit, forces, "alternative"))
    assert forces[:2] == pytest.approx((35.1e3, 42.8e3), rel=3e-3)
    assert kilo(found["sliding to port"].holds) == [66]
    assert found["tipping to port"].holds == pytest.approx(108e3, rel=0.01)
    assert found["tipping to port"].acts == pytest.approx(58.8e3, rel=0.01)


@pytest.mark.parametrize(
    ("vessel", "factor"), [((134.0, 22.0, 0.7, 14.5), 0.81), ((101.0, 17.5, 0.5, 13.0), 0.93)], ids=["B.5.2", "B.5.3"]
)
def test_the_calculated_examples_for_timber_deck_cargo_have_their_factors_of_tables_2_to_4(
    vessel: tuple[float, float, float, float], factor: float
) -> None:
    """Annex B of the 2011 TDC Code, resolution A.1048(27): 6.5 m/s^2 on deck low at its end, length and speed as given,
    and 1.00 for B/GM of 31 and 35, which give 5.3 and, before a reduction for the Baltic, 6.0 m/s^2.
    """
    assert design_accelerations(VesselData(*vessel), 0.8, "low")[1] == pytest.approx(6.5 * factor, rel=6e-3)


@pytest.mark.parametrize(
    ("deck", "across", "along"),
    [
        ("high", (7.1, 6.9, 6.8, 6.7, 6.7, 6.8, 6.9, 7.1, 7.4), 3.8),
        ("low", (6.5, 6.3, 6.1, 6.1, 6.1, 6.1, 6.3, 6.5, 6.7), 2.9),
        ("tween", (5.9, 5.6, 5.5, 5.4, 5.4, 5.5, 5.6, 5.9, 6.2), 2.0),
        ("hold", (5.5, 5.3, 5.1, 5.0, 5.0, 5.1, 5.3, 5.5, 5.9), 1.5),
    ],
)
def test_a_vessel_of_100_m_and_15_knots_has_the_basic_accelerations_of_table_2(
    deck: str, across: tuple[float, ...], along: float
) -> None:
    """Table 2 as the Netherlands' shipping inspectorate published the Code of 1996 (PUC_2092_14, puc.overheid.nl), and
    as another public program has it from MSC.1/Circ.1623 (github.com/nao701073-rgb/SK-Dangerous-Goods-Guide). The
    former drops one of the four 6.1 of deck low and prints 4.5 along the lower hold, where the latter has 1.5.
    """
    upwards = (7.6, 6.2, 5.0, 4.3, 4.3, 5.0, 6.2, 7.6, 9.2)
    # Both editions call the factor of such a vessel 1.00; the formula of the later one makes it 1.0003.
    for k, (y, z) in enumerate(zip(across, upwards, strict=True), 1):
        found = design_accelerations(VesselData(100.0, 18.2, 1.4, 15.0), 0.1 * k, deck)
        assert found == pytest.approx((along, y, z), rel=1e-3)


@pytest.mark.parametrize(
    ("deck", "factors"),
    [
        ("high", (2.64, 2.28, 1.98, 1.74, 1.56, 1.40, 1.27, 1.19, 1.11, 1.05, 1.0)),
        ("low", (2.18, 1.93, 1.72, 1.55, 1.42, 1.30, 1.21, 1.14, 1.09, 1.04, 1.0)),
        ("tween", (1.62, 1.51, 1.41, 1.33, 1.26, 1.19, 1.14, 1.09, 1.06, 1.03, 1.0)),
        ("hold", (1.24, 1.23, 1.20, 1.18, 1.15, 1.12, 1.09, 1.06, 1.04, 1.02, 1.0)),
    ],
)
def test_stiff_vessels_have_the_factors_of_table_4(deck: str, factors: tuple[float, ...]) -> None:
    """B/GM from 3 to 13 as the same public program has them from MSC.1/Circ.1623."""
    soft = design_accelerations(VesselData(100.0, 13.0, 1.0, 15.0), 0.5, deck)[1]
    for ratio, factor in zip(range(3, 14), factors, strict=True):
        assert design_accelerations(VesselData(100.0, ratio, 1.0, 15.0), 0.5, deck)[1] == pytest.approx(factor * soft)


def test_a_high_lashing_holds_against_tipping_by_its_lever_arm() -> None:
    """By hand: 60 kN pulled flat to starboard from 3 m above the deck hold 180 kN m, half as steep the sum of both."""
    unit = LashedUnit(1e3, 0.3, (0.0, 0.0, 0.0), (-1.0, 1.0, -1.0, 1.0), DECK, ())
    flat = Device((0.0, -1.0, DECK + 3.0), (0.0, -1.0, 0.0), 90e3)
    steep = Device((0.0, -1.0, DECK + 3.0), (0.0, -0.8, -0.6), 90e3)
    bare = by_name(balances(unit, (0.0, 1.0, 0.0)))["tipping to port"].holds
    for device, moment in ((flat, 180e3), (steep, 60e3 * (0.8 * 3.0 + 0.6 * 2.0))):
        found = by_name(balances(unit._replace(devices=(device,)), (0.0, 1.0, 0.0)))
        assert found["tipping to port"].holds - bare == pytest.approx(moment)
        assert found["tipping to starboard"].holds == pytest.approx(bare)


def test_a_lashing_askew_or_steep_and_a_stopper_without_limit_count_as_far_as_they_hold() -> None:
    askew, steep = lashing(90.0, 30.0, 31.0, -1.0), lashing(90.0, 61.0, 0.0, -1.0)
    stopper = Device((0.0, 2.0, DECK), (0.0, -1.0, 0.0), inf)
    unit = LashedUnit(1e3, 0.3, (0.0, 0.0, 0.0), (-1.0, 1.0, -1.0, 1.0), DECK, (askew, steep, stopper))
    found = by_name(balances(unit, (0.0, 1.0, 0.0)))
    assert found["sliding to port"].shares == (0.0, 0.0, inf)
    assert found["sliding to starboard"].shares == (0.0, 0.0, 0.0)
    assert by_name(balances(unit, (0.0, 1.0, 0.0), "alternative"))["sliding to port"].shares[0] > 0.0


@pytest.mark.parametrize(("ratio", "factor"), [(13.0, 1.0), (20.0, 1.0), (7.0, 1.56), (7.5, 1.48), (3.0, 2.64)])
def test_a_stiff_vessel_accelerates_more_across_and_no_more_along(ratio: float, factor: float) -> None:
    stiff, soft = [
        design_accelerations(VesselData(100.0, 18.0, 18.0 / one, 15.0), 0.5, "high") for one in (ratio, 13.0)
    ]
    assert stiff[1] / soft[1] == pytest.approx(factor)
    assert (stiff[0], stiff[2]) == (soft[0], soft[2])
    assert hypot(*soft) == pytest.approx(hypot(3.8, 6.7, 4.3), rel=3e-3)  # 100 m and 15 knots are those of table 2


@pytest.mark.parametrize(
    ("vessel", "said"),
    [
        (VesselData(40.0, 10.0, 0.5, 12.0), "50 to 300 m"),
        (VesselData(100.0, 20.0, 9.0, 12.0), "a third of the breadth"),
        (VesselData(100.0, 20.0, 1.0, 0.0), "a speed in knots above 0"),
    ],
)
def test_a_vessel_beyond_the_tables_is_refused(vessel: VesselData, said: str) -> None:
    with pytest.raises(InputError, match=said):
        design_accelerations(vessel, 0.5, "low")
