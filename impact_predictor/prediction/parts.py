"""What a scene can leave out: the parts of the predictor and of its node, what switches each and what it loads.

Everything else is the core, which every scene needs: reading of the samples, the impact plane, the motion until the
touchdown (flight, or a stance that turns or slides), both impact laws, and the score.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final, NamedTuple

Values = Mapping[str, Any]
"""All parameters of a scene, as `impact_predictor.parameters.validate` gives them."""


class Part(NamedTuple):
    """A part that a scene has or leaves out.

    `on` says which, from the scene's parameters, and `why` says why, in words of the scene. `to_have` and
    `to_leave_out` are the parameters that switch it. `modules` of this package are loaded for it alone, or for one of
    several parts; `of_node` says that the node has the part, not the predictor.
    """

    name: str
    on: Callable[[Values], bool]
    why: Callable[[Values], str]
    to_have: Mapping[str, Any]
    to_leave_out: Mapping[str, Any]
    modules: tuple[str, ...] = ()
    of_node: bool = False


def _why_friction(values: Values) -> str:
    if values["contact.friction"]:
        return f"contact.friction is {values['contact.friction']:g}: a stance may stick, and then moves in closed form"
    return "contact.friction is 0: every stance slips, and its motion is integrated"


def _why_restitution(values: Values) -> str:
    if values["contact.restitution"]:
        return f"contact.restitution is {values['contact.restitution']:g}: the new contact also pushes back"
    return "contact.restitution is 0: a plastic impact ends with the compression"


def _why_twist_window(values: Values) -> str:
    if values["odom.twist_window"]:
        window = f"odom.twist_window is {1e3 * values['odom.twist_window']:g} ms"
        return f"{window}: the twist is older than its stamp, and may have the impact in it"
    return "odom.twist_window is 0: the twist is that of the very instant"


def _why_geometry(values: Values) -> str:
    if values["body.contact_points"]:
        return "the contact points are parameters, so there is no subscription to contact_geometry"
    return "body.contact_points is not given, so the points come from the topic contact_geometry"


def _on_transverse(values: Values) -> bool:
    return bool(values["transverse_slip"] and values["law"] == "path" and values["contact.friction"] > 0.0)


def _why_transverse(values: Values) -> str:
    if not values["transverse_slip"]:
        return "transverse_slip is false: friction acts in the impact plane alone"
    if values["law"] != "path":
        return f"the law is {values['law']}, which knows no slip across the impact plane"
    if not values["contact.friction"]:
        return "contact.friction is 0: nothing opposes slip across the impact plane either"
    return "transverse_slip is true: friction also opposes slip across the impact plane"


def _why_margins(values: Values) -> str:
    if values["margins"]:
        return "margins is true: how far each impact is from another mode, told while somebody reads ~/prediction"
    return "margins is false: nobody asks how far an impact is from another mode"


def _why_uncertainty(values: Values) -> str:
    samples = values["uncertainty.samples"]
    if samples:
        return f"uncertainty.samples is {samples}: so many points carry the uncertainty through each impact"
    return "uncertainty.samples is 0: no probabilities are asked for, so neither numpy nor numba is needed"


def _why_events(values: Values) -> str:
    if values["executor"] == "events":
        return "executor is events: rclpy's experimental one, which costs less for each message"
    return "executor is single: rclpy's usual one; events would be its experimental one"


EVENTS: Final = "events executor"

PARTS: Final = (
    Part(
        "friction",
        lambda values: bool(values["contact.friction"]),
        _why_friction,
        {"contact.friction": 0.3},
        {"contact.friction": 0.0},
    ),
    Part(
        "restitution",
        lambda values: bool(values["contact.restitution"]),
        _why_restitution,
        {"contact.restitution": 0.3},
        {"contact.restitution": 0.0},
    ),
    Part(
        "twist window",
        lambda values: bool(values["odom.twist_window"]),
        _why_twist_window,
        {"odom.twist_window": 0.01},
        {"odom.twist_window": 0.0},
    ),
    Part(
        "transverse slip",
        _on_transverse,
        _why_transverse,
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
        lambda values: not values["body.contact_points"],
        _why_geometry,
        {"body.contact_points": ()},
        {"body.contact_points": (1.0, 0.0, 0.0, -1.0, 0.0, 0.0)},
        ("ros.geometry_topic",),
        of_node=True,
    ),
    Part(
        "margins",
        lambda values: bool(values["margins"]),
        _why_margins,
        {"margins": True},
        {"margins": False},
        ("mechanics.margins", "ros.confidence"),
    ),
    Part(
        "uncertainty",
        lambda values: bool(values["uncertainty.samples"]),
        _why_uncertainty,
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
        _why_events,
        {"executor": "events"},
        {"executor": "single"},
        of_node=True,
    ),
)
"""Every part. Those that others need stand before them."""

CORE: Final = frozenset(
    {
        *("mechanics", "mechanics.answer", "mechanics.first_root", "mechanics.impact"),
        *("mechanics.motion", "mechanics.one_answer", "mechanics.pair", "mechanics.path_law", "mechanics.path_states"),
        *("mechanics.problem", "mechanics.radau", "mechanics.sliding_events", "mechanics.sliding_stance"),
        *("mechanics.sliding_sweep", "mechanics.stretch", "mechanics.total_law"),
        *("mechanics.turning_stance", "mechanics.types"),
        *("prediction", "prediction.approach", "prediction.planar", "prediction.predictor", "prediction.scene"),
        *("prediction.score", "prediction.types", "prediction.vectors"),
    }
)
"""The modules that the predictor loads in every scene."""

CORE_OF_NODE: Final = frozenset(
    {
        *("ros", "ros.cdr", "ros.diagnostics", "ros.messages", "ros.node", "ros.node_parameters"),
        *("ros.predictor_node", "ros.process", "ros.qos"),
    }
)
"""Those that the node loads besides."""


def modules_of(values: Values, node: bool = False) -> frozenset[str]:
    """The modules of this package that a scene loads, in its predictor or in the node, by their names in it."""
    parts = [part for part in PARTS if part.on(values) and (node or not part.of_node)]
    loaded = {module for part in parts for module in part.modules if node or not module.startswith("ros.")}
    return frozenset(CORE | loaded | (CORE_OF_NODE if node else frozenset()))


def ladder(values: Values) -> list[tuple[Part | None, dict[str, Any]]]:
    """The parameters of the core alone, then with one part more each time: first those of the scene, then the others.

    So the costs of the parts, from one to the next, add up to that of the scene, and on to that of everything.
    """
    switched = dict(values)
    for part in PARTS:
        switched.update(part.to_leave_out)
    steps: list[tuple[Part | None, dict[str, Any]]] = [(None, dict(switched))]
    for part in sorted(PARTS, key=lambda part: not part.on(values)):
        switched.update({name: values[name] for name in part.to_have} if part.on(values) else part.to_have)
        steps.append((part, dict(switched)))
    return steps
