"""One step along the impulse while slips turn, with an error that is kept below a bound.

Most steps are explicit, of order 3, and their last rates are the next step's first: P. Bogacki, L. F. Shampine, A 3(2)
pair of Runge-Kutta formulas, Applied Mathematics Letters 2 (1989). A path that needs many of them is stiff, and the
others are implicit.

A step that ends the compression of B is one along c_nB, whose end is known, and not along N_B: each of its rates counts
for as much of N_B as stops c_nB.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from .transverse_implicit import implicit_step
from .transverse_states import Across, RatesAcross, Slips, rates, way_of

EXPLICIT = 24
"""Attempts at explicit steps before a path counts as stiff: one to a tolerance of 1e-3 needs two to eight."""

ATTEMPTS = 40
"""How often a step is shortened before the path counts as lost: by a factor of two at least each time."""

SURE = 0.1
"""What the second difference of the rates counts as the error of an explicit step. 1 / 24 would make it that of a step
of order 2, which is too little where a slip turns by much."""

State = RatesAcross
"""N_A, T_A, Z_A, N_B, T_B, Z_B so far, and c_nA, c_tA, c_zA, c_nB, c_tB, c_zB."""


class Arc(NamedTuple):
    """A stretch of the path.

    The states at its ends; the rates there, and the N_B in which each of them would make the whole stretch; `work` of
    the normal impulse at B on the body; the ways of the slips at its end.
    """

    begin: State
    end: State
    first: RatesAcross
    last: RatesAcross
    first_span: float
    last_span: float
    work: float
    way: Slips

    def at(self, part: float) -> State:
        """The state at a part (0..1) of the stretch, by the cubic through both ends."""
        return tuple([self.component(index, part) for index in range(12)])  # type: ignore[return-value]

    def component(self, index: int, part: float) -> float:
        """A component of `at`."""
        first, last = self.first_span * self.first[index], self.last_span * self.last[index]
        return cubic(self.begin[index], self.end[index], first, last, part)

    def worked(self, part: float) -> float:
        """The work until a part of the stretch."""
        return cubic(0.0, self.work, self.first_span * self.begin[9], self.last_span * self.end[9], part)


def cubic(begin: float, end: float, first: float, last: float, part: float) -> float:
    """A part (0..1) of the way from `begin` to `end`, with the slopes `first` and `last` there."""
    slopes = (1.0 - part) * first - part * last
    return begin + part * part * (3.0 - 2.0 * part) * (end - begin) + part * (1.0 - part) * slopes


def straight_arc(y: State, rate: RatesAcross, span: float, way: Slips) -> Arc:
    """A stretch in which N_B grows by `span` and the rates do not change."""
    end: State = tuple([p + span * q for p, q in zip(y, rate, strict=True)])  # type: ignore[assignment]
    return Arc(y, end, rate, rate, span, span, 0.5 * span * (y[9] + end[9]), way)


def advance(
    across: Across,
    a: int,
    b: int,
    way: Slips,
    y: State,
    rate: RatesAcross,
    span: float,
    ends: bool,
    small: float,
    tries: int,
) -> tuple[Arc, float, int] | None:
    """A step in which N_B grows by `span` or less, with an error below `small` in every slip; None where none is found.

    A and B are in the states `a` and `b`; `rate` are the rates at y, where the slips go along `way`. With `ends` the
    compression would end with the step, were the rates to stay. Returns also how many times as long the next step may
    be, and the number of attempts on this path, `tries` before the step.
    """
    for attempt in range(tries, tries + ATTEMPTS):
        step = explicit_step if attempt < EXPLICIT else stiff_step
        tried = step(across, a, b, way, y, rate, span, ends, small)
        if tried is None:
            span *= 0.25
        else:
            arc, error = tried
            factor = 0.8 * sqrt(sqrt(small / error)) if error > 0.0 else 4.0
            if error <= small:
                return arc, min(factor, 4.0), attempt + 1
            span *= min(max(factor, 0.1), 0.5)
        ends = False
    return None


def explicit_step(
    across: Across,
    a: int,
    b: int,
    way: Slips,
    y: State,
    rate: RatesAcross,
    span: float,
    ends: bool,
    small: float,
) -> tuple[Arc, float] | None:
    """The stretch that a step makes, and the largest error of a slip in it.

    None where the rates end on the way: a slip jams, or B is not slowed down by all of them.
    """
    na, ta, za, nb, tb, zb, cna, cta, cza, cnb, ctb, czb = y
    na1, ta1, za1, _, tb1, zb1, rna1, rta1, rza1, rnb1, rtb1, rzb1 = rate
    h = 0.5 * span
    second = rates(across, a, b, way_of(cta + h * rta1, cza + h * rza1, ctb + h * rtb1, czb + h * rzb1, way, 0.0))
    if second is None:
        return None
    na2, ta2, za2, _, tb2, zb2, rna2, rta2, rza2, rnb2, rtb2, rzb2 = second
    span2 = span3 = span4 = span
    if ends:
        if not rnb2 > 0.0:
            return None
        span2 = span * rnb1 / rnb2
    h = 0.75 * span2
    third = rates(across, a, b, way_of(cta + h * rta2, cza + h * rza2, ctb + h * rtb2, czb + h * rzb2, way, 0.0))
    if third is None:
        return None
    na3, ta3, za3, _, tb3, zb3, rna3, rta3, rza3, rnb3, rtb3, rzb3 = third
    if ends:
        if not rnb3 > 0.0:
            return None
        span3 = span * rnb1 / rnb3

    p, q, r = 2.0 / 9.0 * span, 1.0 / 3.0 * span2, 4.0 / 9.0 * span3
    slips = (
        cta + p * rta1 + q * rta2 + r * rta3,
        cza + p * rza1 + q * rza2 + r * rza3,
        ctb + p * rtb1 + q * rtb2 + r * rtb3,
        czb + p * rzb1 + q * rzb2 + r * rzb3,
    )
    there = way_of(*slips, way, small)
    last = rates(across, a, b, there)
    if last is None:
        return None
    _, _, _, _, _, _, _, rta4, rza4, rnb4, rtb4, rzb4 = last
    if ends:
        if not rnb4 > 0.0:
            return None
        span4 = span * rnb1 / rnb4
    error = SURE * max(
        abs(span * rta1 - 2.0 * span2 * rta2 + span4 * rta4),
        abs(span * rza1 - 2.0 * span2 * rza2 + span4 * rza4),
        abs(span * rtb1 - 2.0 * span2 * rtb2 + span4 * rtb4),
        abs(span * rzb1 - 2.0 * span2 * rzb2 + span4 * rzb4),
    )
    end = (
        na + p * na1 + q * na2 + r * na3,
        ta + p * ta1 + q * ta2 + r * ta3,
        za + p * za1 + q * za2 + r * za3,
        nb + p + q + r,
        tb + p * tb1 + q * tb2 + r * tb3,
        zb + p * zb1 + q * zb2 + r * zb3,
        cna + p * rna1 + q * rna2 + r * rna3,
        slips[0],
        slips[1],
        cnb + p * rnb1 + q * rnb2 + r * rnb3,
        slips[2],
        slips[3],
    )
    work = p * cnb + q * (cnb + 0.5 * span * rnb1) + r * (cnb + 0.75 * span2 * rnb2)
    return Arc(y, end, rate, last, span, span4, work, there), error


def stiff_step(
    across: Across,
    a: int,
    b: int,
    way: Slips,
    y: State,
    rate: RatesAcross,
    span: float,
    _: bool,
    small: float,
) -> tuple[Arc, float] | None:
    """As `explicit_step`, by an implicit one along N_B."""
    step = implicit_step(across, a, b, way, y, rate, span)
    if step is None:
        return None
    end, error = step
    there = way_of(end[7], end[8], end[10], end[11], way, small)
    last = rates(across, a, b, there)
    if last is None:
        return None
    work = span * (0.5 * (y[9] + end[9]) + span * (rate[9] - last[9]) / 12.0)
    return Arc(y, end, rate, last, span, span, work, there), error
