"""Every ROS parameter, declared once: the node declares these, and the offline commands check files against them."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from typing import Any, Final

from ..errors import InputError
from .scene import check_body
from .table import PARAMETERS as PARAMETERS
from .table import RETIRED
from .types import Parameter as Parameter
from .types import Value as Value
from .types import allowed, check, values_of

_OF_EVERY_NODE: Final = ("use_sim_time", "start_type_description_service")
_QOS_OVERRIDES: Final = "qos_overrides."
_TAKEN: Final = frozenset(name.partition(".")[0] for name in (*PARAMETERS, *_OF_EVERY_NODE, _QOS_OVERRIDES))
"""First words of parameters, which the name of a body would hide."""


NEARLY: Final = 0.75
"""How like one of ours the name of an unknown parameter is, from 0 to 1, when it is taken for misspelt, not foreign."""


def is_of_every_node(name: str) -> bool:
    """Whether a parameter belongs to ROS itself, so that it may stand beside those of this program."""
    return name in _OF_EVERY_NODE or name.startswith(_QOS_OVERRIDES)


def validate(values: Mapping[str, object]) -> dict[str, Value]:
    """The values of all parameters, with the defaults of those that are not given; lists become tuples.

    With `bodies`, those that are given for one of them follow as <body>.<parameter>, and of a parameter without default
    that is given for each of them alone there is no common value; nor of one that the model of a machine tells, where
    it is not given. Parameters that every ROS node has are passed over, and `foreign` ones.
    `impact_predictor.prediction.scene.scenes_of` makes the scenes of them. InputError where a name is nearly that of a
    parameter, a value has the wrong type or is out of range, one without default is missing, or values do not fit
    together.
    """
    bodies: Any = check(PARAMETERS["bodies"], values.get("bodies", ()))
    passed_over = set(foreign(values))
    given = {name: value for name, value in values.items() if not (is_of_every_node(name) or name in passed_over)}
    for body in bodies:
        if body in _TAKEN:
            raise InputError(f"a body cannot be named {body}, as parameters begin with that; give it another name")
    checked: dict[str, Value] = {"bodies": bodies}
    own: dict[str, Value] = {}
    for name, value in given.items():
        parameter = _parameter_of(name, bodies)
        (checked if name in PARAMETERS else own)[name] = check(parameter._replace(name=name), value)
    defaults = {one.name: one.default for one in PARAMETERS.values() if one.default is not None}
    checked = defaults | checked
    of_each = {body: values_of(checked | own, body) for body in bodies or ("",)}
    for name, parameter in PARAMETERS.items():
        for body, its in of_each.items():
            # The model of a machine may tell it.
            if not (name in its or (parameter.of_model and its["robot.urdf"])):
                meaning, of = parameter.description.rstrip("."), f", or {body}.{name} for {body} alone" if body else ""
                raise InputError(f"the parameter {name} is missing: give {allowed(parameter)} ({meaning}){of}")
    # In one order, whatever that of the file.
    checked = {name: checked[name] for name in PARAMETERS if name in checked} | own
    for body in of_each:
        check_body(body, values_of(checked, body), set(given))
    return checked


def foreign(values: Mapping[str, Any]) -> list[str]:
    """The names of values that are surely meant for other nodes: several may share a file."""
    bodies = values.get("bodies", ())
    of_nodes = [name for name in values if not is_of_every_node(name)]
    return [name for name in of_nodes if name not in PARAMETERS and not _is_nearly_ours(name, bodies)]


def _is_nearly_ours(name: str, bodies: Sequence[str]) -> bool:
    first, _, common = name.partition(".")
    return (
        not name.isprintable()
        or first in (*_TAKEN, *bodies, "")
        or common in PARAMETERS
        or not RETIRED.keys().isdisjoint((name, common))
        or bool(_near(name, bodies, NEARLY))
    )


def _near(name: str, bodies: Sequence[str], likeness: float) -> list[str]:
    """The names of parameters that are like a name."""
    of_bodies = [f"{body}.{one.name}" for body in bodies for one in PARAMETERS.values() if not one.shared]
    known = [one for one in PARAMETERS if one.endswith(f".{name}")]
    return known or difflib.get_close_matches(name, [*PARAMETERS, *of_bodies], n=1, cutoff=likeness)


def parameter_of(name: str) -> Parameter:
    """The parameter of a name that `validate` has let pass, which may begin with that of a body; KeyError where there
    is none.
    """
    return PARAMETERS.get(name) or PARAMETERS[name.partition(".")[2]]


def check_change(before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
    """Whether the node may go on from some validated values to others; InputError where a parameter has changed that
    cannot while the node runs.
    """
    for name in {**before, **after}:
        why = parameter_of(name).fixed
        if why and before.get(name) != after.get(name):
            raise InputError(
                f"the parameter {name} cannot change while the node runs, for {why}: start the node again with it"
            )


def _parameter_of(name: str, bodies: Sequence[str]) -> Parameter:
    """The parameter of a name that was given; InputError where there is none."""
    if name in PARAMETERS:
        return PARAMETERS[name]
    body, _, common = name.partition(".")
    if common in PARAMETERS and body in bodies:
        if PARAMETERS[common].shared:
            raise InputError(f"the parameter {common} holds for all bodies: give {common} in the place of {name}")
        return PARAMETERS[common]
    for one in (name, common):
        if one in RETIRED:
            raise InputError(f"there is no parameter {one} any more: {RETIRED[one]}")
    shown = name if name.isprintable() and name else repr(name)
    raise InputError(f"there is no parameter {shown}{_hint(name, bodies)}")


def _hint(name: str, bodies: Sequence[str]) -> str:
    body, _, common = name.partition(".")
    if common in PARAMETERS and body not in _TAKEN:
        return f", for {body} is not among the bodies: {', '.join(bodies)}" if bodies else ", for bodies is not given"
    close = _near(name, bodies, 0.5)
    return f", did you mean {close[0]}?" if close else f"; there are {', '.join(PARAMETERS)}"
