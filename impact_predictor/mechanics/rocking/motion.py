"""The way in to long motion: where a body starts, and how far it is followed."""

from __future__ import annotations

import math

from ..impact import number_of
from ..motion import PlanarState
from ..support import FixedSupport, Support
from ..types import TwoPointBody
from .bodies import shape_of
from .loop import Rocking
from .run import End, Run


def standing(body: TwoPointBody, angle: float, omega: float = 0.0, slip: float = 0.0, x: float = 0.0) -> PlanarState:
    """The state of a body that stands on its contacts, turned by `angle` (rad, CCW) from the pose with both closed.

    A positive angle stands on contact 0 and lifts contact 1, a negative one the reverse. `omega` in rad/s, of the
    turning about the contact; `slip` of the contact along its tangent in m/s; `x` in m is where contact 0 of a body on
    two points is when both are closed. In the support's frame.

    Raises:
        InputError: the body is not one that rocks (see `rock`).
    """
    shape = shape_of(body)
    state = shape.state(1 if angle < 0.0 else 0, angle, omega, 0.0 if shape.rolls else x, slip)
    return state._replace(angle=state.angle - shape.lean)


def rock(
    body: TwoPointBody,
    start: PlanarState,
    support: Support = FixedSupport(),  # noqa: B008 - it is immutable
    law: str = "path",
    duration: float = 10.0,
    start_time: float = 0.0,
    overturned: float = 0.5 * math.pi,
    max_events: int = 100_000,
    tolerance: float = 1e-11,
) -> Run:
    """Follow a body on two contacts over a support, from event to event.

    `body`: one with both normals (0, 1), as `rod` and `plate` make it, stands on two points fixed in it over the line
    y = 0 of the support's frame; one with normals through its mass centre, as `cylinder` makes it, is a disc over two
    edges fixed in the support, edge 0 being the origin of its frame. Friction and restitution are those of the
    contacts. `start` is the state of the mass centre in the support's frame at `start_time` (s), see `standing`; a
    contact near the support is put on it. `law` is that of `solve_impact`. The motion is followed for `duration` s,
    until it is at rest for ever, or until it has turned by `overturned` rad from the pose with both contacts closed.
    It ends, too, after `max_events` events, or as many steps in all.
    `tolerance` is the error allowed to a step where a contact slips or the support moves, relative to what happens in
    the step; without both, turning is exact.

    What goes wrong with finite numbers is a named `End`, never an exception.

    Raises:
        InputError: the body is neither of the two shapes.
        ValueError: an unknown law.
    """
    number_of(law)
    if not _is_valid(body, start, duration, start_time, overturned, tolerance):
        return Run(body, support, law, [], 0.0, End.INVALID_INPUT, start_time, start, [], [], [])
    return Rocking(body, support, law, start_time, start_time + duration, overturned, max_events, tolerance).run(start)


def _is_valid(body: TwoPointBody, start: PlanarState, *numbers: float) -> bool:
    contacts = [body.new] if body.old is None else [body.old, body.new]
    values = [*start, *numbers, body.mass, body.inertia]
    for x, y, friction, (nx, ny), restitution, _ in contacts:
        values += [x, y, friction, nx, ny, restitution]
        if friction < 0.0 or not 0.0 <= restitution <= 1.0:
            return False
    return all(map(math.isfinite, values)) and body.mass > 0.0 and body.inertia > 0.0 and numbers[0] >= 0.0
