"""The tracker of a moving support: messages of its motion in, what is felt on it at the stamp of a body out."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from functools import partial
from math import sqrt
from typing import TYPE_CHECKING

from ...stamps import NANOSECONDS
from ..checks import LARGEST, PAUSE, check_orientation, order_of
from ..scene import MovingDeck
from ..types import Felt, Imu, Moment, Sample, Status, Vector3
from ..vectors import add, axes_of, dot, rotation_between, times, to_body, to_world
from .motion import NOWHERE, MeanMotion, SupportState, ahead, between, later, resting
from .window import END, SLOPE, TURNING, MotionWindow

if TYPE_CHECKING:
    from .forecast import DeckOutlook, ForecastStatus, WaveForecast
    from .imu import DeckImu

BOUNDS = (
    (0.05, 0.5, 3.75, 2),  # position
    (0.01, 0.1, 1.25, 2),  # orientation
    (0.1, 1.0, 30.0, 1),  # velocity
    (0.05, 0.5, 10.0, 1),  # angular velocity
)
"""How far each quantity may be from where the message before leads it, in its unit: the least and the most that is
allowed to noise, which is learnt; and what a slam of 30 m/s^2 or 10 rad/s^2 makes of it in 1 s, with the power of the
time between two messages that this grows with."""

FACTOR = 6.0
"""Allowed to noise, in root mean squares of the steps; for three normal parts these are ten standard deviations."""

MEMORY = 1.0 / 32.0  # of the mean square, the part of the newest step

ASTRAY = 0.006
"""m/s by which the support may go on otherwise than it was led on from message to message: bodies that are sampled in
between seem to approach it so fast."""

GROWS = 2.5  # the power of the time between two messages with which that speed grows
SEEN = 20.0  # s over which its mean square is taken


class Deck:
    """Tracks one moving support from its odometry, or from an inertial sensor on it.

    `update` or `update_imu` takes each message, in the order of their stamps; `at` tells of the support at the stamp
    of a body. `gravity` is in the world frame (m/s^2), `normal` the unit normal of the support in its own.

    Accelerations are known as soon as three messages span the scene's `window`. A sensor is trusted one second after
    its first message; as it is all there is then, the support's place and velocity stay unknown: `Moment.frame_id` is
    "", and the orientation is the sensor's or, if it gives none, has the heading of the start.
    """

    def __init__(self, deck: MovingDeck, gravity: Vector3, normal: Vector3) -> None:
        self.deck = deck
        self._gravity, self._normal = gravity, normal
        self._timeout = round(deck.timeout * NANOSECONDS)
        self._linear = MotionWindow(deck.window, SLOPE if deck.source == "odom" else END)
        self._angular = MotionWindow(deck.window, TURNING)
        self._jumps = JumpDetector()
        self._imu: DeckImu | None = None
        if deck.source == "imu":
            from .imu import DeckImu

            self._imu = DeckImu(deck.imu_position, gravity, normal)
        self._waves: WaveForecast | None = None
        self._ahead: DeckOutlook | None = None
        self.frames = ("", "")
        """The frame in which the support's motion is told, and that of the support itself."""
        self._seen: SupportState | None = None
        self._history: deque[SupportState] = deque()
        self._latest: Moment | None = None
        self._state = self._before = Status.NO_SUPPORT
        self._still = times(normal, -sqrt(dot(gravity, gravity)))
        self._mean = MeanMotion(self._still)
        self._asked: int | None = None
        self._heard: int | None = None
        self._leads = False  # whether a body asks for more than half a step after the last message
        self._step = self._astray = 0.0
        self._missed = NOWHERE

    def update(self, sample: Sample) -> Status:
        """Take a message of the support's pose and twist, where the scene says so. A refused one tells nothing."""
        if self._imu is not None:
            return Status.MALFORMED
        position, linear, angular = sample.position, sample.linear, sample.angular
        # False for NaN as well.
        if not dot(position, position) + dot(linear, linear) + dot(angular, angular) < LARGEST:
            return Status.NOT_FINITE
        frames = sample.frame_id, sample.child_frame_id
        status = check_orientation(sample.orientation) or self._in_order(sample.stamp, frames)
        if status:
            return status
        axes = axes_of(sample.orientation)
        seen = SupportState(
            stamp=sample.stamp,
            orientation=sample.orientation,
            axes=axes,
            angular=angular,
            position=position,
            velocity=to_world(axes, linear),
        )
        if not self._spans(seen, seen.velocity):
            return self._refused()
        seen.acceleration, seen.turning = self._linear.slopes(), self._angular.slopes()
        seen.felt = add(self._gravity, seen.acceleration, -1.0)
        upright = dot(to_world(axes, self._normal), self._gravity) < 0.0
        return self._know(seen, Status.ACCEPTED if upright else Status.GRAVITY_WRONG)

    def update_imu(self, imu: Imu) -> Status:
        """Take a message of an inertial sensor on it, where the scene says so. A refused one tells nothing."""
        sensor = self._imu
        if sensor is None:
            return Status.MALFORMED
        if not dot(imu.specific_force, imu.specific_force) + dot(imu.angular, imu.angular) < LARGEST:
            return Status.NOT_FINITE
        status = Status.ACCEPTED if imu.orientation is None else check_orientation(imu.orientation)
        status = status or self._in_order(imu.stamp, ("", imu.frame_id))
        if status:
            return status
        if self._seen is None:
            sensor.clear()
        if sensor.oriented_anew(imu):
            self._forget(Status.NO_SUPPORT)
        seen = sensor.seen(imu, self._seen)
        verdict = sensor.judge(imu)
        # In a frame that does not turn what is felt changes with the support's acceleration alone.
        if not self._spans(seen, to_world(seen.axes, sensor.felt(imu))):
            return self._refused()
        seen.turning = self._angular.slopes()
        seen.felt = add(self._linear.ends(), to_world(seen.axes, sensor.euler(seen.turning)))
        return self._know(seen, verdict)

    @property
    def last(self) -> Moment | None:
        """The support at its last message; None while its motion is not known."""
        if self._latest is None and not self._state:
            self._latest = self._moment(self._history[-1])
        return self._latest

    def at(self, stamp: int) -> Moment | Status:
        """The support at the stamp of a body (ns), or why its motion is not known then.

        After the last message it goes on with constant accelerations; before, the messages on both sides tell.
        """
        seen = self._seen
        if seen is None:
            return self._state
        if self._asked is None or stamp > self._asked:
            self._asked = stamp
        gap = stamp - seen.stamp
        if gap > self._timeout:
            return Status.CLOCKS_APART if self._keeps_coming(stamp, seen.stamp) else Status.SUPPORT_STALE
        if -gap > self._timeout:
            return Status.CLOCKS_APART
        if self._state:
            return self._state
        if gap == 0:
            return self.last or self._state
        second = self._history[-1]
        if gap > 0:
            self._leads = self._leads or 2 * gap > NANOSECONDS * self._step > 0.0
            return self._moment(later(second, stamp))
        for first in reversed(self._history):
            if first.stamp <= stamp:
                return self._moment(between(first, second, stamp))
            second = first
        return self._before

    @property
    def errors(self) -> tuple[float, float]:
        """What the felt gravity (m/s^2) and the angular acceleration (rad/s^2) err by, as root mean squares of an axis;
        0 while their noise is not known.
        """
        linear, angular = self._linear, self._angular
        first, second = (each.balance.error(each.span) if each.balance.is_known else 0.0 for each in (linear, angular))
        return first, second

    @property
    def window(self) -> float:
        """The window in s over which linear accelerations are found now."""
        return self._linear.span

    def doubts(self) -> tuple[str, ...]:
        """What speaks against the window that is given, a sentence each."""
        given = self.deck.window
        found = [window.balance.doubt(given) for window in (self._linear, self._angular)] if given else []
        return tuple([one for one in (*found, self._coarse()) if one][:1])

    def learn(self) -> None:
        """Learn from now on how the support goes on in waves, for `outlook`."""
        from .forecast import WaveForecast

        if self._waves is None:
            self._waves = WaveForecast(self._gravity, is_felt=self._imu is not None)

    def outlook(self, horizon: float) -> DeckOutlook:
        """Courses of what will be felt after the last message: of a sea that is learnt as far as they go.

        Until the sea is learnt there is one over a horizon in s: constant accelerations fade to the mean of the last
        minute within a quarter of a wave, because nothing is known from them later. While nothing is known of the
        support (`last` is None) it counts as level and at rest.
        """
        from .forecast import ForecastStatus, single

        last = self.last
        if last is not None and self.forecast is ForecastStatus.TRUSTED and self._waves is not None:
            self._ahead = self._waves.outlook(last.stamp)
        else:
            self._ahead = single(last or resting(self._still), self._mean, horizon)
        return self._ahead

    @property
    def forecast(self) -> ForecastStatus | None:
        """Whether the forecast of the sea is trusted, or why not; None where it is not asked for."""
        return None if self._waves is None else self._waves.status

    def values(self) -> dict[str, str]:
        """What a report tells of the support: windows in s, the skill and errors (m/s^2, rad) of the forecast, and roll
        and pitch (rad) as they were forecast last, the mean and the deviation of its courses.
        """
        found = {"window.linear": f"{self._linear.span:.3f}", "window.angular": f"{self._angular.span:.3f}"}
        if self._waves is None:
            return found
        found["forecast"] = self._waves.status.name
        from .forecast import ANGLES, LEADS

        told: dict[str, Sequence[float]] = {}
        for name, skill in self._waves.skills.items():
            of = "" if name == "felt" else f".{name}"
            told |= {f"skill{of}": skill.skill}
            told |= {f"error{of}.{answer}": errors for answer, errors in skill._asdict().items()}
        ahead = self._ahead
        if ahead is not None and (angles := ahead.at(LEADS).angles) is not None:
            for name, means, deviations in zip(ANGLES, angles.mean(axis=0).T, angles.std(axis=0).T, strict=True):
                told |= {name: means, f"{name}.deviation": deviations}
        for name, numbers in told.items():
            found |= {f"{name}.{lead:g}_s": f"{one:.4f}" for lead, one in zip(LEADS, numbers, strict=True)}
        return found

    def _coarse(self) -> str:
        """What is wrong with messages that come so seldom, "" where nothing is."""
        if not self._leads or self._astray < ASTRAY * ASTRAY:
            return ""
        speed = sqrt(self._astray)
        return (
            f"the support's messages come every {self._step:.2g} s, and from one to the next it goes on by {speed:.2g} "
            "m/s otherwise than it was led on: bodies that are sampled in between show touchdowns that are none; send "
            f"{(speed / ASTRAY) ** (1.0 / GROWS) / self._step:.0f} a second or more"
        )

    def _in_order(self, stamp: int, frames: tuple[str, str]) -> Status:
        last = None if self._seen is None else self._seen.stamp
        status = order_of(stamp, last)
        if last is not None:
            if stamp - last > self._timeout:
                self._forget(Status.SUPPORT_STALE)
            elif frames != self.frames:
                return Status.WRONG_FRAME
            elif last - stamp > PAUSE:
                self._forget(Status.NO_SUPPORT)
                self._asked = None
        if status is Status.ACCEPTED:
            self.frames = frames
            self._heard = self._asked
        return status

    def _forget(self, state: Status) -> None:
        """Begin anew; until accelerations are known again `state` says why they are not."""
        self._state = state
        self._seen = self._latest = self._ahead = None
        self._missed = NOWHERE
        self._linear.clear()
        self._angular.clear()
        self._history.clear()
        if self._waves is not None:
            self._waves.clear()

    def _spans(self, seen: SupportState, signal: Vector3) -> bool:
        """Take what was seen; whether the window is full, so that accelerations are known."""
        if self._seen is not None and not self._jumps.follows(self._seen, seen):
            self._forget(Status.SUPPORT_JUMPED)
        self._seen = seen
        spans = self._linear.add(seen.stamp, signal)
        return self._angular.add(seen.stamp, seen.angular) and spans

    def _refused(self) -> Status:
        """What becomes of a message that does not fill the window yet: after a jump it is not trusted."""
        return Status.SUPPORT_JUMPED if self._state is Status.SUPPORT_JUMPED else Status.ACCEPTED

    def _know(self, known: SupportState, state: Status) -> Status:
        history = self._history
        if not history:
            self._before = self._state or Status.NO_SUPPORT
        else:
            last = history[-1]
            step = (known.stamp - last.stamp) / NANOSECONDS
            self._mean.add(known, step)
            missed = add(add(known.velocity, last.velocity, -1.0), last.acceleration, -step)
            # Of noise one error says nothing of the next.
            self._astray += min(step / SEEN, 1.0) * (dot(missed, self._missed) - self._astray)
            self._step, self._missed = step, missed
        self._state = state
        self._latest = None
        history.append(known)
        oldest = known.stamp - self._timeout
        while history[0].stamp < oldest:
            history.popleft()
        if self._waves is not None:
            self._waves.add(known, self.window)
        return Status.ACCEPTED if state is Status.NO_SUPPORT else state

    def _keeps_coming(self, stamp: int, last: int) -> bool:
        """Whether messages, though older than a body's stamp by more than the timeout, came while bodies were heard.

        When the last one came the latest stamp of a body was `_heard`: far ahead of it already, and not long ago.
        """
        heard = self._heard
        return heard is not None and stamp - heard <= self._timeout and heard - last > self._timeout // 2

    def _moment(self, known: SupportState) -> Moment:
        felt, linear = to_body(known.axes, known.felt), to_body(known.axes, known.velocity)
        frame, child = self.frames
        # By place, which takes half the time: each sample of a body asks for one.
        return Moment(
            known.stamp,
            frame,
            child,
            known.position,
            known.orientation,
            linear,
            Felt(felt, known.angular, known.turning),
            partial(ahead, felt, known.angular, known.turning),
            self._gravity,
        )


