"""Impacts decided in exact rational arithmetic: the laws as they are stated, without any of the package's shortcuts.

Contact velocities c answer the impulses P = (N_A, T_A, N_B, T_B) as c + W P, where W = G M^-1 G^T and G has the rows of
the contacts. Every pair of contact states is tried; each is a linear system in fractions. A float is a fraction, so
that any input of the package can be decided. Nothing is divided by a radius of gyration or by the length of a normal,
which are roots: a normal of length L makes its contact's velocities L times and its impulses 1 / L times as large, and
the friction cone and the work are the same. The one root that remains, where the work ends the restitution, is taken to
60 digits.
"""

from fractions import Fraction
from itertools import product
from typing import NamedTuple

from exact_algebra import ONE, ZERO, dot, root, solve, within

SPEED_ROUNDING = Fraction(1e-14)
"""A contact speed below this part of the terms it is the sum of counts as zero, as the package has it."""

TWIST_ROUNDING = Fraction(1e-15)
"""What is below this part is the rounding of the twist itself."""

NA, TA, NB, TB = range(4)
OLD, NEW = (NA, TA), (NB, TB)


class Undecided(Exception):
    """The law has no answer."""


class Problem(NamedTuple):
    """What a law is asked.

    Rows of G on (vx, vy, omega); W; squares of the lengths of the normals; contact velocities before, c_nA being None
    where there is no A; frictions and restitutions of A and B; the inverses of mass, mass and inertia.
    """

    rows: list
    w: list
    squares: tuple
    velocities: list
    frictions: tuple
    restitutions: tuple
    mobility: tuple


class Answer(NamedTuple):
    """What a law answers.

    Change of (vx, vy, omega); contact velocities at the beginning, at each change of states and at the end; impulses,
    of which those of two sticking contacts are one possible choice; contact states; whether the path jams and whether
    the stored work ends its restitution; how many answers there are where there first are several.
    """

    change: list
    history: list
    impulses: list
    segments: tuple
    jammed: bool = False
    work_limited: bool = False
    choices: int = 1


def problem_of(body, twist):
    """A TwoPointBody and its twist, floats or fractions, as they are; but a contact that rests up to rounding rests."""
    mobility = (1 / Fraction(body.mass), 1 / Fraction(body.mass), 1 / Fraction(body.inertia))
    contacts = (body.old or body.new, body.new)
    rows, squares, velocities = [], [], []
    vx, vy, omega = map(Fraction, twist)
    for contact in contacts:
        x, y, nx, ny, ux, uy = map(Fraction, (contact.x, contact.y, *contact.normal, *contact.velocity))
        square = nx * nx + ny * ny
        size = square * sum(map(abs, (vx, vy, omega * x, omega * y, ux, uy))) ** 2
        for row in ((nx, ny, x * ny - y * nx), (ny, -nx, -x * nx - y * ny)):
            speed = dot(row, (vx, vy, omega)) - row[0] * ux - row[1] * uy
            if speed**2 <= SPEED_ROUNDING**2 * size:
                if contact is body.old and speed**2 <= TWIST_ROUNDING**2 * size:  # for B, too, the body rests on A
                    vx, vy = vx - speed * row[0] / square, vy - speed * row[1] / square
                speed = ZERO
            rows.append(row)
            velocities.append(speed)
        squares.append(square)
    if body.old is None:
        velocities[:2] = [None, ZERO]
    w = [[dot(u, [x * m for x, m in zip(v, mobility, strict=True)]) for v in rows] for u in rows]
    frictions = tuple(Fraction(contact.friction) for contact in contacts)
    restitutions = tuple(Fraction(contact.restitution) for contact in contacts)
    return Problem(rows, w, tuple(squares), velocities, frictions, restitutions, mobility)


def changed(velocities, impulse, problem):
    """Contact velocities after an impulse."""
    return [None if c is None else c + dot(row, impulse) for c, row in zip(velocities, problem.w, strict=True)]


def change_of_twist(impulse, problem):
    columns = zip(*problem.rows, strict=True)
    return [m * dot(column, impulse) for m, column in zip(problem.mobility, columns, strict=True)]


