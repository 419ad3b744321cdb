"""The motion of a support in waves some seconds ahead: harmonics fitted to its last seconds by linear prediction."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import partial
from math import exp

import numpy as np
from numpy.typing import NDArray

from ..types import Felt, Vector3
from ..vectors import add, combine, times, to_body
from .motion import SupportState, ahead, blend, turned_back

STEP = 100_000_000  # ns between two steps
SECONDS = STEP / 1e9

ORDER = 32  # values in the recursion, over 3.2 s: sixteen harmonics, with their damping
RIDGE = 1e-7
"""Of the variance, added to that of each value: the recursion is not fitted to what is smaller. Noise does the same, as
far as there is any."""

REFIT = 3  # steps between two fits
REACH = 100  # steps that are predicted; later the last one stands
PIECE = 200  # equations that are added at once
DIVERGED = 1e6  # times the largest value in the window, beyond which a prediction is not led on
REST = np.exp(-0.5 * np.arange(1, REACH + 1))[:, None]
"""What is left, at each of them, of that by which the last value missed the recursion: the next errors are like it, and
it does not jump where the prediction begins."""

LEAST = 20  # steps without which nothing is fitted
PAST = 10  # steps before the last one that a forecast tells of, too
FADE = 0.5  # s in which the difference of the estimate now from the fit fades
LIMIT = 1.5  # of the largest value in the window, beyond which nothing is predicted


class MotionForecast:
    """Cubic pieces through predicted rows, each the acceleration felt (m/s^2) and the angular velocity (rad/s).

    `tick` is the stamp, in steps, of row `past`, where the prediction begins. Slopes at the steps are those of the
    parabola of fourth order through two neighbours on each side. Before the first row and after the last they stand.
    """

    def __init__(self, tick: int, rows: NDArray[np.float64], past: int) -> None:
        self._begin = (tick - past) * STEP
        padded = np.concatenate([rows[:1], rows[:1], rows, rows[-1:], rows[-1:]])
        slopes = (8.0 * (padded[3:-1] - padded[1:-3]) - (padded[4:] - padded[:-4])) / 12.0
        first, second, m0, m1 = rows[:-1], rows[1:], slopes[:-1], slopes[1:]
        # a + b s + c s^2 + d s^3 for s = 0..1 from each row to the next
        pieces = np.stack([first, m0, 3.0 * (second - first) - 2.0 * m0 - m1, 2.0 * (first - second) + m0 + m1])
        areas = SECONDS * (pieces / np.arange(1.0, 5.0)[:, None, None]).sum(0)[:, 3:]
        self._areas = np.concatenate([np.zeros((1, 3)), np.cumsum(areas, axis=0)]).tolist()
        self._pieces = pieces.reshape(4, -1, 2, 3).swapaxes(0, 1).tolist()
        self._last = len(first) - 1

    def time_of(self, stamp: int) -> float:
        """The time in s of a stamp since the first row."""
        return (stamp - self._begin) / 1e9

    def at(self, time: float) -> tuple[Vector3, Vector3, Vector3, Vector3]:
        """Acceleration felt, angular velocity, its derivative and its integral since the first row."""
        x = min(max(time / SECONDS, 0.0), self._last + 1.0)
        i = min(int(x), self._last)
        s = x - i
        (fa, a), (fb, b), (fc, c), (fd, d) = self._pieces[i]
        return (
            add(fa, add(fb, add(fc, fd, s), s), s),
            add(a, add(b, add(c, d, s), s), s),
            times(combine(1.0, b, 2.0 * s, c, 3.0 * s * s, d), 1.0 / SECONDS),
            add(self._areas[i], add(combine(1.0, a, 0.5 * s, b, s * s / 3.0, c), d, 0.25 * s * s * s), SECONDS * s),
        )


class Harmonic:
    """Predicts what is felt on a support from its motion over the last `window` s.

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
        self._last: SupportState | None = None
        self._fit: MotionForecast | None = None
        self._due = 0

    @property
    def fitted(self) -> bool:
        return self._fit is not None

    def add(self, state: SupportState) -> None:
        before, self._last = self._last, state
        if before is None:
            return
        first = before.stamp // STEP + 1
        for tick in range(first, state.stamp // STEP + 1):
            part = (tick * STEP - before.stamp) / (state.stamp - before.stamp)
            felt = blend(before.felt, state.felt, part)
            self._rows.append((*felt, *blend(before.angular, state.angular, part)))
            self._due -= 1
            if self._due <= 0 and len(self._rows) >= self._enough:
                self._fit = MotionForecast(tick, predicted(np.array(self._rows)), PAST)
                self._due = REFIT

    def ahead(self, state: SupportState) -> Callable[[float], Felt]:
        """What is felt later, beginning with a state: constant accelerations while there is no fit."""
        fit = self._fit
        if fit is None:
            return partial(ahead, to_body(state.axes, state.felt), state.angular, state.turning)
        return partial(_ahead, fit, state, fit.time_of(state.stamp))


def _ahead(fit: MotionForecast, state: SupportState, start: float, time: float) -> Felt:
    """The fit from `start` on, plus what the state then was off it, fading."""
    force_then, angular_then, turning_then, rotation_then = fit.at(start)
    force, angular, turning, rotation = fit.at(start + time)
    force_off = add(state.felt, force_then, -1.0)
    angular_off, turning_off = add(state.angular, angular_then, -1.0), add(state.turning, turning_then, -1.0)
    f, df, area_f, h, dh, area_h = fading(time)
    rotation = combine(1.0, add(rotation, rotation_then, -1.0), area_f, angular_off, area_h, turning_off)
    return Felt(
        gravity=turned_back(to_body(state.axes, add(force, force_off, f)), rotation),
        angular=combine(1.0, angular, f, angular_off, h, turning_off),
        turning=combine(1.0, turning, df, angular_off, dh, turning_off),
    )


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


def predicted(rows: NDArray[np.float64]) -> NDArray[np.float64]:
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
    found = np.concatenate([rows, rest])
    limit = LIMIT * np.abs(rows).max(0)
    for i in range(count, count + REACH):
        found[i] += factors @ found[i - order : i]
        if i % 10 == 0 and not np.abs(found[i]).max() < DIVERGED:
            found[i:] = 0.0
            break
    ahead: NDArray[np.float64] = np.clip(found[count - PAST - 1 :], -limit, limit) * unit + mean
    return ahead
