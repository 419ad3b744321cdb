"""What is said of a replay besides what it found: why nothing was predicted, what was refused, what looks wrong."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from ..prediction.checks import REMEDIES
from ..prediction.scene import CONTACT_GEOMETRY, JOINTS, SCHEDULE, STATES, WRENCH, Input, Scene, inputs_of
from ..prediction.types import Status
from .inputs import TYPES
from .run import Run

StatusCounts = Mapping[Status, int]

MENDABLE: Final = (
    Status.MALFORMED,
    Status.WRONG_FRAME,
    Status.FEET_CHANGED,
    Status.WRONG_JOINTS,
    Status.BELOW_GROUND,
    Status.GEOMETRY_STALE,
    Status.SINGULAR_INERTIA,
)
"""Why messages are refused of which more may be known than that they are wrong."""

NAMELESS: Final = {
    (SCHEDULE, Status.FEET_CHANGED): "joint_names has a name that is none of feet.names",
    (WRENCH, Status.WRONG_FRAME): "frame_id is none of feet.names",
}
"""What is wrong with messages about a foot that the scene does not name."""

MISSED: Final = {
    WRENCH: "feet.force asks for it: no sensor confirms that a foot stands",
    SCHEDULE: "feet.has_schedule asks for it: no landing is told to be early or late",
}
"""What follows where nothing comes on an input of which feet can do without."""


def why_unpredictable(
    run: Run, inputs: Mapping[Input, StatusCounts], names: Mapping[Input, str], scenes: Mapping[str, Scene]
) -> str:
    """Why no state could be used, or none as the feet that the bag tells of, in one sentence, or ""."""
    states = {one: counts for one, counts in inputs.items() if one.body is not None and one.kind in STATES}
    # Bodies of which nothing is measured are watched by the motion of the support alone.
    states = states or dict(inputs)
    if not states:
        return "nothing is measured in this scene, so there is nothing for it in a bag"
    counts = total_of(states.values())
    where = ", ".join(names[one] for one in states)
    if not counts:
        return f"there is no message on {where}, so nothing was predicted"
    if Status.ACCEPTED in counts:
        feet = [] if run.settled else _unnamed_feet(run, inputs, names)
        return f"no touchdown was predicted, and {feet[0]}" if feet else ""
    status, refused = max(counts, key=lambda one: counts[one]), list(states)
    if status is Status.NO_GEOMETRY:
        # What became of the contact points says more.
        told = {one: those for one, those in inputs.items() if one.kind in (CONTACT_GEOMETRY, JOINTS)}
        counts = total_of(told.values())
        faults = {one: count for one, count in counts.items() if one is not Status.ACCEPTED}
        if not faults:
            return _without_points(list(told), names, scenes)
        status, refused = max(faults, key=lambda one: faults[one]), list(told)
        where = ", ".join(names[one] for one in told)
    words = next((said for one in refused if (said := _words(run, one, status))), REMEDIES[status])
    return (
        f"no sample was accepted, so nothing was predicted: {counts[status]} of {sum(counts.values())} messages on "
        f"{where} are {status.name}: {words}"
    )


def _without_points(told: Sequence[Input], names: Mapping[Input, str], scenes: Mapping[str, Scene]) -> str:
    needed = next((one.kind for one in inputs_of(scenes) if one.kind in (CONTACT_GEOMETRY, JOINTS)), CONTACT_GEOMETRY)
    topics = [names[one] for one in told if one.kind == needed]
    where = f"{', '.join(topics)} told none" if topics else f"there is no {TYPES[needed]} in the bag"
    # The points of feet move: they cannot be parameters.
    or_give = (
        "" if any(scene.walking for scene in scenes.values()) else "give body.contact_points in the parameter file, or "
    )
    return f"no contact points are known, so nothing was predicted: {where}; {or_give}--remap {needed}:=TOPIC"


def _words(run: Run, one: Input, status: Status) -> str:
    """What is wrong with the messages on an input that were refused for a reason, as far as more is known of them."""
    if status is Status.MALFORMED:
        return run.unusable.get(one, "")
    if (one.kind, status) in NAMELESS:
        return NAMELESS[one.kind, status]
    has_points = one.kind in (*STATES, CONTACT_GEOMETRY, JOINTS) and one.body is not None and one.body in run.points
    return run.points[one.body or ""].words(status) if has_points else ""


def remarks(
    run: Run, inputs: Mapping[Input, StatusCounts], names: Mapping[Input, str], scenes: Mapping[str, Scene]
) -> list[str]:
    """What was left out of the predictions, and what looks wrong in bag or scene, one sentence each."""
    said = _refused(run, inputs, names) + _unnamed_feet(run, inputs, names)
    for one in inputs_of(scenes):
        if one.kind in MISSED and not inputs.get(one):
            otherwise = "" if one in names else f"; if there is another topic of it, --remap {one.name}:=TOPIC"
            said.append(f"nothing comes on {names.get(one, one.name)}, though {MISSED[one.kind]}{otherwise}")
    for one in inputs:
        if one.kind in (CONTACT_GEOMETRY, JOINTS) and one.body is not None:
            said += [f"{names[one]}: {doubt}" for doubt in run.points[one.body].doubts()]
    if run.landings is not None and (later := run.landings.later()):
        landings = "1 true landing is" if later == 1 else f"{later:,} true landings are"
        said.append(f"{landings} after the last sample that was accepted, and not counted")
    return said


def _unnamed_feet(run: Run, inputs: Mapping[Input, StatusCounts], names: Mapping[Input, str]) -> list[str]:
    """What tells of feet though the scene names none, one sentence for each body."""
    said: dict[str, str] = {}
    for one in (each for each in inputs if each.body is not None):
        body = one.body or ""
        if one.kind in STATES and body in run.unnamed_feet:
            said[body] = (
                f"{names[one]} tells which feet stand, but the scene is of a body without feet; give that of a machine "
                "that walks, with feet.names, as config/walker_hyq.yaml has them"
            )
        elif one.kind in (CONTACT_GEOMETRY, JOINTS) and (moving := run.points[body].moving()):
            said.setdefault(body, f"{names[one]}: {moving}")
    return list(said.values())


def _refused(run: Run, inputs: Mapping[Input, StatusCounts], names: Mapping[Input, str]) -> list[str]:
    """Why messages were refused, each topic and reason once."""
    said: dict[tuple[str, Status], str] = {}
    for one, counts in inputs.items():
        for status, count in counts.items():
            words = _words(run, one, status)
            if words and status in MENDABLE:
                refused = f"{count:,} of {sum(counts.values()):,} messages on {names[one]} were refused"
                # A message with an adapter is on several inputs.
                said.setdefault((names[one], status), f"{refused} as {status.name}: {words}")
    return list(said.values())


def total_of(counts: Iterable[StatusCounts]) -> dict[Status, int]:
    """The sum of what became of messages, in the order of the statuses."""
    total = sum(map(Counter, counts), Counter[Status]())
    return {status: total[status] for status in Status if total[status]}
