"""The draws of an impact, and what the answers to all of them say, as law code on flat sequences (see
`mechanics.compiled`).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import erf, inf, sqrt
from typing import TYPE_CHECKING

from ..mechanics.impact.spatial_body import ANSWER, BODY, CONTACT, RESULT
from ..mechanics.impact.spatial_path import LEAVES, NEARS, SLIPS, STICKS
from ..mechanics.types import Mode

if TYPE_CHECKING:
    from ..mechanics.compiled import Floats

NO_IMPACT, STOP, SLIDE, PIVOT_SLIDE, PIVOT, BACK_PIVOT, FLIGHT = (int(mode) for mode in Mode)

OF_MODE = 2
"""Numbers of each mode in what is told: its probability, and how many draws have it."""

PLANAR = OF_MODE * len(Mode)
"""Where what is told has mean and variance of the twist in the impact plane; then the covariance of the body's ..."""

LIKELIEST = PLANAR + 6 + 36
"""... then the likeliest mode that a draw has, and the last of the draws that are told ..."""

LIFTS = LIKELIEST + 2
"""... then the probability with which each contact lifts, the mean of the answers that are told, and scratch."""

SCRATCH = 15
"""Numbers of scratch besides one for each draw."""

ROUNDING = 1e-9
ROOT = sqrt(2.0)


def spread(
    n: int,
    standing: int,
    problem: Floats,
    turning: Sequence[Floats],
    points: Sequence[Floats],
    given: Floats,
    problems: Sequence[Floats],
) -> None:
    """Fill in the problems of draws: a problem of n contacts, with what is uncertain of it moved by points.

    `points` has a row for each number that is uncertain. `turning` makes of the first of them, where it has rows, the
    changes of the twist. `given` is the standard deviation of friction, of restitution and of the gaps; then the rates
    in m/s of those that close, which follow the first `standing` ones. What does not vary has a deviation of zero, and
    no row.
    """
    friction, restitution, gap = given[0], given[1], given[2]
    for d in range(len(problems)):
        draw = problems[d]
        for j in range(len(problem)):
            draw[j] = problem[j]
        row = len(turning)
        for i in range(row):
            change = 0.0
            for j in range(row):
                change += turning[i][j] * points[j][d]
            draw[7 + i] += change
        if friction > 0.0 or restitution > 0.0:
            for i in range(n):
                k = BODY + CONTACT * i
                draw[k + 6] = max(0.0, draw[k + 6] + friction * points[row][d])
                draw[k + 7] = min(1.0, max(0.0, draw[k + 7] + restitution * points[row + 1][d]))
            row += 2
        if gap > 0.0:
            first = inf
            for i in range(standing, n):
                k = BODY + CONTACT * i + 11
                draw[k] += gap * points[row + i - standing][d]
                first = min(first, draw[k] / -given[3 + i - standing])
            for i in range(standing, n):
                k = BODY + CONTACT * i + 11
                # Time counts from when the first of them closes.
                draw[k] = max(0.0, draw[k] + first * given[3 + i - standing])


def over(margin: float, blur: float) -> float:
    """The probability that a quantity of a mean and a standard deviation is above zero."""
    return 0.5 * (1.0 + erf(margin / (blur * ROOT)))


def tell(n: int, standing: int, problem: Floats, answers: Sequence[Floats], given: Floats, told: Floats) -> None:
    """Fill in what the answers to draws of a problem say; the first `standing` of its n contacts stand.

    `given` is the rate in m/s above which a group of contacts leaves; by what part of its speed a contact strays from
    the law; the speed that gravity gives in a contact time; then the body's axes, its mass centre in its frame, and the
    axis and the normal of the impact plane.
    """
    for k in range(len(told)):
        told[k] = 0.0
    tell_modes(n, standing, problem, answers, given, told)
    tell_answer(n, problem, answers, given[0], told)
    tell_moments(n, answers, given, told)