def impulses(problem, states, given, unit):
    """Impulses that lie in the friction cones and, by the states, keep the velocities `given` at zero; or None.

    With `unit` B's normal impulse is 1, whatever becomes of its normal velocity.
    """
    matrix, right, cones = [], [], []
    for (n, t), state, f in zip((OLD, NEW), states, problem.frictions, strict=True):
        normal, tangential = ([ONE if k == i else ZERO for k in range(4)] for i in (n, t))
        if state == "O":
            matrix += [normal, tangential]
            right += [ZERO, ZERO]
            continue
        matrix.append(normal if unit and n == NB else problem.w[n])
        right.append(ONE if unit and n == NB else -given[n])
        if state == "S":
            matrix.append(problem.w[t])
            right.append(-given[t])
        else:
            slide = f if state == "+" else -f
            matrix.append([x + slide * y for x, y in zip(tangential, normal, strict=True)])
            right.append(ZERO)
        cones += [(n, -ONE, t, ZERO), (n, -f, t, ONE), (n, -f, t, -ONE)]
    found = solve(matrix, right)
    if found is None or (found[1] and states != "SS"):
        return None
    point, free = found
    # Two sticking contacts can push each other: any push that the cones allow will do.
    conditions = [([u * m[n] + v * m[t] for m in free], -u * point[n] - v * point[t]) for n, u, t, v in cones]
    pushes = within(conditions, len(free))
    if pushes is None:
        return None
    return [p + dot(pushes, [move[k] for move in free]) for k, p in enumerate(point)]


def total(problem):
    """All answers of the total-impulse law: 0 <= N _|_ c'_n + e c_n >= 0 and Coulomb's law, Newton's restitution."""
    given = list(problem.velocities)
    for n, restitution in zip((NA, NB), problem.restitutions, strict=True):
        if given[n] is not None and given[n] < 0:
            given[n] *= 1 + restitution
    answers = []
    for states in map("".join, product("O" if given[NA] is None else "OS+-", "OS+-")):
        impulse = impulses(problem, states, given, unit=False)
        if impulse is None:
            continue
        after = changed(given, impulse, problem)
        if all(
            (state != "O" or after[n] is None or after[n] >= 0)
            and (state != "+" or after[t] >= 0)
            and (state != "-" or after[t] <= 0)
            for (n, t), state in zip((OLD, NEW), states, strict=True)
        ):
            change = change_of_twist(impulse, problem)
            if all(change != other.change for other in answers):
                ends = [problem.velocities, changed(problem.velocities, impulse, problem)]
                answers.append(Answer(change, ends, impulse, (states,)))
    return answers


def slip_states(slip):
    """States that a closed contact with this slip may be in."""
    return "S+-" if slip == 0 else "+" if slip > 0 else "-"


def consistent_states(problem, c, compressing):
    """All that Coulomb's law allows at c: states of A and B, their impulses and velocity rates for each unit of N_B.

    While B is compressed its approach must become slower, or another velocity must go to zero.
    """
    found = []
    stands = c[NA] == 0
    for states in map("".join, product("O" + slip_states(c[TA]) if stands else "O", slip_states(c[TB]))):
        impulse = impulses(problem, states, [ZERO] * 4, unit=True)
        if impulse is None:
            continue
        rates = changed([ZERO] * 4, impulse, problem)
        slips = [(c[t], rates[t], state) for t, state in zip((TA, TB), states, strict=True) if state in "+-"]
        if any(slip == 0 and (growth < 0 if state == "+" else growth > 0) for slip, growth, state in slips):
            continue
        lifts = states[0] == "O" and c[NA] is not None
        if lifts and stands and rates[NA] < 0:
            continue
        goes_on = rates[NB] > 0 or (lifts and rates[NA] < 0) or any(slip * growth < 0 for slip, growth, _ in slips)
        if (goes_on or not compressing) and all(rates != other for _, _, other in found):
            found.append((states, impulse, rates))
    return found


def strike_old(problem, c):
    """Impulses of the tangential impact at A that ends a jam, and the states along it.

    B is held. Friction against the slip presses A into its support until the slip ends; N_A goes on growing, while A
    sticks or slips back, until A's approach ends too.
    """
    f, slip, w = problem.frictions[0], c[TA], problem.w
    if c[NA] != 0 or slip == 0:
        raise Undecided("no consistent rates, and the old contact does not slip")
    ray = -f if slip > 0 else f
    normal, tangential = (w[k][NA] + ray * w[k][TA] for k in OLD)
    if normal >= 0 or tangential * slip >= 0:
        raise Undecided("no consistent rates, and the old contact does not jam")
    n = -slip / tangential
    hold = -w[TA][NA] / w[TA][TA]
    sticks = abs(hold) <= f
    back = hold if sticks else -ray
    rise = -normal * n / (w[NA][NA] + back * w[NA][TA])
    first, second = ("+", "-") if slip > 0 else ("-", "+")
    return [n + rise, ray * n + back * rise, ZERO, ZERO], (first + "O", ("S" if sticks else second) + "O")


