"""A single impact in words, numbers and JSON."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from impact_predictor import Contact, Flag, Margins, Mode, Outcome, Twist, TwoPointBody, cylinder, plate, solve_impact
from impact_predictor.mechanics.types import Alternative
from impact_predictor.report.modes import ONE_CONTACT
from impact_predictor.report.outcome import FLAGS, MARGINS, print_outcomes

PLATE = plate(length=1.0, height=0.4, mass=10.0, friction=0.2)
BEFORE = PLATE.turning(-1.0)


def printed(body: TwoPointBody, before: Twist, *outcomes: Outcome, width: int = 80) -> str:
    text = io.StringIO()
    print_outcomes(Console(file=text, width=width), body, before, outcomes)
    return text.getvalue()


def row(text: str, label: str) -> list[str]:
    """The numbers of the first line that begins with a label."""
    line = next(line for line in text.splitlines() if line.strip().startswith(label))
    return line.strip().removeprefix(label).split()


def test_every_flag_and_margin_has_words() -> None:
    assert FLAGS.keys() == set(Flag) - {Flag.NONE}  # which Python 3.10 counts as a member
    assert list(MARGINS) == list(Margins._fields)


def test_the_table_has_velocities_impulses_and_energy() -> None:
    text = printed(PLATE, BEFORE, solve_impact(PLATE, BEFORE))
    assert row(text, "vx, m/s") == ["0.2", "0.1"]
    assert row(text, "omega, rad/s") == ["-1", "0"]
    assert row(text, "normal impulse N, N s") == ["1.3333"]
    assert row(text, "friction used, |T| / (f N)") == ["1.000"]
    assert row(text, "energy, J") == ["1.9333", "0.05"]
    assert row(text, "energy lost, %") == ["97.4"]
    assert "both contacts hold and slip" in text
    assert "++  the old contact slides forwards, the new one slides forwards" in text


def test_what_contacts_do_is_said_once_where_they_go_on_so_after_compression() -> None:
    tall = plate(length=1.0, height=1.6, mass=10.0, friction=0.2, restitution=0.3)
    before = tall.turning(-1.0)
    outcome = solve_impact(tall, before)
    assert outcome.segments == ("O+", "O+")
    assert printed(tall, before, outcome).count("O+  the old contact is open, the new one slides forwards") == 1


def test_the_nearest_other_modes_are_told() -> None:
    text = printed(PLATE, BEFORE, solve_impact(PLATE, BEFORE))
    assert "STOP: friction of the contacts by +0.2" in text
    assert "STOP: mass centre up from the line of the contacts by -0.1 m" in text
    border = plate(length=1.0, height=0.4, mass=10.0, friction=0.4)
    assert "SLIDE: friction of the contacts, on the border" in printed(border, BEFORE, solve_impact(border, BEFORE))
    assert "slip of the old contact by" not in text  # at no other slip there is another mode
    alone = TwoPointBody(1.0, 0.1, None, Contact(0.1, -0.5, 0.3))
    assert "friction by" in printed(alone, Twist(1.0, -1.0, 0.0), solve_impact(alone, Twist(1.0, -1.0, 0.0)))


def test_both_laws_stand_side_by_side_in_80_columns() -> None:
    outcomes = [solve_impact(PLATE, BEFORE, law) for law in ("path", "total")]
    text = printed(PLATE, BEFORE, *outcomes)
    assert row(text, "mode") == ["SLIDE", "SLIDE"]
    assert row(text, "vx, m/s") == ["0.2", "0.1", "0.1"]
    assert max(map(len, text.splitlines())) <= 80


def test_alternatives_and_flags_are_told_in_words() -> None:
    other = Alternative(Mode.PIVOT, Twist(0.1, 0.2, -0.3), ("OS",))
    outcome = solve_impact(PLATE, BEFORE)._replace(unique=False, alternatives=(other,), flags=Flag.JAMMED)
    text = printed(PLATE, BEFORE, outcome, width=200)
    assert "PIVOT with (vx, vy, omega) = (0.1, 0.2, -0.3)" in text
    assert FLAGS[Flag.JAMMED] in text


@pytest.mark.parametrize(("restitution", "mode"), [(0.0, Mode.PIVOT_SLIDE), (0.5, Mode.FLIGHT)])
def test_an_impact_of_one_contact_speaks_of_that_contact_only(restitution: float, mode: Mode) -> None:
    body = TwoPointBody(1.0, 0.1, None, Contact(0.2, -0.5, 0.3, restitution=restitution))
    before = Twist(1.0, -2.0, 0.0)
    outcome = solve_impact(body, before)
    text = printed(body, before, outcome)
    assert outcome.mode is mode
    assert ONE_CONTACT[mode] in text
    assert "old contact" not in text


def test_supports_that_move_apart_have_no_common_energy() -> None:
    body = PLATE._replace(new=PLATE.new._replace(velocity=(0.0, 0.1)))
    text = printed(body, BEFORE, solve_impact(body, BEFORE))
    assert "energy, J" not in text
    assert "energy lost, J" in text


def test_rounding_is_shown_as_zero() -> None:
    body = cylinder(radius=0.3, gamma=1.2, mass=2.0, friction=0.9)
    before = body.turning(-1.0)
    outcome = solve_impact(body, before)
    assert outcome.mode is Mode.STOP
    text = printed(body, before, outcome)
    assert row(text, "vy, m/s")[1] == "0"
    assert "e-" not in text
