"""Which shape a body with its two contacts is."""

from __future__ import annotations

import math

from ...errors import InputError
from ..types import TwoPointBody
from .disc import Disc
from .points import Points
from .shape import UNIT, Shape


def shape_of(body: TwoPointBody) -> Shape:
    """The shape that a body with its contacts is.

    Raises:
        InputError: it is neither; it has one contact; or its contacts lie in one place.
    """
    old, new = body.old, body.new
    if old is None:
        raise InputError("a body that rocks needs two contacts; give TwoPointBody.old, too")
    radius, radius_b = math.hypot(old.x, old.y), math.hypot(new.x, new.y)
    size = radius + radius_b
    span = math.hypot(new.x - old.x, new.y - old.y)
    if not (span > UNIT * size and 0.0 < span * span < math.inf):
        raise InputError("the two contacts lie in one place or endlessly far from each other; give two that are apart")
    if all(abs(nx) <= UNIT and ny > 0.0 for nx, ny in (old.normal, new.normal)):
        return Points(body)
    radial = all(
        abs(contact.x + radius * contact.normal[0]) + abs(contact.y + radius * contact.normal[1]) <= UNIT * size
        for contact in (old, new)
    )
    ahead = old.x * new.y - old.y * new.x > 0.0
    if not (radial and ahead and abs(radius - radius_b) <= UNIT * size):
        raise InputError(
            "the contacts are neither points over a straight support (both normals (0, 1)) nor the edges under a disc "
            "(normals through the mass centre, equal distances, contact 1 ahead); give one of these"
        )
    return Disc(body)
