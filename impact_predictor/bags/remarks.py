"""What is said of a replay besides what it found: why nothing was predicted, what was refused, what looks wrong."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from math import dist, inf
from statistics import median
from typing import TYPE_CHECKING, Final

from ..prediction.checks import REMEDIES
from ..prediction.scene import CONTACT_GEOMETRY, JOINTS, SCHEDULE, STATES, WRENCH, Input, Scene, inputs_of
from ..prediction.types import Geometry, Joints, Prediction, Sample, Status, Vector3
from ..prediction.vectors import add, axes_of, dot, to_world
from ..ros.messages import INPUT_TYPES
from ..stamps import NANOSECONDS
from ..wording import listed

if TYPE_CHECKING:
    from ..prediction.predictor import Contacts
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


MOVED: Final = 0.01
"""Contact points that are further than so many m from where they were first have moved."""

NEAR: Final = 4.0
"""Feet that never come nearer to the ground than so many contact tolerances never reach it."""

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
        of_points = {one: those for one, those in inputs.items() if one.kind in (CONTACT_GEOMETRY, JOINTS)}
        counts = total_of(of_points.values())
        faults = {one: count for one, count in counts.items() if one is not Status.ACCEPTED}
        if not faults:
            return _without_points(list(of_points), names, scenes)
        status, refused = max(faults, key=lambda one: faults[one]), list(of_points)
        where = ", ".join(names[one] for one in of_points)
    words = next((said for one in refused if (said := _words(run, one, status))), REMEDIES[status])
    return (
        f"no sample was accepted, so nothing was predicted: {counts[status]} of {sum(counts.values())} messages on "
        f"{where} are {status.name}: {words}"
    )


def _without_points(of_points: Sequence[Input], names: Mapping[Input, str], scenes: Mapping[str, Scene]) -> str:
    needed = next((one.kind for one in inputs_of(scenes) if one.kind in (CONTACT_GEOMETRY, JOINTS)), CONTACT_GEOMETRY)
    topics = [names[one] for one in of_points if one.kind == needed]
    where = f"{', '.join(topics)} told none" if topics else f"there is no {INPUT_TYPES[needed].name} in the bag"
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


class ContactPoints:
    """What was told about the contact points of one body, and what became of it."""

    def __init__(self, scene: Scene, contacts: Contacts) -> None:
        self._scene, self._contacts = scene, contacts
        self._left_out: tuple[str, ...] = ()
        self._first: Geometry | None = None
        self._last: Geometry | None = None
        self._messages = self._moved = self._refused = 0
        self._flaws: Counter[str] = Counter()
        self._depths: list[float] = []
        self._nearest = self._nearest_in_world = inf
        self._sample: Sample | None = None

    def take_geometry(self, geometry: Geometry, status: Status) -> None:
        """Take a message of contact_geometry, or the points that follow from joints, and what became of it."""
        self._refused += status is not Status.ACCEPTED
        if status is Status.FEET_CHANGED:
            self._flaws[self._wrong_number(geometry)] += 1
        elif status in (Status.ACCEPTED, Status.BELOW_GROUND):
            first = self._first = self._first or geometry
            self._last, self._messages = geometry, self._messages + 1
            self._moved += any(dist(*pair) > MOVED for pair in zip(first.points, geometry.points, strict=False))
            self._nearest_in_world = min([self._nearest_in_world, *map(abs, map(self._gap, geometry.points))])
        if status is Status.BELOW_GROUND:
            self._measure_depth()

    def take_joints(self, joints: Joints, status: Status) -> None:
        """Take a message of joint_states, and what became of it."""
        if status is Status.WRONG_JOINTS:
            self._refused += 1
            self._flaws[_wrong_joints(joints, self._contacts.joints)] += 1
        elif self._contacts.geometry is not None:
            self._left_out = self._contacts.unknown_joints
            self.take_geometry(self._contacts.geometry, status)

    def take(self, prediction: Prediction) -> None:
        """Take the answer to a sample."""
        self._sample = prediction.sample
        if prediction.status is Status.BELOW_GROUND:
            self._measure_depth()
        self._nearest = min([self._nearest, *[abs(foot.gap) for foot in prediction.feet]])

    def words(self, status: Status) -> str:
        """What is wrong where messages are refused for a reason, and what to do."""
        if status in (Status.FEET_CHANGED, Status.WRONG_JOINTS) and self._flaws:
            return self._flaws.most_common(1)[0][0]
        if status is Status.BELOW_GROUND and self._depths:
            return (
                f"the lowest foot lies {median(self._depths):.3g} m below the ground: compare support.height, the "
                "units of the points (m), and the frames of body and points"
            )
        walking = self._scene.walking
        if status is Status.GEOMETRY_STALE and walking is not None:
            if self._refused:
                return "no message about the feet could be used for longer than feet.timeout"
            if self._interval > walking.timeout:
                return (
                    f"the feet are told of every {self._interval:.2g} s, but feet.timeout is {walking.timeout:g} s: "
                    "tell of them with each sample"
                )
        return REMEDIES.get(status, "")

    def doubts(self) -> list[str]:
        """What is left out of the messages, and what speaks against the scene although they fit it."""
        said = []
        if self._left_out:
            unknown = listed(self._left_out, _MOST_NAMED)
            said.append(f"robot.urdf does not know {unknown}, so what is told of these joints is left out")
        near = NEAR * self._scene.tolerance
        if near < self._nearest < inf:
            said.append(f"no foot came nearer to the ground than {self._nearest:.3g} m")
            said[-1] += (
                ", while the points reach it as if they were places in the world: tell them in the frame of the body"
                if self._nearest_in_world < near
                else ": compare support.height, the units of the points (m), and the frames of body and points"
            )
        return said

    def moving(self) -> str:
        """What is said of points that move against a body whose scene names no feet; "" where they do not."""
        if self._scene.walking is not None or 2 * self._moved <= self._messages:
            return ""
        return (
            f"the contact points are elsewhere than at first in {self._moved:,} of {self._messages:,} messages; "
            "if they are the feet of a machine that walks, give the names of these as feet.names"
        )

    @property
    def _interval(self) -> float:
        """The mean time in s from one message to the next."""
        if self._first is None or self._last is None or self._messages < 2:
            return 0.0
        return (self._last.stamp - self._first.stamp) / NANOSECONDS / (self._messages - 1)

    def _gap(self, place: Vector3) -> float:
        return dot(self._scene.normal, place) - self._scene.height

    def _measure_depth(self) -> None:
        sample, geometry = self._sample, self._last
        if sample is not None and geometry is not None:
            axes = axes_of(sample.orientation)
            places = [add(sample.position, to_world(axes, point)) for point in geometry.points]
            self._depths.append(-min(map(self._gap, places)))

    def _wrong_number(self, geometry: Geometry) -> str:
        walking, number = self._scene.walking, len(geometry.points)
        assert walking is not None
        wanted = len(walking.feet) * walking.points
        if number == wanted:
            return f"{len(geometry.velocities)} velocities came with {number} points: give one for each, or none"
        return (
            f"{number} points came, but feet.names ({len(walking.feet)}) x feet.points ({walking.points}) wants "
            f"{wanted}: correct these, or the message"
        )


def _wrong_joints(joints: Joints, known: Sequence[str]) -> str:
    lacking = [name for name in known if name not in joints.names]
    if not lacking:
        sizes = f"{len(joints.names)} names, {len(joints.positions)} positions and {len(joints.velocities)} velocities"
        return f"it has {sizes}, or a joint twice: tell each joint once, with its position"
    unknown = [name for name in joints.names if name not in known]
    others = f", while robot.urdf does not know its {listed(unknown, _MOST_NAMED)}" if unknown else ""
    lacks = listed(lacking, _MOST_NAMED)
    return f"it lacks {lacks} of robot.urdf{others}: tell every joint of the model by its name there"