def tell_modes(n: int, standing: int, problem: Floats, answers: Sequence[Floats], given: Floats, told: Floats) -> None:
    """Fill in how likely each mode is and each contact's lift, and which mode each draw has."""
    least, stray, slow = given[0], given[1], given[2]
    square, count, modes = 0.0, len(answers), LIFTS + n + ANSWER + RESULT * n + SCRATCH
    for i in range(n):
        k = BODY + CONTACT * i
        square += problem[k] * problem[k] + problem[k + 1] * problem[k + 1] + problem[k + 2] * problem[k + 2]
    vx, vy, vz, wx, wy, wz = problem[7], problem[8], problem[9], problem[10], problem[11], problem[12]
    speed = sqrt(vx * vx + vy * vy + vz * vz) + sqrt((wx * wx + wy * wy + wz * wz) * square / n)
    blur = max(stray, ROUNDING) * speed
    for d in range(count):
        answer = answers[d]
        old = new = 0.0
        old_lifts = new_lifts = old_slips = new_slips = False
        for group in range(2):
            begin, end = (0, standing) if group == 0 else (standing, n)
            rate, held, slips = 0.0, 0.0, False
            for i in range(begin, end):
                k, at = BODY + CONTACT * i + 3, ANSWER + RESULT * i
                push = problem[k] * answer[at] + problem[k + 1] * answer[at + 1] + problem[k + 2] * answer[at + 2]
                away = problem[k] * answer[at + 3] + problem[k + 1] * answer[at + 4] + problem[k + 2] * answer[at + 5]
                # What holds would go into its support by as much as its impulse takes it back; what leaves more slowly
                # than gravity takes back in a contact time does not lift.
                margin = away if away > least else -answer[at + 7] * push
                told[LIFTS + i] += over(margin - slow, blur) / count
                rate, held, slips = rate + away, held + min(0.0, margin), slips or answer[at + 6] == SLIPS
            rate = rate / (end - begin) if end > begin else inf
            lifts = rate > least
            chance = over((rate if lifts else held / (end - begin)) - slow, blur)
            if group == 0:
                old, old_lifts, old_slips = chance, lifts, slips
            else:
                new, new_lifts, new_slips = chance, lifts, slips
        alone, none = PIVOT_SLIDE if new_slips else PIVOT, SLIDE if old_slips or new_slips else STOP
        told[OF_MODE * FLIGHT] += old * new / count
        told[OF_MODE * BACK_PIVOT] += (1.0 - old) * new / count
        told[OF_MODE * alone] += old * (1.0 - new) / count
        told[OF_MODE * none] += (1.0 - old) * (1.0 - new) / count
        mode = alone if old_lifts else none
        if new_lifts:
            mode = FLIGHT if old_lifts else BACK_PIVOT
        told[OF_MODE * mode + 1] += 1.0
        told[modes + d] = float(mode)


def tell_answer(n: int, problem: Floats, answers: Sequence[Floats], least: float, told: Floats) -> None:
    """Fill in the likeliest mode that a draw has, and the mean of the answers with it.

    A contact has closed in it that has done so in half of them.
    """
    count, size, whole = len(answers), ANSWER + RESULT * n, LIFTS + n
    modes = whole + size + SCRATCH
    best = 0
    for mode in range(STOP, FLIGHT + 1):
        if told[OF_MODE * mode + 1] > 0.0 and (best == 0 or told[OF_MODE * mode] > told[OF_MODE * best]):
            best = mode
    most = told[OF_MODE * best + 1]
    for d in range(count):
        if told[modes + d] == best:
            told[LIKELIEST], told[LIKELIEST + 1] = float(best), float(d)
            for j in range(size):
                told[whole + j] += answers[d][j] / most
    for i in range(n):
        k, at = BODY + CONTACT * i + 3, ANSWER + RESULT * i + 6
        away, nears, slips = 0.0, 0.0, False
        for j in range(3):
            away += problem[k + j] * told[whole + at - 3 + j]
        for d in range(count):
            if told[modes + d] == best:
                nears += 1.0 if answers[d][at] == NEARS else 0.0
                slips = slips or answers[d][at] == SLIPS
        told[whole + at] = SLIPS if slips else STICKS
        if away > least:
            told[whole + at] = LEAVES
        elif nears > 0.5 * most:
            told[whole + at] = NEARS


def tell_moments(n: int, answers: Sequence[Floats], given: Floats, told: Floats) -> None:
    """Fill in mean and variance of the twist in the impact plane, and its covariance along the axes of the body."""
    count, spot = len(answers), LIFTS + n + ANSWER + RESULT * n
    for d in range(count):
        for j in range(6):
            told[spot + 9 + j] += answers[d][j] / count
    for d in range(-1, count):
        # The mean of all draws, and how each of them differs from it, along the axes of the body and in the plane.
        for j in range(9):
            told[spot + j] = 0.0
        for j in range(3):
            mean, turn = told[spot + 9 + j], told[spot + 12 + j]
            v, w = (mean, turn) if d < 0 else (answers[d][j] - mean, answers[d][3 + j] - turn)
            for k in range(3):
                told[spot + k] += given[3 + 3 * k + j] * v
                told[spot + 3 + k] += given[3 + 3 * k + j] * w
            ax, nx = given[15 + (j + 1) % 3], given[18 + (j + 2) % 3]
            ay, ny = given[15 + (j + 2) % 3], given[18 + (j + 1) % 3]
            told[spot + 6] += (ax * nx - ay * ny) * v
            told[spot + 7] += given[18 + j] * v
            told[spot + 8] -= given[15 + j] * w
        if d < 0:
            for k in range(3):
                told[PLANAR + k] = told[spot + 6 + k]
            continue
        for k in range(3):
            a, b = (k + 1) % 3, (k + 2) % 3
            told[spot + k] -= told[spot + 3 + a] * given[12 + b] - told[spot + 3 + b] * given[12 + a]
            told[PLANAR + 3 + k] += told[spot + 6 + k] * told[spot + 6 + k] / count
        for j in range(6):
            for k in range(6):
                told[PLANAR + 6 + 6 * j + k] += told[spot + j] * told[spot + k] / count
