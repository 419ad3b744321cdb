"""The motion of a support in waves some seconds ahead, and how unsure that is: an autoregression that learns the sea.

What is measured of the deck, in means over quarters of a second, goes on as a linear function of its last eight seconds
(vector autoregression; Luetkepohl, "New Introduction to Multiple Time Series Analysis", 2005, chapter 3). Its
coefficients are the least-squares ones over the last twenty minutes, in which the past fades, so that they follow a sea
that changes. Channels that lead others, like heave before roll, tell of them: a recursion that all share (Prony) errs
twice as much. How unsure a forecast is its own past errors show, whole courses of them, which need no model.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from enum import Enum
from functools import cache
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...stamps import NANOSECONDS
from ..types import Moment, Vector3
from ..vectors import dot, to_body
from .motion import NOWHERE, MeanMotion, SupportState

STEP = 250_000_000  # ns between two rows
SECONDS = STEP / NANOSECONDS
ORDER = 32  # rows that tell the next one: 8 s
HALVES: Final = 2, 8  # rows on each side of a cubic, at least and at most
REACH = 61 + HALVES[1]  # rows ahead, with those that cubics need beside them: 15 s
MEMORY = 4800  # rows after which the past counts 1/e: twenty minutes
REFIT = 40  # rows between two fits
RIDGE = 5.0
"""Rows of each channel's variance, added where the row ahead is not told at all, and as much less as less of it is not:
few noisy rows would be fitted by their noise."""

ROUNDING = 1e-6  # of each channel's variance, added to it in any case

LEAST = 1e-4
"""Standard deviation (SI units) below which a channel is at rest."""

FURTHEST = 6.0  # standard deviations from a channel's mean beyond which nothing is forecast

WORTH = 0.1  # skill below which a forecast tells no more than its mean, to which it shrinks then

TRUSTED_BEFORE = 4.0  # forecasts as large as the motion that count as right, before any are compared with what came

SPACED = 8  # rows between two courses of errors that are kept: nearer ones are alike
COURSES = 48
SINGLE = 51  # times at which a motion that is not learnt is looked at
ENOUGH = 12  # courses from which a forecast is trusted


LEADS: Final = (1.0, 2.0, 5.0, 10.0, 15.0)
"""s ahead at which forecasts are told, and compared with what came."""

ANGLES: Final = ("roll", "pitch")

_ROWS: Final = [round(lead / SECONDS) for lead in LEADS]
_DECIDES: Final = 1  # the lead at which a forecast must have that skill


class ForecastStatus(Enum):
    """Whether a forecast is trusted, or why not, in words."""

    LEARNING = "the sea is not learnt yet: it takes one to two minutes"
    INTERRUPTED = "eight seconds of messages are needed after a jump or a gap"
    NO_SKILL = "no better than the motion of now or the mean: it moves too little or without a period, or has changed"
    TRUSTED = "trusted"


class ForecastSkill(NamedTuple):
    """How wrong forecasts of late were `LEADS` ahead, as root mean squares of the felt gravity in m/s^2 or of an angle
    in rad, beside those who expect that it stays (`persistence`), and its `mean`.
    """

    forecast: tuple[float, ...]
    persistence: tuple[float, ...]
    mean: tuple[float, ...]

    @property
    def skill(self) -> list[float]:
        """The part of the mean square error that the better simple answer makes and the forecast does not."""
        pairs = zip(self.forecast, map(min, self.persistence, self.mean), strict=True)
        return [1.0 - (told / simple) ** 2 if simple > 0.0 else 0.0 for told, simple in pairs]


class DeckOutlook(NamedTuple):
    """Equally likely courses of what is felt on a support at `times` (t,) in s from now.

    `gravity` felt at its origin (m/s^2), `angular` velocity (rad/s) and `turning`, its derivative, along the axes of
    then, each (courses, t, 3); `angles`, its roll with port up and its pitch with the bow down in rad (courses, t, 2),
    and `is_learnt`, where the courses show how unsure they are.
    """

    times: NDArray[np.float64]
    gravity: NDArray[np.float64]
    angular: NDArray[np.float64]
    turning: NDArray[np.float64]
    is_learnt: bool
    angles: NDArray[np.float64] | None = None

    def until(self, horizon: float) -> DeckOutlook:
        """What is told up to a horizon in s, and the first moment in any case."""
        count = max(1, int(np.searchsorted(self.times, horizon, side="right")))
        gravity, angular, turning = (each[:, :count] for each in (self.gravity, self.angular, self.turning))
        return self._replace(times=self.times[:count], gravity=gravity, angular=angular, turning=turning, angles=None)

    def at(self, leads: Sequence[float]) -> DeckOutlook:
        """What is told so many s ahead."""
        after = np.searchsorted(self.times, leads).clip(1, len(self.times) - 1)
        before, whole = self.times[after - 1], self.times[after] - self.times[after - 1]
        part = ((np.asarray(leads) - before) / whole)[:, None]

        def there(of: NDArray[np.float64]) -> NDArray[np.float64]:
            found: NDArray[np.float64] = (1.0 - part) * of[:, after - 1] + part * of[:, after]
            return found

        return DeckOutlook(
            times=np.asarray(leads),
            gravity=there(self.gravity),
            angular=there(self.angular),
            turning=there(self.turning),
            is_learnt=self.is_learnt,
            angles=None if self.angles is None else there(self.angles),
        )


def single(moment: Moment, mean: MeanMotion | None, horizon: float) -> DeckOutlook:
    """One course, from what is felt at a moment on: what `ahead` says, going over to a `mean` and to no rotation as
    exp(-(t / quarter)^2).
    """
    times = np.linspace(0.0, horizon, SINGLE)
    felt = np.array([moment.ahead(time) for time in times.tolist()]).reshape(len(times), 3, 3)
    if mean is not None:
        rest = np.array((mean.gravity, NOWHERE, NOWHERE))
        felt = rest + np.exp(-np.square(times / mean.quarter))[:, None, None] * (felt - rest)
    gravity, angular, turning = felt.swapaxes(0, 1)[:, None]
    return DeckOutlook(times=times, gravity=gravity, angular=angular, turning=turning, is_learnt=False)


def angles_of(gravity: Sequence[Any] | NDArray[np.float64]) -> tuple[Any, Any]:
    """Roll, with port up, and pitch, with the bow down, in rad, from the parts of gravity along a deck's axes."""
    x, y, z = gravity
    return np.arctan2(-y, -z), np.arctan2(x, np.hypot(y, z))


