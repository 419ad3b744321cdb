"""The motion of a support in waves some seconds ahead: harmonics fitted to its last seconds by linear prediction."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import partial
from math import exp

import numpy as np
from numpy.typing import NDArray

from ...mechanics.impact import new_tuple
from ..types import Felt, Vector3
from ..vectors import add, combine, to_body
from .course import STEP, Course
from .motion import Known, ahead, blend, turned_back

Array = NDArray[np.float64]

ORDER = 32
"""Values in the recursion, over 3.2 s: sixteen harmonics, with their damping."""

RIDGE = 1e-7
"""Of the variance, added to that of each value: the recursion is not fitted to what is smaller. Noise does the same, as
far as there is any."""

REFIT = 3
"""Steps between two fits."""

REACH = 100
"""Steps that are predicted; later the last one stands."""

PIECE = 200
"""Equations that are added at once."""

DIVERGED = 1e6
"""Times the largest value in the window, beyond which a course is not led on."""

REST = np.exp(-0.5 * np.arange(1, REACH + 1))[:, None]
"""What is left, at each of them, of that by which the last value missed the recursion: the next errors are like it, and
the course does not jump where the prediction begins."""

LEAST = 20
"""Steps without which nothing is fitted."""

PAST = 10
"""Steps before the last one that a course tells of, too."""

FADE = 0.5
"""s in which the difference of the estimate now from the fit fades."""

LIMIT = 1.5
"""Of the largest value in the window, beyond which nothing is predicted."""


class Harmonic:
    """Predicts what is felt on a support from its course over the last `window` s.

    The acceleration felt, in a frame that does not turn, and the angular velocity are sampled every 0.1 s. All six obey
    one recursion y(t) = a_1 y(t - h) + ... + a_32 y(t - 32 h), whose solutions are damped harmonics that they have in
    common. Its coefficients are the least-squares ones over the window, so that a few periods tell them: Prony's
    method as linear prediction (Makhoul, "Linear prediction: a tutorial review", Proc. IEEE 63, 1975, the covariance
    method). It begins with half a window.
    """

    def __init__(self, window: float) -> None:
        count = max(LEAST, round(window * 1e9 / STEP))
        self._enough = max(LEAST, count // 2)
        self._rows: deque[tuple[float, ...]] = deque(maxlen=count)
        self.clear()

    def clear(self) -> None:
        self._rows.clear()
        self._last: Known | None = None
        self._course: Course | None = None
        self._due = 0

    @property
    def fitted(self) -> bool:
        return self._course is not None

    def add(self, known: Known) -> None:
        """Take what is known at a message."""
        before, self._last = self._last, known
        if before is None:
            return
        first = before.stamp // STEP + 1
        for tick in range(first, known.stamp // STEP + 1):
            part = (tick * STEP - before.stamp) / (known.stamp - before.stamp)
            felt = blend(before.felt, known.felt, part)
            self._rows.append((*felt, *blend(before.angular, known.angular, part)))
            self._due -= 1
            if self._due <= 0 and len(self._rows) >= self._enough:
                self._course = Course(tick, predicted(np.array(self._rows)), PAST)
                self._due = REFIT

    def ahead(self, known: Known) -> Callable[[float], Felt]:
        """What is felt later, beginning with what is known: constant accelerations while there is no fit."""
        course, felt = self._course, to_body(known.axes, known.felt)
        if course is None:
            return partial(ahead, felt, known.angular, known.turning)
        start = course.time_of(known.stamp)
        force, angular, turning, rotation = course.at(start)
        return partial(
            _ahead,
            course,
            start,
            known,
            rotation,
            add(known.felt, force, -1.0),
            add(known.angular, angular, -1.0),
            add(known.turning, turning, -1.0),
        )


def _ahead(
    course: Course,
    start: float,
    known: Known,
    turned: Vector3,
    force_off: Vector3,
    angular_off: Vector3,
    turning_off: Vector3,
    time: float,
) -> Felt:
    """The course from `start` on, plus what the estimate there was off it, fading."""
    force, angular, turning, rotation = course.at(start + time)
    f, df, area_f, h, dh, area_h = fading(time)
    rotation = add(rotation, turned, -1.0)
    rotation = combine(1.0, rotation, area_f, angular_off, area_h, turning_off)
    gravity = turned_back(to_body(known.axes, add(force, force_off, f)), rotation)
    angular = combine(1.0, angular, f, angular_off, h, turning_off)
    turning = combine(1.0, turning, df, angular_off, dh, turning_off)
    return new_tuple(Felt, (gravity, angular, turning))


def fading(time: float) -> tuple[float, float, float, float, float, float]:
    """How an offset of a value fades, and how one of its derivative does, each with derivative and integral.

    With x = time / FADE they are (1 + x) exp(-x) and time exp(-x): they begin with 1 and slope 0, 0 and slope 1.
    Before now nothing has faded.
    """
    if time < 0.0:
        return 1.0, 0.0, time, time, 1.0, 0.5 * time * time
    x = time / FADE
    e = exp(-x)
    f = (1.0 + x) * e
    return f, -x / FADE * e, FADE * (2.0 - (2.0 + x) * e), time * e, (1.0 - x) * e, FADE * FADE * (1.0 - f)


def predicted(rows: Array) -> Array:
    """The rows (n, 6), the last PAST of them and REACH more, by the recursion that they obey best."""
    count = len(rows)
    mean = rows.mean(0)
    rows = rows - mean
    # One unit for what is felt and one for the rates: a quiet axis counts by what it has.
    unit = np.repeat([np.abs(rows[:, :3]).max(), np.abs(rows[:, 3:]).max()], 3)
    unit[unit == 0.0] = 1.0
    rows /= unit
    order = min(ORDER, count // 4)
    # In pieces of one signal: products of their size are left to one thread, and a second one costs more than it does.
    square, right = np.zeros((order, order)), np.zeros(order)
    lags = np.lib.stride_tricks.sliding_window_view(rows[:-1], order, axis=0).swapaxes(0, 1).copy()
    for begin in range(0, count - order, PIECE):
        part = slice(begin, begin + PIECE)
        for before, after in zip(lags[:, part], rows[order:][part].T, strict=True):
            square += before.T @ before
            right += before.T @ after
    ridge = RIDGE * np.trace(square) / order + 1e-300
    factors = np.linalg.solve(square + ridge * np.eye(order), right)
    rest = REST * (rows[-1] - factors @ rows[-1 - order : -1])
    course = np.concatenate([rows, rest])
    limit = LIMIT * np.abs(rows).max(0)
    for i in range(count, count + REACH):
        course[i] += factors @ course[i - order : i]
        if i % 10 == 0 and not np.abs(course[i]).max() < DIVERGED:
            course[i:] = 0.0
            break
    ahead: Array = np.clip(course[count - PAST - 1 :], -limit, limit) * unit + mean
    return ahead
