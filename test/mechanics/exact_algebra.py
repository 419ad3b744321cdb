"""Linear systems, linear inequalities and roots of fractions."""

from fractions import Fraction
from itertools import product
from math import isqrt, lcm

ZERO, ONE = Fraction(0), Fraction(1)


def dot(u, v):
    terms = [(x.numerator * y.numerator, x.denominator * y.denominator) for x, y in zip(u, v, strict=True) if x and y]
    common = lcm(*(below for _, below in terms))
    return Fraction(sum(above * (common // below) for above, below in terms), common)


def solve(matrix, right):
    """One solution of a linear system and the directions in which it is free; None where it has no solution.

    The rows are brought to whole numbers, which are eliminated without fractions (Bareiss): every number is then a
    minor of the matrix, and the leads are all one, the last.
    """
    table = [whole([*row, value]) for row, value in zip(matrix, right, strict=True)]
    size, leads, last = len(matrix[0]), [], 1
    for column in range(size):
        done = len(leads)
        chosen = next((i for i in range(done, len(table)) if table[i][column]), None)
        if chosen is None:
            continue
        table[done], table[chosen] = table[chosen], table[done]
        own = table[done]
        lead = own[column]
        for i, row in enumerate(table):
            if i != done:
                part = row[column]
                table[i] = [(lead * x - part * y) // last for x, y in zip(row, own, strict=True)]
        leads.append(column)
        last = lead
    if any(row[size] for row in table[len(leads) :]):
        return None
    point, free = [ZERO] * size, []
    for i, column in enumerate(leads):
        point[column] = Fraction(table[i][size], last)
    for column in sorted(set(range(size)) - set(leads)):
        direction = [ONE if k == column else ZERO for k in range(size)]
        for i, lead in enumerate(leads):
            direction[lead] = Fraction(-table[i][column], last)
        free.append(direction)
    return point, free


def whole(row):
    """Fractions times their common denominator."""
    common = lcm(*(x.denominator for x in row))
    return [x.numerator * (common // x.denominator) for x in row]


def within(conditions, count):
    """A point s of `count` numbers with slopes . s <= room for all (slopes, room), or None (Fourier and Motzkin)."""
    if count == 0:
        return [] if all(room >= 0 for _, room in conditions) else None
    sizes = [abs(slopes[-1]) or ONE for slopes, _ in conditions]
    scaled = [([x / size for x in slopes], room / size) for size, (slopes, room) in zip(sizes, conditions, strict=True)]
    bounds = [condition for condition in scaled if condition[0][-1]]
    rest = [(slopes[:-1], room) for slopes, room in scaled if not slopes[-1]]
    for (above, high), (below, low) in product(bounds, bounds):
        if above[-1] > below[-1]:
            rest.append(([u + v for u, v in zip(above[:-1], below[:-1], strict=True)], high + low))
    others = within(rest, count - 1)
    if others is None:
        return None
    limits = [(slopes[-1], room - dot(slopes[:-1], others)) for slopes, room in bounds]
    lowest = max((-room for sign, room in limits if sign < 0), default=ZERO)
    highest = min((room for sign, room in limits if sign > 0), default=ZERO)
    return [*others, lowest if lowest > 0 else min(highest, ZERO)]


def root(value):
    """The root of a fraction to 60 digits."""
    return Fraction(isqrt(value.numerator * value.denominator << 400), value.denominator << 200)