class WaveForecast:
    """Learns from one state of a support after another how its motion goes on, and how wrong that was.

    `gravity` is in the world frame (m/s^2). The channels are its first two parts along the support's axes, and the
    support's angular and linear velocity along these; or, where `is_felt`, what is felt there and the angular velocity.
    Accelerations come from velocities that are forecast: those of measured ones are noisy.
    """

    def __init__(self, gravity: Vector3, is_felt: bool) -> None:
        self._gravity, self._is_felt = gravity, is_felt
        self._width = width = 6 if is_felt else 8
        self._square, self._right = np.zeros((width * ORDER + 1,) * 2), np.zeros((width * ORDER + 1, width))
        # Rows count from the first one: the squares of a large constant would hide those of what changes.
        self._origin: NDArray[np.float64] | None = None
        self._factors: NDArray[np.float64] | None = None
        self._mean, self._variance, self._reach = np.zeros((3, width))
        # Of forecasts and what came, about the mean: their products and the squares of the former, fading.
        self._products, self._told = np.zeros((2, REACH, width))
        self._courses: deque[NDArray[np.float64]] = deque(maxlen=COURSES)
        self._squares: deque[NDArray[np.float64]] = deque(maxlen=COURSES)
        self._half = HALVES[0]
        self.skills: dict[str, ForecastSkill] = {}
        """What became of the forecasts of the last minutes, of what is `felt`, `roll` and `pitch`; none until there are
        enough.
        """
        self.clear()

    def clear(self) -> None:
        """Begin a new record of the same sea: what was learnt of it stays."""
        self._last: tuple[int, NDArray[np.float64]] | None = None
        self._part = np.zeros(self._width)
        self._rows = self._near = np.zeros((0, self._width))
        self._made: deque[tuple[int, NDArray[np.float64]]] = deque()
        self._tick = self._new = 0

    @property
    def status(self) -> ForecastStatus:
        """Whether it has seen enough to forecast, and its forecasts were better than simple answers."""
        if self._factors is None or not self.skills:
            return ForecastStatus.LEARNING
        if len(self._rows) < ORDER:
            return ForecastStatus.INTERRUPTED
        felt = self.skills["felt"]
        is_idle = felt.skill[_DECIDES] < WORTH and felt.forecast[_DECIDES] > LEAST
        return ForecastStatus.NO_SKILL if is_idle else ForecastStatus.TRUSTED

    def add(self, state: SupportState, window: float = 0.0) -> None:
        """Take the next state, and the window in s in which its acceleration is found with the least error."""
        self._half = min(max(HALVES[0], round(window / SECONDS)), HALVES[1])
        self._axes = state.axes
        last, now = self._last, self._channels(state)
        self._last = state.stamp, now
        if last is None:
            return
        begin, value = last
        slope = (now - value) / (state.stamp - begin)
        while begin // STEP < state.stamp // STEP:
            end = (begin // STEP + 1) * STEP
            there = value + (end - begin) * slope
            row = self._part + (0.5 * (end - begin) / STEP) * (value + there)
            # The first one is of a part of its time.
            if self._tick:
                self._take(row)
            self._tick, begin, value = end // STEP, end, there
            self._part = np.zeros(self._width)
        self._part += (0.5 * (state.stamp - begin) / STEP) * (value + now)

    def outlook(self, stamp: int) -> DeckOutlook:
        """The courses from a stamp in ns, not before that of the last state."""
        errors = np.array(self._courses)
        rows = np.concatenate([self._rows[-self._half :], self._likely(self._forecast())]) + self._origin
        # An error may as well have been the other way: so a few courses go further.
        errors = np.concatenate([np.zeros((len(errors), self._half, self._width)), errors], axis=1)
        felt = self._felt(np.concatenate([rows + errors, rows - errors]))
        begin = (self._tick * STEP - stamp) / NANOSECONDS
        times = np.array([begin + SECONDS * k for k in range(REACH + 1 - self._half)])
        # The slope at the end of the last row has the noise of its measurement.
        first = int(np.searchsorted(times, 0.0, side="right"))
        gravity, angular, turning, angles = felt
        if self._is_felt:
            # Of what is felt the angles are not told: they go on from those of now.
            part = 1.0 - times[first] / SECONDS
            angles = angles - ((1.0 - part) * angles[:, first - 1 : first] + part * angles[:, first : first + 1])
            angles += angles_of(to_body(self._axes, self._gravity))
        gravity, angular, turning, angles = (each[:, first:] for each in (gravity, angular, turning, angles))
        return DeckOutlook(times[first:], gravity, angular, turning, is_learnt=True, angles=angles)

    def _channels(self, state: SupportState) -> NDArray[np.float64]:
        axes = state.axes
        if self._is_felt:
            return np.array((*to_body(axes, state.felt), *state.angular))
        return np.array((*to_body(axes, self._gravity)[:2], *state.angular, *to_body(axes, state.velocity)))

    def _felt(self, rows: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Gravity felt, angular velocity and its derivative, each (n, t + 1 - 2 half, 3), and roll and pitch
        (n, .., 2), in courses of rows (n, t, width): at the ends of the rows that have `half` of them on each side.
        Where gravity itself is no channel the angles begin with those at which it turns.

        A mean over a step hides what waves do within it: cubics with the means of the rows are the motion and its
        slope. Where rows are noisy they are longer ones of least squares, as what a slope makes of noise would use up
        margins.
        """
        half = self._half
        count = rows.shape[1] + 1 - 2 * half
        there = slopes = np.zeros(1)
        for k, (value, slope) in enumerate(_cubic(half)):
            left, right = (rows[:, at : at + count] for at in (half - 1 - k, half + k))
            there, slopes = there + value * (right + left), slopes + slope * (right - left)
        start = 3 if self._is_felt else 2
        angular, turning = (part[:, :, start : start + 3] for part in (there, slopes))
        if self._is_felt:
            return there[:, :, :3], angular, turning, SECONDS * np.cumsum(angular[:, :, :2], axis=1)
        linear, gravity = there[:, :, 5:], self._gravity
        down = np.maximum(dot(gravity, gravity) - np.square(there[:, :, :2]).sum(2, keepdims=True), 0.0)
        felt = np.concatenate([there[:, :, :2], -np.sqrt(down)], axis=2)
        angles = np.stack(angles_of(np.moveaxis(felt, 2, 0)), axis=2)
        return felt - slopes[:, :, 5:] - np.cross(angular, linear), angular, turning, angles

    def _forecast(self) -> NDArray[np.float64]:
        """The rows (REACH, width) after the last one."""
        rows = np.empty((REACH + ORDER, self._width))
        # The last row first, as the factors have it: each new one goes before the others.
        rows[REACH:] = self._rows[: -ORDER - 1 : -1]
        for i in range(REACH - 1, -1, -1):
            rows[i] = self._next(rows[i + 1 : i + 1 + ORDER])
        return rows[:REACH][::-1]

    def _next(self, before: NDArray[np.float64]) -> NDArray[np.float64]:
        """The row after others (ORDER, width), of which the last one comes first."""
        assert self._factors is not None
        row: NDArray[np.float64] = before.ravel() @ self._factors[:-1] + self._factors[-1]
        return np.minimum(np.maximum(row, self._mean - self._reach), self._mean + self._reach)

    def _likely(self, told: NDArray[np.float64]) -> NDArray[np.float64]:
        """The rows to expect where such are forecast: what came of those before, regressed on them.

        Coefficients that few or noisy rows tell make forecasts larger than what they know of the future. With errors
        about them, which are larger for it too, courses would swing too far.
        """
        trusted = TRUSTED_BEFORE * self._variance + LEAST * LEAST
        part = np.clip((self._products + trusted) / (self._told + trusted), 0.0, 1.0)
        return self._mean + part * (told - self._mean)

    def _take(self, row: NDArray[np.float64]) -> None:
        """Take the mean of a step."""
        if self._origin is None:
            self._origin = row
        row = row - self._origin
        # What is told right before it came has the noise of its measurement no more, and belongs to no course.
        near = row if self._factors is None or len(self._rows) < ORDER else self._next(self._rows[: -ORDER - 1 : -1])
        self._near = np.concatenate([self._near[1 - REACH :], near[None]])
        self._rows = np.concatenate([self._rows[-(ORDER + REACH) :], row[None]])
        self._new += 1
        if self._made and self._made[0][0] + REACH == self._tick:
            _, told = self._made.popleft()
            likely = self._likely(told)
            self._courses.append(self._near - likely)
            self._compare(likely)
            fade, told = np.exp(-SPACED / MEMORY), told - self._mean
            self._products = fade * self._products + told * (self._near - self._mean)
            self._told = fade * self._told + told * told
        if len(self._rows) <= ORDER:
            self._new = 0
        elif self._new == REFIT:
            self._fit()
        # Forecasts of fewer rows than there are unknowns tell nothing of later ones.
        enough = self._square[-1, -1] >= len(self._square)
        if enough and self._factors is not None and self._tick % SPACED == 0 and len(self._rows) >= ORDER:
            self._made.append((self._tick, self._forecast()))

    def _compare(self, told: NDArray[np.float64]) -> None:
        """Learn what a forecast was worth, now that what it told has come."""
        assert self._origin is not None
        begin, came = np.split(self._rows[-REACH - self._half :], [self._half])
        found = [self._felt(np.concatenate([begin, rows])[None] + self._origin) for rows in (came, told)]
        came, told = (np.concatenate([gravity[0], angles[0]], axis=1) for gravity, _, _, angles in found)
        there = came[_ROWS]
        squares = np.square([told[_ROWS] - there, came[0] - there, came.mean(axis=0) - there])
        self._squares.append(np.stack([squares[:, :, :3].sum(axis=2), squares[:, :, 3], squares[:, :, 4]]))
        if len(self._squares) >= ENOUGH:
            errors = np.sqrt(np.mean(self._squares, axis=0)).tolist()
            self.skills = {name: ForecastSkill(*of) for name, of in zip(("felt", *ANGLES), errors, strict=True)}

    def _fit(self) -> None:
        """Learn the rows since the last fit."""
        new, self._new = self._rows[-ORDER - self._new :], 0
        count, width = len(new) - ORDER, self._width
        told = np.ones((count, width * ORDER + 1))
        lags = np.lib.stride_tricks.sliding_window_view(new[:-1], ORDER, axis=0)
        told[:, :-1] = lags[:, :, ::-1].swapaxes(1, 2).reshape(count, -1)
        fades = np.exp(-count / MEMORY)
        missed = new[ORDER:] - (0.0 if self._factors is None else told @ self._factors)
        self._square = fades * self._square + told.T @ told
        self._right = fades * self._right + told.T @ new[ORDER:]
        weight = self._square[-1, -1]
        means = self._square[-1, :-1] / weight
        variances = np.maximum(np.diagonal(self._square)[:-1] / weight - np.square(means), LEAST * LEAST)
        untold = min(1.0, float((np.square(missed).mean(axis=0) / variances[:width]).mean()))
        ridge = (RIDGE * untold + ROUNDING * weight) * variances
        self._mean, self._variance = means[:width], variances[:width]
        self._reach = FURTHEST * np.sqrt(variances[:width])
        try:
            factors = np.linalg.solve(self._square + np.diag(np.append(ridge, 0.0)), self._right)
        except np.linalg.LinAlgError:  # numbers so large that rounding is more than the ridge
            factors = np.full(self._right.shape, np.nan)
        self._factors = np.asarray(factors) if np.isfinite(factors).all() else None


@cache
def _cubic(half: int) -> list[tuple[float, float]]:
    """What rows count in the value and the slope of their cubic between the middle ones: those on the right, from there
    on; those on the left count as much, in the slope against it.
    """
    ends = np.arange(-half, half + 1.0)[:, None] ** np.arange(1, 5)
    fit = np.linalg.pinv(np.diff(ends, axis=0) / np.arange(1, 5))[:2, half:]
    return [(value, slope / SECONDS) for value, slope in fit.T.tolist()]
