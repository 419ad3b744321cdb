"""Frames that transforms connect, as those on /tf and /tf_static do: a message in one of them, seen from another."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf
from operator import attrgetter
from typing import Any, Final, NamedTuple

from ..stamps import NANOSECONDS
from .checks import LARGEST, PAUSE, check_orientation
from .types import FeetStates, Geometry, Quaternion, Sample, Status, Terrain, Transform, Vector3
from .vectors import (
    Axes,
    add,
    axes_of,
    composed,
    conjugate,
    cross,
    dot,
    rotation_between,
    times,
    to_body,
    to_world,
    turned,
)

REMEMBERED: Final = 10 * NANOSECONDS
"""Transforms of a frame that are older than its newest by more ns are forgotten, as tf2 does."""

_AT_REST: Final = (0.0, 0.0, 0.0)
_LEVEL: Final = (0.0, 0.0, 0.0, 1.0)
_STAMP: Final = attrgetter("stamp")


class Motion(NamedTuple):
    """A frame as seen from another, along whose axes all of it is: pose in m, velocities in m/s and rad/s."""

    position: Vector3 = _AT_REST
    orientation: Quaternion = _LEVEL
    linear: Vector3 = _AT_REST
    angular: Vector3 = _AT_REST

    def of(self, inner: Motion) -> Motion:
        """What is seen from this frame, as seen from the other one."""
        axes = axes_of(self.orientation)
        arm = to_world(axes, inner.position)
        return Motion(
            add(self.position, arm),
            composed(self.orientation, inner.orientation),
            add(add(self.linear, cross(self.angular, arm)), to_world(axes, inner.linear)),
            add(self.angular, to_world(axes, inner.angular)),
        )

    def inverse(self) -> Motion:
        """The other frame as seen from this one."""
        axes = axes_of(self.orientation)
        drift = add(cross(self.angular, self.position), self.linear, -1.0)
        place, spin = times(self.position, -1.0), times(self.angular, -1.0)
        return Motion(to_body(axes, place), conjugate(self.orientation), to_body(axes, drift), to_body(axes, spin))


@dataclass(slots=True)
class Branch:
    """A frame in its parent: one pose where it is fixed there, else the last ones in the order of their stamps."""

    parent: str
    is_fixed: bool
    poses: list[Transform]

    def add(self, one: Transform) -> None:
        """Take another pose of a frame that moves; a clock that has started anew begins anew."""
        poses = self.poses
        if poses[-1].stamp - one.stamp > PAUSE:
            poses.clear()
        k = bisect_left(poses, one.stamp, key=_STAMP)
        poses[k : k + (k < len(poses) and poses[k].stamp == one.stamp)] = [one]
        del poses[: bisect_left(poses, poses[-1].stamp - REMEMBERED, key=_STAMP)]

    def at(self, stamp: int) -> Motion | None:
        """The frame at a stamp, the newest known for 0; None before the first pose and after the last.

        Between two poses both velocities are constant: straight lines, and turns about one axis. At a pose they are
        those before it.
        """
        poses = self.poses
        stamp = stamp or poses[-1].stamp
        k = bisect_left(poses, stamp, key=_STAMP)
        if not self.is_fixed and (k == len(poses) or (k == 0 and poses[0].stamp != stamp)):
            return None
        if len(poses) == 1:
            return Motion(poses[0].position, poses[0].orientation)
        first, second = poses[max(k, 1) - 1 : max(k, 1) + 1]
        rate = NANOSECONDS / (second.stamp - first.stamp)
        since = (stamp - first.stamp) / NANOSECONDS
        linear = times(add(second.position, first.position, -1.0), rate)
        spin = rotation_between(first.orientation, second.orientation, rate)
        return Motion(
            add(first.position, linear, since),
            turned(first.orientation, times(spin, since)),
            linear,
            to_world(axes_of(first.orientation), spin),
        )


class FrameTree:
    """The frames that are known, each in its parent. `flaw` says why the last message could not be brought to one."""

    def __init__(self) -> None:
        self.flaw = ""
        self._branches: dict[str, Branch] = {}
        self._fixed: dict[tuple[str, str], Motion] = {}  # of frames as seen from others that no moving one connects

    def take(self, transforms: Iterable[Transform], is_fixed: bool) -> Status:
        """Take transforms, `is_fixed` those that hold at any time; what became of the worst of them."""
        worst = Status.ACCEPTED
        for one in transforms:
            status = check_orientation(one.orientation)
            if not dot(one.position, one.position) < LARGEST:
                status = Status.NOT_FINITE
            if status is not Status.ACCEPTED:
                worst = status
                continue
            one = one._replace(orientation=turned(one.orientation, _AT_REST))  # of unit length
            branch = self._branches.get(one.child_frame_id)
            if branch is None or is_fixed or branch.is_fixed or branch.parent != one.frame_id:
                self._branches[one.child_frame_id] = Branch(one.frame_id, is_fixed, [one])
                self._fixed.clear()
            else:
                branch.add(one)
        return worst

    def seen(self, sample: Sample, frames: Sequence[str], child: str) -> Sample | None:
        """The sample of the frame `child` in the nearest of some frames; None where no transforms lead there.

        A `child` that moves against that of the sample has its velocity, too. The frames that a sample may be in are at
        rest among each other: where their transforms change, an estimate was corrected, and no velocity is added.
        """
        if child and sample.child_frame_id and sample.child_frame_id != child:
            moved = self._motion(child, sample.child_frame_id, sample.stamp)
            if moved is None:
                return None
            sample = _of_child(sample, moved, child)
        if frames and sample.frame_id and sample.frame_id not in frames:
            frame = min(frames, key=partial(self._steps, sample.frame_id))
            moved = self._motion(sample.frame_id, frame, sample.stamp)
            if moved is None:
                return None
            axes = axes_of(moved.orientation)
            sample = sample._replace(
                frame_id=frame,
                position=add(moved.position, to_world(axes, sample.position)),
                orientation=composed(moved.orientation, sample.orientation),
                pose_covariance=_carried(sample.pose_covariance, axes_of(conjugate(moved.orientation)), _AT_REST),
            )
        return sample

    def brought(self, message: Geometry | FeetStates | Terrain, frame: str) -> Any:
        """What is told about contacts, in another frame; None where no transforms lead there."""
        if not (frame and message.frame_id) or message.frame_id == frame:
            return message
        moved = self._motion(message.frame_id, frame, message.stamp)
        if moved is None:
            return None
        axes = axes_of(moved.orientation)
        if isinstance(message, Terrain):
            return message._replace(frame_id=frame, points=message.points @ axes + moved.position)
        told, rates = (message.points if isinstance(message, Geometry) else message.positions), message.velocities
        points = tuple([add(moved.position, to_world(axes, place)) for place in told])
        if len(rates) == len(told):
            inner = [Motion(place, linear=rate) for place, rate in zip(told, rates, strict=True)]
            rates = tuple([moved.of(one).linear for one in inner])
        if isinstance(message, Geometry):
            return Geometry(message.stamp, frame, points, rates)
        forces = tuple([to_world(axes, force) for force in message.forces])
        return FeetStates(message.stamp, frame, message.names, points, rates, forces)

    def _motion(self, frame: str, other: str, stamp: int) -> Motion | None:
        """A frame as seen from another; None, with the `flaw`, where no transforms tell it."""
        known = self._fixed.get((frame, other))
        if known is not None:
            return known
        up, down = self._ancestry(frame), self._ancestry(other)
        shared = next((one for one in up if one in down), None)
        loops = not self._branches.keys().isdisjoint((up[-1], down[-1]))
        if shared is None or loops:
            why = ", which lie in a loop" if loops else ""
            self.flaw = f"no transforms on /tf and /tf_static connect {frame!r} and {other!r}{why}"
            return None
        del up[up.index(shared) :], down[down.index(shared) :]
        lower, upper = self._along(up, stamp), self._along(down, stamp)
        if lower is None or upper is None:
            return None
        seen = upper.inverse().of(lower)
        if all(self._branches[one].is_fixed for one in up + down):
            self._fixed[frame, other] = seen
        return seen

    def _along(self, way: list[str], stamp: int) -> Motion | None:
        """The first frame of a way up as seen from the parent of the last."""
        seen = Motion()
        for frame in way:
            branch = self._branches[frame]
            found = branch.at(stamp)
            if found is None:
                first, last = [(pose.stamp - stamp) / NANOSECONDS for pose in (branch.poses[0], branch.poses[-1])]
                when = f"ended {-last:.3g} s before" if last < 0.0 else f"begins {first:.3g} s after"
                self.flaw = f"what /tf tells of {frame!r} in {branch.parent!r} {when} the stamp"
                return None
            seen = found.of(seen)
        return seen

    def _ancestry(self, frame: str) -> list[str]:
        """A frame, its parent, and so on to the root, or in a loop to the first that comes again."""
        way = [frame]
        while (branch := self._branches.get(way[-1])) is not None and branch.parent not in way:
            way.append(branch.parent)
        return way

    def _steps(self, frame: str, other: str) -> float:
        """How many transforms lead from one frame to another."""
        up, down = self._ancestry(frame), self._ancestry(other)
        return min([up.index(one) + down.index(one) for one in up if one in down], default=inf)


def _of_child(sample: Sample, moved: Motion, child: str) -> Sample:
    """A sample of another frame of the same body, which is `moved` as seen from that of the sample."""
    axes = axes_of(sample.orientation)
    own, arm = axes_of(moved.orientation), to_world(axes, moved.position)
    drift = add(add(sample.linear, cross(sample.angular, moved.position)), moved.linear)
    return sample._replace(
        child_frame_id=child,
        position=add(sample.position, arm),
        orientation=composed(sample.orientation, moved.orientation),
        linear=to_body(own, drift),
        angular=to_body(own, add(sample.angular, moved.angular)),
        pose_covariance=_carried(sample.pose_covariance, axes_of(_LEVEL), arm),
        twist_covariance=_carried(sample.twist_covariance, own, moved.position),
    )


def _carried(covariance: tuple[float, ...], rows: Axes, arm: Vector3) -> tuple[float, ...]:
    """The covariance of a motion at the end of an `arm`, along other axes, which are the `rows` of a matrix."""
    if not any(covariance):
        return covariance
    import numpy as np  # only where covariances are told

    turn, x, y, z = np.zeros((6, 6)), *arm
    turn[:3, :3] = turn[3:, 3:] = rows
    turn[:3, 3:] = rows @ np.array([(0.0, z, -y), (-z, 0.0, x), (y, -x, 0.0)])
    # Sources fill in what overflows where they know nothing: that stays as it is.
    with np.errstate(all="ignore"):
        carried = turn @ np.reshape(covariance, (6, 6)) @ turn.T
    return tuple(carried.ravel().tolist()) if np.isfinite(carried).all() else covariance
