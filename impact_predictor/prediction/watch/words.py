"""What the watch over a body says: its message in words, its values as text."""

from __future__ import annotations

from math import degrees, inf
from typing import Final, NamedTuple

from ...mechanics.types import Mode
from ..remedies import REMEDIES
from ..scene import Watching
from ..types import Status
from .standing import Motion

UNKNOWN: Final = "unknown"


class Used(NamedTuple):
    """The parts of the margins against tipping about an edge, by its name, and against sliding that are used up."""

    tip: float
    edge: str
    slide: float


class Known(NamedTuple):
    """What is known of one body; `used`, the times in s (inf where none) and the `barrier` in J that it takes to topple
    over `barrier_edge` are None or not told where the support or the body is not known.
    """

    status: Status
    rolls: bool
    solid: bool
    motion: Motion
    tilt: float | None
    toppled: bool
    slid: str
    kinetic: float
    strike: tuple[float, Mode] | None
    used: Used | None
    lifted: bool
    time_to_tip: float
    time_to_slide: float
    barrier: float
    barrier_edge: str
    slides_per_hour: float
    tips_per_hour: float
    impacts_per_hour: float | None


def reasons(known: Known) -> list[str]:
    """What raises the level besides the margins, the gravest first."""
    found = []
    if known.status is not Status.ACCEPTED:
        found.append(f"{known.status.name}: {REMEDIES[known.status]}")
    elif not known.solid:
        found.append("stands on a single point: look at its contact points and at how it is placed")
    if known.toppled:
        found.append("has toppled: it lies on another side")
    if known.motion is Motion.ROCKS:
        tilt = "" if known.tilt is None else f", tilted by {degrees(known.tilt):.1f} degrees"
        found.append(known.motion.value + tilt + _short_of_toppling(known))
    elif known.motion is Motion.LIFTS:
        found.append(known.motion.value)
    if known.slid:
        found.append(known.slid)
    if known.strike is not None:
        time, mode = known.strike
        found.append(f"strikes in {time:.2f} s: {mode.name}")
    used = known.used
    if used is not None:
        tips, _, slides, _ = _verbs(known.rolls)
        for part, time, verb in ((used.tip, known.time_to_tip, tips), (used.slide, known.time_to_slide, slides)):
            if part < 1.0 and 0.0 < time < inf:
                found.append(f"{verb} in {time:.1f} s if the deck goes on so")
    return found


def margins(used: Used, watching: Watching, rolls: bool) -> str:
    """The parts of the margins that are used up, in words, the larger one first."""
    tips, tipping, slides, sliding = _verbs(rolls)
    edge = f" its {used.edge} edge" if used.edge else ""
    found = []
    for part, does, doing, where in ((used.tip, tips, tipping, edge), (used.slide, slides, sliding, "")):
        near = "near " if part >= watching.warn else ""
        about = (" over" if rolls else " about") + where if where else ""
        found.append((part, (does if part >= 1.0 else near + doing) + about))
    (first, what), (second, other) = sorted(found, key=lambda one: -one[0])
    return f"{what}: {first:.2f} of the margin used; {other}: {second:.2f}"


def message(known: Known, watching: Watching, held: tuple[float, str] | None) -> str:
    """The message of a report; `held` is when (s ago) and why the level was raised, where nothing justifies it now."""
    words = reasons(known)
    held_fast = known.used is None or max(known.used.tip, known.used.slide) < 1.0
    if not words and known.motion is not Motion.UNKNOWN and held_fast:
        words.append(known.motion.value)
    if known.lifted:
        words.append("weighs nothing on the deck: it lifts off")
    elif known.used is not None:
        words.append(margins(known.used, watching, known.rolls))
    past = "" if held is None else f" ({held[0]:.1f} s ago: {held[1]})"
    return "; ".join(words) + past


def values(known: Known) -> dict[str, str]:
    """The values of a report, always the same in the same order."""
    used = known.used
    energy = max(0.0, known.barrier - known.kinetic)
    return {
        "slide_ratio": UNKNOWN if used is None else f"{used.slide:.3f}",
        "tip_ratio": UNKNOWN if used is None else f"{used.tip:.3f}",
        "edge": UNKNOWN if used is None else used.edge or "none",
        "time_to_tip": UNKNOWN if used is None else f"{known.time_to_tip:.2f}",
        "time_to_slide": UNKNOWN if used is None else f"{known.time_to_slide:.2f}",
        "energy_to_topple": UNKNOWN if used is None else f"{energy:.3f}",
        "tilt": UNKNOWN if known.tilt is None else f"{known.tilt:.4f}",
        "slides_per_hour": f"{known.slides_per_hour:.1f}",
        "tips_per_hour": f"{known.tips_per_hour:.1f}",
        "impacts_per_hour": UNKNOWN if known.impacts_per_hour is None else f"{known.impacts_per_hour:.1f}",
        "status": known.status.name,
    }


def _short_of_toppling(known: Known) -> str:
    if known.used is None or not known.barrier_edge:
        return ""
    energy = known.barrier - known.kinetic
    if energy > 0.0:
        return f", {energy:.3g} J short of toppling over its {known.barrier_edge} edge"
    return f", would topple over its {known.barrier_edge} edge if the deck stayed so"


def _verbs(rolls: bool) -> tuple[str, str, str, str]:
    return ("rolls", "rolling", "spins", "spinning") if rolls else ("tips", "tipping", "slides", "sliding")
