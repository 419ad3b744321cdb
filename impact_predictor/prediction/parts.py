"""What a scene can leave out: the parts of the predictor and of its node, what switches each and what it loads.

Everything else is the core, which every scene needs: reading of the samples, the impact plane, the motion until the
touchdown (flight, or a stance that turns or slides), both impact laws, and the score.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final, NamedTuple

from ..parameters.types import values_of
from . import part_reasons as reasons
from .part_modules import CORE, CORE_OF_NODE, ROCKING, WALKING

Values = Mapping[str, Any]
"""All parameters of a scene, as `impact_predictor.parameters.validation.validate` gives them."""


class Part(NamedTuple):
    """A part that a scene has or leaves out.

    `has` says from the values of a body whether it needs the part, and `reason` why, in words of the scene. `to_have`
    and `to_leave_out` are the parameters that switch it; without them it belongs to what the scene is about, and cannot
    be switched. `modules` of this package are loaded for it alone, or for one of several parts; `of_node` says that the
    node has the part, not the predictor, and `with_feet` that a machine that walks may be with it or without it.
    """

    name: str
    has: Callable[[Values], bool]
    reason: Callable[[Values], str]
    to_have: Mapping[str, Any] = {}
    to_leave_out: Mapping[str, Any] = {}
    modules: tuple[str, ...] = ()
    of_node: bool = False
    with_feet: bool = False

    def on(self, values: Values) -> bool:
        """Whether any body of a scene needs the part."""
        return any(map(self.has, _bodies(values)))

    def why(self, values: Values) -> str:
        """Why it does, or why none does; and how many do where not all are alike."""
        bodies = _bodies(values)
        those = [one for one in bodies if self.has(one)]
        few = f" (for {len(those)} of {len(bodies)} bodies)" if 0 < len(those) < len(bodies) else ""
        return self.reason((those or bodies)[0]) + few


def _bodies(values: Values) -> list[dict[str, Any]]:
    return [values_of(values, body) for body in values["bodies"] or ("",)]


EVENTS: Final = "events executor"

PARTS: Final = (
    Part(
        "friction",
        lambda values: bool(values["contact.friction"]),
        reasons.why_friction,
        {"contact.friction": 0.3},
        {"contact.friction": 0.0},
        with_feet=True,
    ),
    Part(
        "restitution",
        lambda values: bool(values["contact.restitution"]),
        reasons.why_restitution,
        {"contact.restitution": 0.3},
        {"contact.restitution": 0.0},
        with_feet=True,
    ),
    Part(
        "twist window",
        lambda values: bool(values["odom.twist_window"]),
        reasons.why_twist_window,
        {"odom.twist_window": 0.01},
        {"odom.twist_window": 0.0},
    ),
    Part(
        "transverse slip",
        reasons.has_transverse,
        reasons.why_transverse,
        {"transverse_slip": True, "law": "path"},
        {"transverse_slip": False},
        (
            "mechanics.transverse",
            "mechanics.transverse_implicit",
            "mechanics.transverse_law",
            "mechanics.transverse_states",
            "mechanics.transverse_step",
            "prediction.transverse",
        ),
    ),
    Part(
        "geometry topic",
        reasons.has_geometry,
        reasons.why_geometry,
        {"body.contact_points": ()},
        {"body.contact_points": (1.0, 0.0, 0.0, -1.0, 0.0, 0.0)},
        ("ros.latched_topic",),
        of_node=True,
    ),
    Part(
        "moving support",
        lambda values: bool(values["support.motion"] != "fixed"),
        reasons.why_moving,
        {"support.motion": "odom"},
        {"support.motion": "fixed"},
        (
            *ROCKING,
            *("prediction.deck.approach", "prediction.deck.frame", "prediction.deck.motion", "prediction.deck.tracker"),
            "prediction.deck.window",
            "ros.support_topic",
        ),
    ),
    Part(
        "harmonic extrapolation",
        reasons.has_harmonic,
        reasons.why_harmonic,
        {"support.extrapolation": "harmonic"},
        {"support.extrapolation": "constant"},
        ("prediction.deck.harmonic",),
    ),
    Part(
        "onset watch",
        lambda values: bool(values["onset.watch"]),
        reasons.why_watch,
        {"onset.watch": True},
        {"onset.watch": False},
        (
            *(
                "prediction.watch.counts",
                "prediction.watch.levels",
                "prediction.watch.onset",
                "prediction.watch.stance",
            ),
            *("prediction.watch.standing", "prediction.watch.unit", "prediction.watch.watch", "prediction.watch.words"),
            *("prediction.remedies", "ros.messages.reports"),
        ),
    ),
    Part(
        "cylinder",
        lambda values: bool(values["body.radius"]),
        reasons.why_cylinder,
        modules=(*ROCKING, "prediction.drum", "prediction.deck.approach", "prediction.deck.relative"),
    ),
    Part(
        "tilt",
        lambda values: bool(values["source"] == "imu"),
        reasons.why_tilt,
        modules=("prediction.deck.tilt", "ros.messages.imu"),
    ),
    Part(
        "feet",
        lambda values: bool(values["feet.names"]),
        reasons.why_feet,
        modules=WALKING,
    ),
    Part(
        "articulated inertia",
        lambda values: bool(values["robot.urdf"]),
        reasons.why_articulated,
        to_leave_out={"robot.urdf": "", "robot.frames": ()},
        modules=("mechanics.articulated", "prediction.walking.legs"),
        with_feet=True,
    ),
    Part(
        "force sensors",
        lambda values: bool(values["feet.names"] and values["feet.force"]),
        reasons.why_force,
        {"feet.force": 30.0},
        {"feet.force": 0.0},
        with_feet=True,
    ),
    Part(
        "schedule",
        lambda values: bool(values["feet.names"] and values["feet.has_schedule"]),
        reasons.why_schedule,
        {"feet.has_schedule": True},
        {"feet.has_schedule": False},
        with_feet=True,
    ),
    Part("several bodies", lambda values: bool(values["bodies"]), reasons.why_several),
    Part(
        "margins",
        lambda values: bool(values["margins"]),
        reasons.why_margins,
        {"margins": True},
        {"margins": False},
        ("mechanics.margins", "ros.confidence"),
    ),
    Part(
        "uncertainty",
        lambda values: bool(values["uncertainty.samples"]),
        reasons.why_uncertainty,
        {"uncertainty.samples": 64, "uncertainty.friction": 0.02, "uncertainty.restitution": 0.02},
        {"uncertainty.samples": 0},
        (
            "mechanics.batch",
            "mechanics.dual",
            "mechanics.sensitivity",
            "prediction.uncertainty",
            "ros.confidence",
        ),
    ),
    Part(
        EVENTS,
        lambda values: bool(values["executor"] == "events"),
        reasons.why_events,
        {"executor": "events"},
        {"executor": "single"},
        of_node=True,
        with_feet=True,
    ),
)
"""Every part. Those that others need stand before them."""

TOGETHER: Final = (
    (lambda values: values["support.motion"] == "imu", ("prediction.deck.imu", "ros.messages.imu")),
    (lambda values: values["support.motion"] != "fixed" and values["onset.watch"], ("prediction.deck.forecast",)),
    (lambda values: values["support.motion"] == "fixed" and values["onset.watch"], ("prediction.deck.resting",)),
)
"""Modules that a part loads only in some scenes, and for which bodies."""


def modules_of(values: Values, node: bool = False) -> frozenset[str]:
    """The modules of this package that a scene loads, in its predictor or in the node, by their names in it."""
    parts = [part for part in PARTS if part.on(values) and (node or not part.of_node)]
    loaded = {module for part in parts for module in part.modules if node or not module.startswith("ros.")}
    together = {module for needs, modules in TOGETHER if any(map(needs, _bodies(values))) for module in modules}
    together = {module for module in together if node or not module.startswith("ros.")}
    modules = CORE | loaded | together | (CORE_OF_NODE if node else frozenset())
    return modules | {module.rpartition(".")[0] for module in modules if "." in module}


def ladder(values: Values) -> list[tuple[Part | None, dict[str, Any]]]:
    """The parameters of the core alone, then with one part more each time: first those of the scene, then the others.

    So the costs of the parts, from one to the next, add up to that of the scene, and on to that of everything that such
    bodies can have.
    """
    # A machine whose model tells its mass may have none for the steps without the model.
    values = {"body.mass": 1.0, "body.inertia": (1.0,), **values}
    walks = any(one["feet.names"] for one in _bodies(values))
    possible = [part for part in PARTS if (part.to_have or part.to_leave_out) and (part.with_feet or not walks)]
    everything = dict(values)
    for part in possible:
        everything = _switch(everything, part.to_have)
    parts = [part for part in possible if part.on(values) or part.on(everything)]
    switched = dict(values)
    for part in parts:
        switched = _switch(switched, part.to_leave_out)
    steps: list[tuple[Part | None, dict[str, Any]]] = [(None, switched)]
    for part in sorted(parts, key=lambda part: not part.on(values)):
        settings = {**part.to_leave_out, **part.to_have}
        switched = _restore(switched, values, settings) if part.on(values) else _switch(switched, part.to_have)
        steps.append((part, switched))
    return steps


def _switch(values: Values, settings: Values) -> dict[str, Any]:
    """The values with other settings for all bodies."""
    return {name: value for name, value in values.items() if _common(name, values) not in settings} | dict(settings)


def _restore(values: Values, original: Values, names: Values) -> dict[str, Any]:
    """The values with those of some names as they were."""
    return {**values, **{name: value for name, value in original.items() if _common(name, values) in names}}


def _common(name: str, values: Values) -> str:
    """The name of a parameter without that of a body."""
    body, _, common = name.partition(".")
    return common if body in values["bodies"] else name