class JumpDetector:
    """Tells messages that follow from those before from jumps.

    Pose after pose is led on by the mean of both twists; a twist is expected to stay. What noise and the support's
    motion make of that is learnt from every step, so that a rough source is trusted too, up to the `most` of each
    quantity, which the first step may have.
    """

    def __init__(self) -> None:
        self._squares = [(most / FACTOR) ** 2 for _, most, _, _ in BOUNDS]
        self._steps = 0

    def follows(self, before: SupportState, now: SupportState) -> bool:
        """Whether a message follows from the one before; it is learnt from in any case."""
        time = (now.stamp - before.stamp) / NANOSECONDS
        half = 0.5 * time
        moved = add(add(now.position, before.position, -1.0), add(now.velocity, before.velocity), -half)
        rotated = rotation_between(before.orientation, now.orientation)
        turned = add(rotated, add(now.angular, before.angular), -half)
        accelerated, spun = add(now.velocity, before.velocity, -1.0), add(now.angular, before.angular, -1.0)
        squares, follows = self._squares, True
        self._steps += 1
        part = max(MEMORY, 1.0 / self._steps)
        errors = moved, turned, accelerated, spun
        for i, ((least, most, slam, power), error) in enumerate(zip(BOUNDS, errors, strict=True)):
            square = dot(error, error)
            noise = min(max(FACTOR * squares[i] ** 0.5, least), most)
            if square > (noise + slam * time**power) ** 2:
                follows = False
            squares[i] += part * (min(square, most * most) - squares[i])
        return follows
