"""One impact as `solve` prints it: what happened, in words and numbers, one law beside the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from operator import itemgetter
from typing import Final

from rich.console import Console

from ..mechanics.impact import approach
from ..mechanics.types import Flag, Mode, Outcome, Twist, TwoPointBody
from ..wording import fixed
from .modes import MODES, ONE_CONTACT
from .table import Column, show, table_of

FLAGS: Final = {
    Flag.REVERSED_SLIP: "a contact slips against the direction in which it slipped, or first began to slip",
    Flag.JAMMED: "the impulse path jammed (Painleve); a tangential impact at the old contact resolved it",
    Flag.WORK_LIMITED: "restitution ended when the stored normal work was returned, before Poisson's impulse",
    Flag.OLD_RESTITUTION_IGNORED: "the old contact does not approach, so its restitution had no effect",
    Flag.ENERGY_GAINED: "Newton's restitution raised the kinetic energy: do not trust this answer",
    Flag.SHARED_FRICTION: "both contacts stick: how they share the push along their line is a choice, not mechanics",
    Flag.BOTH_STRUCK: "both contacts approach, so the total law answered",
    Flag.LAST_RESORT: "the law had no answer, so the total law without restitution gave one",
    Flag.NO_SOLUTION: "no law has a solution (supports that move apart); the velocities are left as they were",
    Flag.INVALID_INPUT: "a number is out of range",
    Flag.THIN_BODY: "so thin a body bends while it strikes and rebounds; rigid theory does not know that",
    Flag.SLOW_IMPACT: "so weak an impact that gravity matters while it lasts; rigid theory leaves gravity out",
    Flag.NOT_CONVERGED: "the impulses in three dimensions still changed when the sweeps ended; the answer is near",
    Flag.POINT_APPROACHES: "a point that took no part is about to touch the support as the body moves then",
}
MARGINS: Final = {
    "friction": ("friction of the contacts", "friction", ""),
    "center": ("mass centre towards the new contact", "mass centre along the tangent", " m"),
    "height": ("mass centre up from the line of the contacts", "mass centre along the normal", " m"),
    "reach": ("new contact along its tangent", "contact along its tangent", " m"),
    "slip": ("slip of the old contact", "slip", " m/s"),
}
"""What is changed by a margin, with two contacts and with one, and its unit."""
_BORDER: Final = 1e-9
"""A margin below this is rounding: the impact lies on the border."""
_STATES: Final = {"O": "is open", "S": "sticks", "+": "slides forwards", "-": "slides backwards"}


def print_outcomes(console: Console, body: TwoPointBody, before: Twist, outcomes: Sequence[Outcome]) -> None:
    """Print what one or several laws say about an impact."""
    columns = [Column("", itemgetter(0), left=True), Column("before", itemgetter(1))]
    columns += [Column(f"after, {outcome.law} law", itemgetter(k)) for k, outcome in enumerate(outcomes, 2)]
    # Headings and numbers without a value before or after have empty cells.
    rows = [(*row, *[""] * (len(columns) - len(row))) for row in _rows(body, before, outcomes)]
    show(console, table_of(columns, rows))
    for outcome in outcomes:
        console.print("", *_sentences(outcome, alone=body.old is None), sep="\n", markup=False, highlight=False)


def _rows(body: TwoPointBody, before: Twist, outcomes: Sequence[Outcome]) -> Iterator[tuple[str, ...]]:
    """The name of each number, and the number before and after the impact."""
    yield "mode", "", *(outcome.mode.name for outcome in outcomes)
    twists = [before, *(outcome.twist for outcome in outcomes)]
    contacts = [("new contact", body.new, 1)]
    if body.old is not None:
        contacts.insert(0, ("old contact", body.old, 0))
    speed = max(abs(part) for _, contact, _ in contacts for part in approach(contact, before))
    yield ("mass centre",)
    for name, unit in (("vx", "m/s"), ("vy", "m/s"), ("omega", "rad/s")):
        yield f"  {name}, {unit}", *(_number(getattr(twist, name), speed) for twist in twists)
    for which, contact, index in contacts:
        motions = [approach(contact, twist) for twist in twists]
        impulses = [outcome.impulses[index] for outcome in outcomes]
        pairs = [(contact.friction * normal, tangent) for normal, tangent in impulses]
        used = [abs(tangent) / limit if limit > 0.0 else None for limit, tangent in pairs]
        yield (which,)
        yield "  normal velocity, m/s", *(_number(normal, speed) for normal, _ in motions)
        yield "  slip, m/s", *(_number(slip, speed) for _, slip in motions)
        yield "  normal impulse N, N s", "", *(_number(normal, body.mass * speed) for normal, _ in impulses)
        yield "  tangential impulse T, N s", "", *(_number(tangent, body.mass * speed) for _, tangent in impulses)
        yield "  friction used, |T| / (f N)", "", *(fixed(part, 3) for part in used)
    lost = [outcome.energy_lost for outcome in outcomes]
    # Relative to the supports, unless these move each in its own way.
    together = body.old is None or body.old.velocity == body.new.velocity
    vx, vy = before.vx - body.new.velocity[0], before.vy - body.new.velocity[1]
    energy = 0.5 * (body.mass * (vx * vx + vy * vy) + body.inertia * before.omega * before.omega) if together else 0.0
    if together:
        yield "energy, J", _number(energy), *(_number(energy - one, energy) for one in lost)
    yield "energy lost, J", "", *map(_number, lost)
    if energy:
        yield "energy lost, %", "", *(f"{100.0 * one / energy:.1f}" for one in lost)


def _sentences(outcome: Outcome, *, alone: bool) -> Iterator[str]:
    def meaning(mode: Mode) -> str:
        return ONE_CONTACT[mode] if alone else MODES[mode].meaning

    yield f"{outcome.mode.name} by the {outcome.law} law:"
    yield f"  {meaning(outcome.mode)}."
    if outcome.segments:
        yield "  While the impulse grows:" if outcome.law == "path" else "  In all:"
    # From compression to restitution the contacts may go on as they did.
    for segment, _ in groupby(outcome.segments):
        # Forwards is along the contact's tangent (normal_y, -normal_x).
        old, new = (_STATES[state] for state in segment)
        yield f"  {segment}  " + (f"the contact {new}" if alone else f"the old contact {old}, the new one {new}")
    if not outcome.unique:
        yield "  Not unique: the law allows as well"
    for other in () if outcome.unique else outcome.alternatives:
        twist = ", ".join(map(_number, other.twist))
        yield f"    {other.mode.name} with (vx, vy, omega) = ({twist}): {meaning(other.mode)}"
    margins = [(name, change, mode) for name, (change, mode) in outcome.margins._asdict().items() if mode is not None]
    if margins:
        yield "  The nearest other modes, by one change at a time:"
    for name, change, mode in margins:
        of_two, of_one, unit = MARGINS[name]
        far = f" by {change:+.4g}{unit}" if abs(change) > _BORDER else ", on the border"
        yield f"    {mode.name}: {of_one if alone else of_two}{far}"
    for flag in Flag:
        if flag & outcome.flags:
            yield f"  {flag.name}:"
            yield f"    {FLAGS[flag]}."


def _number(value: float, scale: float = 0.0) -> str:
    """Five digits; what is rounding against a scale, is 0."""
    return "0" if abs(value) <= 1e-12 * scale else f"{value:.5g}"
