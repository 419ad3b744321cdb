"""What is said of a replay besides what it found: why nothing was predicted, what was refused, what looks wrong."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Final

from ..prediction.checks import REMEDIES
from ..prediction.scene import CONTACT_GEOMETRY, POINTS, SCHEDULE, STATES, TERRAIN, WRENCH, Input, Scene, inputs_of
from ..prediction.types import Status
from ..ros.messages import INPUT_TYPES
from ..wording import listed

if TYPE_CHECKING:
    from .run import Run

StatusCounts = Mapping[Status, int]

MENDABLE: Final = (
    Status.NOT_FINITE,
    Status.BAD_QUATERNION,
    Status.MALFORMED,
    Status.WRONG_FRAME,
    Status.NO_TRANSFORM,
    Status.FEET_CHANGED,
    Status.WRONG_JOINTS,
    Status.BELOW_GROUND,
    Status.GEOMETRY_STALE,
    Status.SINGULAR_INERTIA,
)
"""Why messages are refused of which more may be known than that they are wrong."""

MISSED: Final = {
    WRENCH: "feet.force asks for it: no sensor confirms that a foot stands",
    TERRAIN: "feet.terrain asks for it: levels are those that feet have shown",
    SCHEDULE: "feet.has_schedule asks for it: no landing is told to be early or late",
}
"""What follows where nothing comes on an input of which feet can do without."""

_MOST_NAMED: Final = 4


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
        of_points = {one: those for one, those in inputs.items() if one.kind in POINTS}
        counts = total_of(of_points.values())
        faults = {one: count for one, count in counts.items() if one is not Status.ACCEPTED}
        if not faults:
            return _without_points(list(of_points), names, scenes)
        status, refused = max(faults, key=lambda one: faults[one]), list(of_points)
        where = ", ".join(names[one] for one in of_points)
    words = next((said for one in refused if (said := _words(run, inputs, one, status))), REMEDIES[status])
    return (
        f"no sample was accepted, so nothing was predicted: {counts[status]} of {sum(counts.values())} messages on "
        f"{where} are {status.name}: {words}"
    )


def _without_points(of_points: Sequence[Input], names: Mapping[Input, str], scenes: Mapping[str, Scene]) -> str:
    needed = next((one.kind for one in inputs_of(scenes) if one.kind in POINTS), CONTACT_GEOMETRY)
    topics = [names[one] for one in of_points if one.kind == needed]
    where = f"{', '.join(topics)} told none" if topics else f"there is no {INPUT_TYPES[needed].name} in the bag"
    # The points of feet move: they cannot be parameters.
    or_give = (
        "" if any(scene.walking for scene in scenes.values()) else "give body.contact_points in the parameter file, or "
    )
    return f"no contact points are known, so nothing was predicted: {where}; {or_give}--remap {needed}:=TOPIC"


def _words(run: Run, inputs: Mapping[Input, StatusCounts], one: Input, status: Status) -> str:
    """What is wrong with the messages on an input that were refused for a reason, as far as more is known of them."""
    record = run.bodies.get(one.body or "")
    if status is Status.GEOMETRY_STALE and record is not None and record.scene.walking is not None:
        timeout = record.scene.walking.timeout
        of_points = [those for each, those in inputs.items() if each.body == one.body and each.kind in POINTS]
        if any(those.keys() - {Status.ACCEPTED} for those in of_points):
            return "no message about the feet could be used for longer than feet.timeout"
        if record.interval > timeout:
            return (
                f"the feet are told of every {record.interval:.2g} s, but feet.timeout is {timeout:g} s: "
                "tell of them with each sample"
            )
    return run.flaws.get((one, status), "" if status is Status.MALFORMED else REMEDIES.get(status, ""))


def remarks(
    run: Run, inputs: Mapping[Input, StatusCounts], names: Mapping[Input, str], scenes: Mapping[str, Scene]
) -> list[str]:
    """What was left out of the predictions, and what looks wrong in bag or scene, one sentence each."""
    # A message with an adapter is on several inputs, but one that is refused on all of them: each topic and reason is
    # told once, with the input that has most messages.
    refused: dict[tuple[str, Status], str] = {}
    for one, counts in sorted(inputs.items(), key=lambda item: -sum(item[1].values())):
        for status in [one for one in MENDABLE if one in counts]:
            if words := _words(run, inputs, one, status):
                count = f"{counts[status]:,} of {sum(counts.values()):,} messages on {names[one]}"
                refused.setdefault((names[one], status), f"{count} were refused as {status.name}: {words}")
    said = [*refused.values(), *_unnamed_feet(run, inputs, names)]
    for one in inputs_of(scenes):
        told = one.kind == WRENCH and run.bodies[one.body or ""].is_pressed
        if one.kind in MISSED and not inputs.get(one) and not told:
            otherwise = "" if one in names else f"; if there is another topic of it, --remap {one.name}:=TOPIC"
            said.append(f"nothing comes on {names.get(one, one.name)}, though {MISSED[one.kind]}{otherwise}")
    for one in inputs:
        if one.kind in POINTS and one.body is not None:
            unknown = listed(run.monitor.predictors[one.body].contacts.unknown_joints, _MOST_NAMED)
            if unknown:
                left_out = f"robot.urdf does not know {unknown}, so what is told of these joints is left out"
                said.append(f"{names[one]}: {left_out}")
    said += run.monitor.deck.doubts() if run.monitor.deck is not None else ()
    for body, record in run.bodies.items():
        contacts, walking = run.monitor.predictors[body].contacts, record.scene.walking
        doubts = list(contacts.doubts())
        if walking is not None and walking.find_delay:
            found = contacts.delay
            known = f"{found}: {1e3 * found.taken:.1f} ms are taken out" if found else "not yet known to be late"
            doubts.append(f"the feet are {known}")
        said += [f"{body}: {doubt}" if body else doubt for doubt in doubts]
    if run.comparison is not None and (later := run.comparison.later_landings()):
        landings = "1 true landing is" if later == 1 else f"{later:,} true landings are"
        said.append(f"{landings} after the last sample that was accepted, and not counted")
    return said


def _unnamed_feet(run: Run, inputs: Mapping[Input, StatusCounts], names: Mapping[Input, str]) -> list[str]:
    """What tells of feet though the scene names none, one sentence for each body."""
    said: dict[str, str] = {}
    for one in inputs:
        record = run.bodies.get(one.body or "")
        if record is None or one.body is None or record.gait is not None:
            continue
        if one.kind in STATES and one.body in run.unnamed_feet:
            said[one.body] = (
                f"{names[one]} tells which feet stand, but the scene is of a body without feet; give that of a machine "
                "that walks, with feet.names, as config/walker_hyq.yaml has them"
            )
        elif one.kind == CONTACT_GEOMETRY and 2 * record.moved > record.told:
            said.setdefault(
                one.body,
                f"{names[one]}: the contact points are elsewhere than at first in {record.moved:,} of "
                f"{record.told:,} messages; if they are the feet of a machine that walks, give the names of these as "
                "feet.names",
            )
    return list(said.values())


def total_of(counts: Iterable[StatusCounts]) -> dict[Status, int]:
    """The sum of what became of messages, in the order of the statuses."""
    total = sum(map(Counter, counts), Counter[Status]())
    return {status: total[status] for status in Status if total[status]}
