"""The words of a map's picture: names, meanings and numbers of its modes, axes and conditions."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ...mechanics.types import Mode
from .modes import ModeMap
from .parameters import SUBJECTS, Axis

MEANINGS: Final = {
    Mode.NO_IMPACT: "B is not approached",
    Mode.STOP: "A and B hold, neither slips",
    Mode.SLIDE: "A and B hold and slip",
    Mode.PIVOT_SLIDE: "A lifts, B slips",
    Mode.PIVOT: "A lifts, B sticks",
    Mode.BACK_PIVOT: "B lifts again, A holds",
    Mode.FLIGHT: "A and B lift",
}
PAPER_NUMBERS: Final = {Mode.STOP: 1, Mode.SLIDE: 2}
"""The numbers that the paper uses for one mode all through; its 3 and 4 change places between its sections."""

TITLES: Final = {
    "plate": "Plate on a floor: what follows when it turns about A and strikes B",
    "rod": "Rod over two supports: what follows when it turns about A and strikes B",
    "cylinder": "Cylinder between two edges: what follows when it turns about A and strikes B",
}


def hatched(modes: ModeMap) -> tuple[tuple[NDArray[np.bool_], str], ...]:
    """Where a law has no single answer, and what to say of it and of the answer that the map shows there."""
    jam, path, total = (
        ("what follows the tangential impact at A that resolves the jam", "one of its answers", "the path law")
        if modes.law == "path"
        else ("the total law", "the total law", "the answer nearest to that of the path")
    )
    return (
        (modes.jammed, f"the impulse path jams (Painlevé): shown is {jam}"),
        (~modes.path_unique, f"the impulse path is not unique: shown is {path}"),
        (~modes.total_unique, f"the total law is not unique: shown is {total}"),
    )


def told(modes: ModeMap) -> set[str]:
    """The parameters that are given, or an axis; the others follow from them."""
    return {*modes.fixed, modes.x.name, modes.y.name}


def axis_label(axis: Axis, modes: ModeMap) -> str:
    """Symbols, meaning and unit of what changes along an axis."""
    parameters = SUBJECTS[modes.subject].parameters
    parameter, symbols, meaning = parameters[axis.name], [parameters[axis.name].symbol], parameters[axis.name].meaning
    for name, other in parameters.items():
        if parameter.together and other.otherwise == axis.name and name not in told(modes):
            symbols, meaning = [*symbols, other.symbol], parameter.together
    unit = f" ({parameter.unit})" if parameter.unit else ""
    return f"{' = '.join(map(italic, symbols))}, {meaning}{unit}"


def conditions(modes: ModeMap) -> str:
    """What is the same all over the map."""
    parameters, said = SUBJECTS[modes.subject].parameters, []
    for name, parameter in parameters.items():
        leader = parameter.otherwise
        if name in modes.fixed:
            if name != "slip" or modes.fixed[name] != 0.0:
                unit = f" {parameter.unit}" if parameter.unit not in ("", "°") else parameter.unit
                said.append(f"{italic(parameter.symbol)} = {modes.fixed[name]:g}{unit}")
        elif leader not in ("", "friction", modes.x.name, modes.y.name) and name not in told(modes):
            said.append(
                f"{italic(parameter.symbol)} = {italic(parameters[leader].symbol if leader in parameters else leader)}"
            )
    return ", ".join((*said, f"{modes.law} law"))


def formula_note(modes: ModeMap) -> str:
    """What the legend says of the borders."""
    symbols = []
    if modes.subject == "cylinder":
        symbols.append(f"t = tan {'(γ₁ + γ₂)/2' if 'gamma_new' in told(modes) else 'γ'}")
        if "inertia" in told(modes):
            symbols.append("k = J/mR²")
    elif "inertia" in told(modes) or (modes.subject == "plate" and {"a", "b", "height"} & told(modes)):
        symbols.append("ρ² = J/m")
    return ",\n".join(("border by the paper's formula", *filter(None, [", ".join(symbols)])))


def italic(symbol: str) -> str:
    """A symbol as a formula has it, if it is one letter with or without an index."""
    return f"${symbol}$" if len(symbol) == 1 or "_" in symbol else symbol
