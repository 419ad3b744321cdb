"""What changes from message to message: its derivative by the window of samples that errs least."""

from __future__ import annotations

from collections import deque
from math import sqrt
from typing import Final, NamedTuple

from ...stamps import NANOSECONDS
from ..scatter import DifferenceNoise
from ..types import Vector3
from ..vectors import add, dot, lines, times

LONGEST: Final = 2.0  # s: a window without end where nothing moves would hide what begins to
APART: Final = 0.25  # s at least between two values whose difference tells how fast they change
AVERAGED: Final = 60.0  # s over which the motion is averaged, about ten waves
KNOWN: Final = 16  # third differences that tell the noise well enough to begin with
SURELY: Final = 0.1  # of the mean square that noise makes, what cannot be told from none
TINY: Final = 1e-12
FIRST: Final = 5.0  # s for which the change counts that is taken for granted
AVERAGED_STEPS: Final = 50  # messages over which their rate is averaged
FAR: Final = 2.0  # times the least error, from which on a window is told to be wrong

FLAT: Final = 1e-6
"""Of the determinant of evenly spread samples: with less their stamps lie in two clumps, which tell no curvature."""


class WindowLaw(NamedTuple):
    """How what is found in a window of T s errs: by noise s of f samples a second, s sqrt(noise / (f T^power)), and by
    its own second derivative, lag T^2 of that.

    `change` is the root mean square of that derivative, per s^2, until it is known; an error of `matters` is worth a
    word. `unit` is that of what is found, `of_noise` that of the samples.
    """

    noise: float
    power: int
    lag: float
    change: float
    matters: float
    unit: str
    of_noise: str


SLOPE: Final = WindowLaw(193.0, 3, 0.1, change=0.5, matters=0.1, unit="m/s^2", of_noise="m/s")
TURNING: Final = SLOPE._replace(change=0.05, matters=0.05, unit="rad/s^2", of_noise="rad/s")
END: Final = WindowLaw(4.0, 1, 1.0 / 12.0, change=0.5, matters=0.1, unit="m/s^2", of_noise="m/s^2")


class NoiseBalance:
    """Measures the noise of samples, and how fast what is found in them changes: so the window that errs least.

    The error of local least squares is least where its derivative by the window vanishes (Fan and Gijbels, "Local
    Polynomial Modelling and Its Applications", 1996, section 3.2): T^(power + 4) = power noise s^2 / (4 lag^2 f c^2)
    with the second derivative c. Only the seventh or fifth root counts, so that rough measures do.
    """

    def __init__(self, law: WindowLaw) -> None:
        self.law, self.best = law, LONGEST
        self._noise = DifferenceNoise()
        self._change = law.change * law.change
        self._step, self._time = 0.0, FIRST
        self._last: int | None = None
        self._found: deque[tuple[int, Vector3]] = deque(maxlen=3)

    @property
    def is_known(self) -> bool:
        """Whether the noise is."""
        return self._noise.seen >= KNOWN

    def clear(self) -> None:
        """Begin a new record: what was learnt stays."""
        self._last = None
        self._found.clear()
        self._noise.clear()

    def hear(self, stamp: int, values: Vector3) -> None:
        """Take a sample."""
        if self._last is not None:
            step = (stamp - self._last) / NANOSECONDS
            self._step += (step - self._step) / max(1, min(self._noise.seen, AVERAGED_STEPS))
        self._last = stamp
        self._noise.add(stamp, values)
        if self.is_known:
            law = self.law
            power = law.power * self._by_noise(1.0) / (4.0 * law.lag * law.lag * self._change)
            self.best = min(LONGEST, power ** (1.0 / (law.power + 4)))

    def found(self, stamp: int, value: Vector3, span: float) -> None:
        """Take what was found at a stamp in the window that spans so many s then."""
        found = self._found
        if found and stamp - found[-1][0] < max(APART, span) * NANOSECONDS:
            return
        found.append((stamp, value))
        if len(found) < 3:
            return
        (begin, first), (middle, second), (_, third) = found
        before, after = (middle - begin) / NANOSECONDS, (stamp - middle) / NANOSECONDS
        # The second derivative, whose noise is of three windows that do not overlap.
        bends = add(times(add(third, second, -1.0), 1.0 / after), add(second, first, -1.0), -1.0 / before)
        scale = 2.0 / (before + after)
        noise = self._by_noise(span) * (1.0 / after**2 + 1.0 / before**2 + (1.0 / after + 1.0 / before) ** 2)
        self._time = min(self._time + after, AVERAGED)
        change = scale * scale * (dot(bends, bends) / 3.0 - noise)
        self._change += after / self._time * (change - self._change)
        self._change = max(self._change, SURELY * scale * scale * noise, TINY)

    def error(self, span: float) -> float:
        """What is found in a window of so many s errs, as root mean square of an axis."""
        return sqrt(self._by_noise(span) + self._change * (self.law.lag * span * span) ** 2)

    def doubt(self, span: float) -> str:
        """What is wrong with a window of so many s, "" where nothing is."""
        error = self.error(span)
        if not self.is_known or error < self.law.matters or error < FAR * self.error(self.best):
            return ""
        short = span < self.best
        why = f"noise of {sqrt(self._noise.square):.2g} {self.law.of_noise}" if short else "lag"
        return (
            f"what is felt on the support errs by {error:.2g} {self.law.unit} by {why}, because a support.window of "
            f"{span:g} s is too {'short' if short else 'long'}: set that to {self.best:.2g}, or to 0.0, so that it "
            "follows the noise"
        )

    def _by_noise(self, span: float) -> float:
        """The mean square of what noise makes of what is found."""
        noise = self.law.noise * self._noise.square * self._step
        return noise / span**self.law.power if noise else 0.0