def rest_of_jams(before, after, target, full=None):
    """Impulses that are still to come, and the stored work then, where jams after which A sticks have no end, or None.

    Each jam is told by the contact velocities, the impulses and the stored work after it. With A at rest all that
    follows is in proportion to the slip at B. If that is a part of what it was, the jams follow each other without end,
    and what changes from one to the next is a geometric series: unless the compression ends before it does, or the
    expansion, by N_B (the target) or by the work; or the spring of B, `full` of work at most, is pressed or let go.
    """
    (c, p, work), (next_c, next_p, next_work) = before, after
    if c[TA] or next_c[TA] or not c[TB] or not 0 < next_c[TB] / c[TB] < 1:
        return None
    factor = next_c[TB] / c[TB]
    times, times_squares = factor / (1 - factor), factor**2 / (1 - factor**2)
    rest = [times * (q - p) for p, q in zip(p, next_p, strict=True)]
    approach = next_c[NB] + times * (next_c[NB] - c[NB])
    # The work of a steady approach of B goes with the impulses, the remainder with their squares.
    steady = -approach * (next_p[NB] - p[NB])
    left = next_work + times * steady + times_squares * (next_work - work - steady)
    if full is not None:
        ends = next_c[NB] * approach < 0 or not 0 <= left <= full
    else:
        ends = next_p[NB] + rest[NB] > target or left < 0 if target else approach > 0
    return None if ends else (rest, left)


def span_to(work, velocity, rate):
    """The first impulse after which velocity s + rate s^2 / 2 has grown to `work`, or None."""
    if work == 0:
        return ZERO if velocity > 0 or (velocity == 0 and rate > 0) else None
    square = velocity**2 + 2 * rate * work
    spans = [work / velocity] if rate == 0 and velocity else []
    if rate and square >= 0:
        spans = [(sign * root(square) - velocity) / rate for sign in (1, -1)]
    return min((span for span in spans if span > 0), default=None)


def path(problem, longest=60, energetic=False):
    """The impulse-path law: Routh's hypothesis with Poisson's restitution at B, limited by the stored work.

    With the energetic one B is a spring, which keeps e^2 of the work of its compression and opens when that is given.
    """
    if (problem.velocities[NA] or 0) < 0 or problem.velocities[NB] >= 0:
        raise Undecided("the path begins where the new contact is approached and the old one is not")
    history, spent, segments, jams = [problem.velocities], [ZERO] * 4, (), []
    restitution, work, target = problem.restitutions[1], ZERO, None
    choices, jammed, work_limited = 1, False, False
    stored, full, opens = ZERO, None, None

    def add(impulse, span):
        history.append(changed(history[-1], [span * p for p in impulse], problem))
        spent[:] = [p + span * q for p, q in zip(spent, impulse, strict=True)]

    while len(segments) < longest:
        c, compressing = history[-1], target is None
        found = consistent_states(problem, c, compressing)
        if found:
            states, impulse, rates = found[0]
            segments += (states,)
            choices = len(found) if choices == 1 else choices
            ends = [target - spent[NB]] if target else [-c[NB] / rates[NB]] if rates[NB] > 0 else []
            square = c[NB] ** 2 + 2 * rates[NB] * work
            if energetic and target:
                opens, fills = span_to(work, c[NB], rates[NB]), span_to(full - work, -c[NB], -rates[NB])
                ends = [span for span in (opens, fills) if span is not None]
            elif target and square >= 0 and c[NB] + root(square) > 0:
                ends.append(2 * work / (c[NB] + root(square)))
            closing = [NA] if c[NA] and rates[NA] < 0 else []
            slips = [t for t, state in zip((TA, TB), states, strict=True) if state in "+-" and c[t] * rates[t] < 0]
            spans = ends + [-c[k] / rates[k] for k in closing + slips]
            if not spans and energetic and target and not c[NB]:
                break  # locked at rest
            if not spans:
                raise Undecided("the path has no end")
            span = min(spans)
            ended = span in ends
            work_limited |= ended and span != ends[0] and not energetic
            work -= span * (c[NB] + rates[NB] * span / 2)
            add(impulse, span)
        else:
            impulse, states = strike_old(problem, c)
            jammed, segments = True, segments + states
            add(impulse, ONE)
            jams.append((history[-1], list(spent), work))
            rest = rest_of_jams(jams[-2], jams[-1], target, full if target else None) if len(jams) > 1 else None
            if rest:
                impulse, work = rest
                add(impulse, ONE)
            ended = compressing and history[-1][NB] >= 0
        if ended and energetic and restitution:
            if compressing:
                stored, work, target, jams = work, restitution**2 * work, ONE, []
                full = work
            elif span == opens:
                break
            else:  # the compression goes on
                work, target, jams = stored, None, []
        elif ended:
            if history[-1][NB] < 0:
                # B was pressed again while it expanded: a plastic compression ends that.
                restitution, target, jams = ZERO, None, []
            elif restitution == 0 or not compressing or history[-1][NB] > 0:
                break
            else:
                target, jams = (1 + restitution) * spent[NB], []
    else:
        raise Undecided("the path is too long")
    return Answer(change_of_twist(spent, problem), history, spent, segments, jammed, work_limited, choices)
