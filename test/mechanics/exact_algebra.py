"""Linear systems, linear inequalities and roots of fractions."""

from fractions import Fraction
from itertools import product
from math import isqrt

ZERO, ONE = Fraction(0), Fraction(1)


def dot(u, v):
    return sum((x * y for x, y in zip(u, v, strict=True) if x and y), ZERO)


def solve(matrix, right):
    """One solution of a linear system and the directions in which it is free; None where it has no solution."""
    table = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    size, leads = len(matrix[0]), []
    for column in range(size):
        done = len(leads)
        lead = next((i for i in range(done, len(table)) if table[i][column]), None)
        if lead is None:
            continue
        table[done], table[lead] = table[lead], table[done]
        table[done] = [x / table[done][column] for x in table[done]]
        for i, row in enumerate(table):
            if i != done and row[column]:
                table[i] = [x - row[column] * y if y else x for x, y in zip(row, table[done], strict=True)]
        leads.append(column)
    if any(row[size] for row in table[len(leads) :]):
        return None
    point, free = [ZERO] * size, []
    for i, column in enumerate(leads):
        point[column] = table[i][size]
    for column in sorted(set(range(size)) - set(leads)):
        direction = [ONE if k == column else ZERO for k in range(size)]
        for i, lead in enumerate(leads):
            direction[lead] = -table[i][column]
        free.append(direction)
    return point, free


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