class MotionWindow:
    """The samples of three channels over the last `span` s, with one more so that they reach over all of it.

    A parabola through them has its slope at the last sample: exact for a derivative that changes linearly, so its lag
    is of the second order. With n samples over T s of noise s the slope has the standard deviation 13.9 s/(T sqrt(n)),
    four times that of a straight line, whose slope however is T/2 old; for a derivative of frequency w rad/s it is
    0.1 (w T)^2 of it off.
    """

    def __init__(self, span: float, law: WindowLaw) -> None:
        self.balance = NoiseBalance(law)
        self._given = span
        self._stamps: deque[int] = deque()
        self._channels: tuple[deque[float], ...] = (deque(), deque(), deque())
        self._is_full = False

    @property
    def span(self) -> float:
        """The window in s: the given one, or where that is 0 the one that errs least."""
        return self._given or self.balance.best

    def clear(self) -> None:
        self._is_full = False
        self.balance.clear()
        self._stamps.clear()
        for channel in self._channels:
            channel.clear()

    def add(self, stamp: int, values: Vector3) -> bool:
        """Take a sample later than the last, stamp in ns; tells whether there are enough for a slope.

        These are three, which have spanned the window once; it may have become longer since.
        """
        stamps = self._stamps
        self.balance.hear(stamp, values)
        stamps.append(stamp)
        first, second, third = self._channels
        first.append(values[0])
        second.append(values[1])
        third.append(values[2])
        begin = stamp - round(self.span * NANOSECONDS)
        while len(stamps) > 3 and stamps[1] <= begin:
            stamps.popleft()
            for channel in self._channels:
                channel.popleft()
        self._is_full |= len(stamps) > 2 and stamps[0] <= begin and (self._given > 0.0 or self.balance.is_known)
        return self._is_full

    def slopes(self) -> Vector3:
        """The derivatives of the channels at the last sample, per s."""
        first, last = self._stamps[0], self._stamps[-1]
        scale = 2.0 / (last - first)
        weights = slope_weights([1.0 + scale * (stamp - last) for stamp in self._stamps])
        scale *= NANOSECONDS
        slopes = []
        for channel in self._channels:
            slope, end = 0.0, channel[-1]
            for k, value in enumerate(channel):
                slope += weights[k] * (value - end)  # a large constant would leave its rounding in the slope
            slopes.append(scale * slope)
        x, y, z = slopes
        self.balance.found(last, (x, y, z), (last - self._stamps[0]) / NANOSECONDS)
        return x, y, z

    def ends(self) -> Vector3:
        """The values of the channels at the last sample, on the straight lines through them.

        Exact for a value that changes linearly. The noise is 2/sqrt(n) of a sample's.
        """
        last = self._stamps[-1]
        found = lines([(stamp - last) / NANOSECONDS for stamp in self._stamps], self._channels)
        (x, _), (y, _), (z, _) = found
        self.balance.found(last, (x, y, z), (last - self._stamps[0]) / NANOSECONDS)
        return x, y, z


def slope_weights(x: list[float]) -> list[float]:
    """What the values at x count in the slope, at 1, of their least-squares parabola.

    x lies within -1 .. 1 and has both ends of it.
    """
    count = len(x)
    s1 = s2 = s3 = s4 = 0.0
    for each in x:
        square = each * each
        s1 += each
        s2 += square
        s3 += each * square
        s4 += square * square
    # The normal equations, by minors: the weights c0 + c1 x + c2 x^2 have the moments 0, 1, 2.
    m0, m1, m2 = s1 * s4 - s2 * s3, s1 * s3 - s2 * s2, count * s3 - s1 * s2
    determinant = count * (s2 * s4 - s3 * s3) - s1 * m0 + s2 * m1
    if determinant < FLAT * count * count * count:
        part = 1.0 / (count * s2 - s1 * s1)
        return [part * (count * each - s1) for each in x]
    part = 1.0 / determinant
    c0 = part * (2.0 * m1 - m0)
    c1 = part * (count * s4 - s2 * s2 - 2.0 * m2)
    c2 = part * (2.0 * (count * s2 - s1 * s1) - m2)
    return [c0 + c1 * each + c2 * (each * each) for each in x]
