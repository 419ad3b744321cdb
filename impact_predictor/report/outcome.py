"""One impact as `solve` prints it: what happened, in words and numbers, one law beside the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Final

from rich.console import Console

from ..mechanics.impact import approach
from ..mechanics.types import Contact, Flag, Mode, Outcome, Twist, TwoPointBody
from ..wording import NONE
from .modes import MODES
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
}
LAWS: Final = {
    "path": "growing impulse, Poisson restitution",
    "total": "whole impulse at once, Newton restitution",
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
_ROUNDING: Final = 1e-12
_STATES: Final = {"O": "is open", "S": "sticks", "+": "slides forwards", "-": "slides backwards"}


def print_outcomes(console: Console, body: TwoPointBody, before: Twist, outcomes: Sequence[Outcome]) -> None:
    """Print what one or several laws say about an impact."""
    columns = [Column("", lambda row: row[0], left=True)]
    for k, header in enumerate(["before", *(f"after, {outcome.law} law" for outcome in outcomes)], 1):
        columns.append(Column(header, _cell(k)))
    show(console, table_of(columns, _rows(body, before, outcomes)))
    for outcome in outcomes:
        console.print("", *_sentences(body, outcome), sep="\n", markup=False, highlight=False)


def _cell(place: int) -> Callable[[tuple[str, ...]], str]:
    return lambda row: row[place] if place < len(row) else ""


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
        scale = body.mass * speed
        yield (which,)
        yield "  normal velocity, m/s", *(_number(normal, speed) for normal, _ in motions)
        yield "  slip, m/s", *(_number(slip, speed) for _, slip in motions)
        yield "  normal impulse N, N s", "", *(_number(normal, scale) for normal, _ in impulses)
        yield "  tangential impulse T, N s", "", *(_number(tangent, scale) for _, tangent in impulses)
        yield "  friction used, |T| / (f N)", "", *(_friction_used(contact, impulse) for impulse in impulses)
    energy, lost = _energy(body, before), [outcome.energy_lost for outcome in outcomes]
    if energy is not None:
        yield "energy, J", _number(energy), *(_number(energy - one, energy) for one in lost)
    yield "energy lost, J", "", *map(_number, lost)
    if energy:
        yield "energy lost, %", "", *(f"{100.0 * one / energy:.1f}" for one in lost)


def _sentences(body: TwoPointBody, outcome: Outcome) -> Iterator[str]:
    alone = body.old is None
    yield f"{outcome.mode.name} by the {outcome.law} law ({LAWS[outcome.law]}):"
    yield f"  {_meaning(outcome.mode, alone)}."
    if outcome.segments:
        yield "  While the impulse grows:" if outcome.law == "path" else "  In all:"
    for segment in outcome.segments:
        # Forwards is along the contact's tangent (normal_y, -normal_x).
        old, new = (_STATES[state] for state in segment)
        yield f"  {segment}  " + (f"the contact {new}" if alone else f"the old contact {old}, the new one {new}")
    if not outcome.unique:
        yield "  Not unique: the law allows as well"
        for other in outcome.alternatives:
            twist = ", ".join(_number(part) for part in other.twist)
            yield f"    {other.mode.name} with (vx, vy, omega) = ({twist}): {_meaning(other.mode, alone)}"
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


def _meaning(mode: Mode, alone: bool) -> str:
    return MODES[mode].one_point if alone else MODES[mode].meaning


def _friction_used(contact: Contact, impulse: tuple[float, float]) -> str:
    limit = contact.friction * impulse[0]
    return f"{abs(impulse[1]) / limit:.3f}" if limit > 0.0 else NONE


def _energy(body: TwoPointBody, twist: Twist) -> float | None:
    """The kinetic energy relative to the supports; None where they move each in its own way."""
    if body.old is not None and body.old.velocity != body.new.velocity:
        return None
    vx, vy = twist.vx - body.new.velocity[0], twist.vy - body.new.velocity[1]
    return 0.5 * (body.mass * (vx * vx + vy * vy) + body.inertia * twist.omega * twist.omega)


def _number(value: float, scale: float = 0.0) -> str:
    """Five digits; what is rounding against a scale, is 0."""
    return "0" if abs(value) <= _ROUNDING * scale else f"{value:.5g}"
