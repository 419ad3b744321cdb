"""A box, a drum and a deck that several tests of cargo share."""

from typing import Any

from harmonic_deck import Wave, harmonic_support

from impact_predictor.mechanics.motion.support import MovingSupport
from impact_predictor.prediction.scene import MovingDeck, Scene


def box(**changes: Any) -> Scene:
    # Its z axis is the lightest, so that a wrong axis of the inertia shows.
    scene = Scene(
        mass=500.0,
        inertia=((200.0, 0.0, 0.0), (0.0, 300.0, 0.0), (0.0, 0.0, 50.0)),
        friction=0.6,
        points=tuple((x, y, -1.0) for x in (-0.7, 0.7) for y in (-0.4, 0.4)),
        deck=MovingDeck(),
        place=(3.0, 5.0, 1.0),
    )
    return scene._replace(**changes)


def a_drum(**changes: Any) -> Scene:
    scene = Scene(
        mass=500.0,
        inertia=((90.0, 0.0, 0.0), (0.0, 300.0, 0.0), (0.0, 0.0, 300.0)),
        friction=0.6,
        radius=0.6,
        edges=((0.0, 4.3, 0.1), (0.0, 3.7, 0.1)),
        deck=MovingDeck(),
    )
    return scene._replace(**changes)


def a_deck(angle: float = 0.12) -> MovingSupport:
    """Rolls hard enough to rock the box, or with 0 so little that nothing moves on it."""
    strength = angle / 0.12
    return harmonic_support(
        [Wave(angle or 0.01, 2.4), Wave(0.4 * angle, 3.5, 1.0)], [Wave(0.35 * strength, 2.4, 0.3)], [Wave(0.2, 1.7)]
    )
