"""One impact as it is shown: what happened, in words and numbers, one law beside the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from rich.console import Console
from rich.table import Table

from ..mechanics.impact.body import approach
from ..mechanics.types import Contact, Flag, Mode, Outcome, Twist, TwoPointBody
from .table import plain_table, show

MODES: Final = {
    Mode.NO_IMPACT: "the new contact is not approached",
    Mode.STOP: "both contacts hold and neither slips: the body stops",
    Mode.SLIDE: "both contacts hold and the body slides on them",
    Mode.PIVOT_SLIDE: "the old contact lifts; the body turns about the new one, which slips",
    Mode.PIVOT: "the old contact lifts; the body turns about the new one, which sticks",
    Mode.BACK_PIVOT: "the new contact lifts again; the body turns back about the old one",
    Mode.FLIGHT: "both contacts lift",
}
ONE_POINT_MODES: Final = {
    Mode.NO_IMPACT: "the contact is not approached",
    Mode.PIVOT: "the contact holds and sticks; the body turns about it",
    Mode.PIVOT_SLIDE: "the contact holds and slips",
    Mode.FLIGHT: "the contact lifts again",
}
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
    "friction": ("friction of the contacts", ""),
    "center": ("mass centre towards the new contact", " m"),
    "height": ("mass centre up from the line of the contacts", " m"),
    "reach": ("new contact along its tangent", " m"),
    "slip": ("slip of the old contact", " m/s"),
}
ONE_POINT_MARGINS: Final = {
    "friction": ("friction", ""),
    "center": ("mass centre along the tangent", " m"),
    "height": ("mass centre along the normal", " m"),
    "reach": ("contact along its tangent", " m"),
    "slip": ("slip", " m/s"),
}
_BORDER: Final = 1e-9
"""A margin below this is rounding: the impact lies on the border."""
_ROUNDING: Final = 1e-12
_STATES: Final = {"O": "is open", "S": "sticks", "+": "slides forwards", "-": "slides backwards"}


def print_outcomes(console: Console, body: TwoPointBody, before: Twist, outcomes: Sequence[Outcome]) -> None:
    """Print what one or several laws say about an impact."""
    show(console, _numbers(body, before, outcomes))
    for outcome in outcomes:
        _say(console, "")
        for line in _words(body, outcome):
            _say(console, line)


def _numbers(body: TwoPointBody, before: Twist, outcomes: Sequence[Outcome]) -> Table:
    table = plain_table()
    table.add_column("", no_wrap=True)
    table.add_column("before", justify="right", no_wrap=True)
    for outcome in outcomes:
        table.add_column(f"after, {outcome.law} law", justify="right", no_wrap=True)
    table.add_row("mode", "", *(outcome.mode.name for outcome in outcomes), end_section=True)

    twists = [before, *(outcome.twist for outcome in outcomes)]
    contacts = [("new contact", body.new, 1)]
    if body.old is not None:
        contacts.insert(0, ("old contact", body.old, 0))
    speed = max(abs(part) for _, contact, _ in contacts for part in approach(contact, before)[:2])
    table.add_row("mass centre")
    for name, unit in (("vx", "m/s"), ("vy", "m/s"), ("omega", "rad/s")):
        parts = [_number(getattr(twist, name), speed) for twist in twists]
        table.add_row(f"  {name}, {unit}", *parts, end_section=name == "omega")

    for which, contact, index in contacts:
        motions = [approach(contact, twist) for twist in twists]
        impulses = [outcome.impulses[index] for outcome in outcomes]
        scale = body.mass * speed
        table.add_row(which)
        table.add_row("  normal velocity, m/s", *(_number(normal, speed) for normal, _, _ in motions))
        table.add_row("  slip, m/s", *(_number(slip, speed) for _, slip, _ in motions))
        table.add_row("  normal impulse N, N s", "", *(_number(normal, scale) for normal, _ in impulses))
        table.add_row("  tangential impulse T, N s", "", *(_number(tangent, scale) for _, tangent in impulses))
        shares = [_friction_used(contact, impulse) for impulse in impulses]
        table.add_row("  friction used, |T| / (f N)", "", *shares, end_section=True)

    energy = _energy(body, before)
    if energy is not None:
        left = [_number(energy - outcome.energy_lost, energy) for outcome in outcomes]
        table.add_row("energy, J", _number(energy), *left)
    table.add_row("energy lost, J", "", *(_number(outcome.energy_lost) for outcome in outcomes))
    if energy:
        shares = [f"{100.0 * outcome.energy_lost / energy:.1f}" for outcome in outcomes]
        table.add_row("energy lost, %", "", *shares)
    return table


def _words(body: TwoPointBody, outcome: Outcome) -> Iterator[str]:
    meanings = MODES if body.old is not None else ONE_POINT_MODES
    yield f"{outcome.mode.name} by the {outcome.law} law ({LAWS[outcome.law]}):"
    yield f"  {meanings[outcome.mode]}."
    if outcome.segments:
        yield "  While the impulse grows:" if outcome.law == "path" else "  In all:"
    for segment in outcome.segments:
        yield f"  {segment}  {_segment(segment, body)}"
    if not outcome.unique:
        yield "  Not unique: the law allows as well"
        for other in outcome.alternatives:
            twist = ", ".join(_number(part) for part in other.twist)
            yield f"    {other.mode.name} with (vx, vy, omega) = ({twist}): {meanings[other.mode]}"
    margins = [(name, change, mode) for name, (change, mode) in outcome.margins._asdict().items() if mode is not None]
    if margins:
        yield "  The nearest other modes, by one change at a time:"
    for name, change, mode in margins:
        what, unit = (MARGINS if body.old is not None else ONE_POINT_MARGINS)[name]
        far = f" by {change:+.4g}{unit}" if abs(change) > _BORDER else ", on the border"
        yield f"    {mode.name}: {what}{far}"
    for flag in Flag:
        if flag & outcome.flags:
            yield f"  {flag.name}:"
            yield f"    {FLAGS[flag]}."


def _say(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False)


def _segment(segment: str, body: TwoPointBody) -> str:
    """The states of a segment in words; forwards is along the contact's tangent (normal_y, -normal_x)."""
    if body.old is None:
        return f"the contact {_STATES[segment[1]]}"
    return f"the old contact {_STATES[segment[0]]}, the new one {_STATES[segment[1]]}"


def _friction_used(contact: Contact, impulse: tuple[float, float]) -> str:
    limit = contact.friction * impulse[0]
    return f"{abs(impulse[1]) / limit:.3f}" if limit > 0.0 else "-"


def _energy(body: TwoPointBody, twist: Twist) -> float | None:
    """The kinetic energy relative to the supports; None where they move each in its own way."""
    if body.old is not None and body.old.velocity != body.new.velocity:
        return None
    vx, vy = twist.vx - body.new.velocity[0], twist.vy - body.new.velocity[1]
    return 0.5 * (body.mass * (vx * vx + vy * vy) + body.inertia * twist.omega * twist.omega)


def _number(value: float, scale: float = 0.0) -> str:
    """Five digits; what is rounding against a scale, is 0."""
    return "0" if abs(value) <= _ROUNDING * scale else f"{value:.5g}"
