"""References for impacts in three dimensions, by other ways than the package's: they share no code with it.

`one_contact` follows Routh's hypothesis along the normal impulse N of a single contact (J. B. Keller, Impact with
friction, Journal of Applied Mechanics 53 (1986) 1-4):

    dc/dN = W (-f u, 1), u the direction of slip,

and c_t = 0 is kept where the friction |W_tt^-1 W_tn| <= f allows it. Slip that stops turns infinitely fast in N; in
theta, dN = |c_t| dtheta, nothing is singular. The restitution is energetic (W. J. Stronge, Rigid body collisions with
friction, Proceedings of the Royal Society A 431 (1990) 169-181): with A(N) = -integral of c_n dN the work that the
contact has taken up and M(N) the most so far, it ends where A <= (1 - e^2) M.

`on_springs` lets n contacts press on springs in time, each of which gives back e^2 of the work it stored, with Coulomb
friction that is full from a slip of `regularisation` on; of a mechanism or body that does not move meanwhile (the limit
of stiff springs), or of a rigid body that moves and turns by Newton's and Euler's equations.
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

STOPPED = -34.0
"""Logarithm of the part of the slip that counts as none: the rest of its path is below a rounding."""


class Path(NamedTuple):
    """After an impact at one contact: velocity and impulse (t1, t2, n) and what its slip did, one letter each: s slips,
    S sticks, r slips again after it stopped.
    """

    velocity: np.ndarray
    impulse: np.ndarray
    phases: str


def stick_friction(w):
    """The friction coefficient from which a contact without slip sticks."""
    return np.linalg.norm(np.linalg.solve(w[:2, :2], w[:2, 2]))


def resumed_slip(w, friction):
    """The direction in which slip starts from rest: W_tn - f W_tt u = lambda u with lambda > 0."""
    values, axes = np.linalg.eigh(w[:2, :2])
    pull = axes.T @ w[:2, 2]
    if friction == 0.0:
        return w[:2, 2] / np.linalg.norm(pull)

    def excess(rate):
        return np.linalg.norm(pull / (rate + friction * values)) - 1.0

    rate = brentq(excess, 0.0, np.linalg.norm(pull), xtol=1e-16, rtol=1e-15)
    direction = axes @ (pull / (rate + friction * values))
    return direction / np.linalg.norm(direction)


def one_contact(w, c, friction, restitution):
    """The path of an impact at one contact whose velocity c = (t1, t2, n) answers the impulse P as c + W P."""
    w, c = np.asarray(w, float), np.asarray(c, float)
    # Units in which speed and mobility are one.
    speed, mobility = np.linalg.norm(c), np.trace(w)
    if not c[2] < 0.0:
        return Path(c, np.zeros(3), "")
    path = _Path(w / mobility, c / speed, friction, restitution)
    path.follow()
    return Path(speed * path.c, speed / mobility * path.impulse, path.phases)


class _Path:
    """A path and where on it the contact is; `work` is what it has taken up, `most` the most so far."""

    def __init__(self, w, c, friction, restitution):
        self.w, self.c, self.friction, self.kept = w, c.copy(), friction, 1.0 - restitution * restitution
        self.impulse, self.work, self.most, self.phases = np.zeros(3), 0.0, 0.0, ""

    def follow(self):
        if np.hypot(*self.c[:2]) > 0.0:
            if not self.slip():
                return
            self.c[:2] = 0.0
        if stick_friction(self.w) <= self.friction:
            self.phases += "S"
            self.straight(-np.linalg.solve(self.w[:2, :2], self.w[:2, 2]))
            self.c[:2] = 0.0
        else:
            self.phases += "r"
            self.straight(-self.friction * resumed_slip(self.w, self.friction))

    def straight(self, tangential):
        """To the end with this tangential impulse for each normal one; the normal velocity grows."""
        force = np.append(tangential, 1.0)
        rate = self.w @ force
        # The work at c_n = 0: there it is the most where the contact still approaches, and back to it where it leaves.
        top = self.work + 0.5 * self.c[2] ** 2 / rate[2]
        if self.c[2] < 0.0:
            self.most = max(self.most, top)
        length = (np.sqrt(2.0 * rate[2] * max(top - self.kept * self.most, 0.0)) - self.c[2]) / rate[2]
        self.c = self.c + length * rate
        self.impulse = self.impulse + length * force

    def slip(self):
        """While it slips; whether the slip stops."""
        self.phases += "s"
        w, friction = self.w, self.friction
        start = np.hypot(*self.c[:2])
        # ln(slip / start), its direction, c_n, impulse, work.
        y = np.concatenate([[0.0, np.arctan2(self.c[1], self.c[0]), self.c[2]], self.impulse, [self.work]])

        def rates(_, y):
            u = np.array([np.cos(y[1]), np.sin(y[1])])
            force = np.array([-friction * u[0], -friction * u[1], 1.0])
            g1, g2, gn = w @ force
            slip = start * np.exp(y[0])
            return [u[0] * g1 + u[1] * g2, u[0] * g2 - u[1] * g1, slip * gn, *(slip * force), -slip * y[2]]

        def stops(_, y):
            return y[0] - STOPPED

        def turns(_, y):
            return y[2]

        def opens(_, y):
            return y[6] - self.kept * self.most

        stops.terminal = turns.terminal = opens.terminal = True
        stops.direction = opens.direction = -1.0
        approaches = True
        while True:
            turns.direction = 1.0 if approaches else -1.0
            events = [stops, turns] if approaches else [stops, turns, opens]
            found = solve_ivp(rates, (0.0, 1e9), y, "DOP853", events=events, rtol=1e-12, atol=1e-15)
            y = found.y[:, -1]
            at = next(number for number, times in enumerate(found.t_events) if len(times))
            if at == 1:
                y[2] = 0.0
                self.most = max(self.most, y[6]) if approaches else self.most
                approaches = not approaches
            if at != 1 or (not approaches and y[6] <= self.kept * self.most):
                break
        slip = start * np.exp(y[0])
        self.c = np.array([slip * np.cos(y[1]), slip * np.sin(y[1]), y[2]])
        self.impulse, self.work = y[3:6], y[6]
        return at == 0


def planar_contact(w, c, friction, restitution):
    """The same where nothing moves along t2: segments of constant rates, on which the work is a quadratic."""
    wtt, wtn, wnn = w[0, 0], w[0, 2], w[2, 2]
    ct, _, cn = c
    tangential = normal = work = most = 0.0
    kept = 1.0 - restitution**2
    while True:
        push = -np.sign(ct) * friction if ct else np.clip(-wtn / wtt, -friction, friction)
        sticks = not ct and abs(wtn) <= friction * wtt
        rate_t, rate_n = 0.0 if sticks else wtn + wtt * push, wnn + wtn * push
        stops = -ct / rate_t if ct * rate_t < 0.0 else np.inf
        turns = -cn / rate_n if cn * rate_n < 0.0 else np.inf
        # work - c_n N - rate N^2 / 2 = kept most
        root = cn * cn + 2.0 * rate_n * (work - kept * most)
        opens = 2.0 * (work - kept * most) / (cn + np.sqrt(root)) if cn >= 0.0 and root >= 0.0 and most else np.inf
        length = min(stops, turns, opens)
        tangential, normal, work = (
            tangential + push * length,
            normal + length,
            work - (cn + 0.5 * rate_n * length) * length,
        )
        ct = 0.0 if length == stops else ct + rate_t * length
        cn = 0.0 if length == turns else cn + rate_n * length
        most = max(most, work)
        if length == opens or (length == turns and rate_n > 0.0 and work <= kept * most):
            return np.array([ct, 0.0, cn]), np.array([tangential, 0.0, normal])


def rows(positions, frames):
    """G, (3n, 6): contact velocities (t1, t2, n), the rows of frames, of a twist (velocity, angular velocity)."""
    found = [np.hstack([axes, np.cross(position, axes)]) for position, axes in zip(positions, frames, strict=True)]
    return np.vstack(found)


def delassus(mass, inertia, g):
    """W = G M^-1 G^T."""
    return g[:, :3] @ g[:, :3].T / mass + g[:, 3:] @ np.linalg.solve(inertia, g[:, 3:].T)


class Mechanism(NamedTuple):
    """What answers impulses P with contact velocities c + W P and does not move meanwhile; its state is P."""

    w: np.ndarray
    c: np.ndarray

    def mobility(self):
        return self.w.diagonal()[2::3].max()

    def start(self):
        return np.zeros(len(self.c))

    def velocities(self, state):
        return (self.c + self.w @ state).reshape(-1, 3)

    def rates(self, state, forces):
        return forces.ravel()


def crossed(a, b):
    """As numpy's cross product to the last bit, which takes four times as long for few vectors."""
    one, two = [1, 2, 0], [2, 0, 1]
    return a[..., one] * b[..., two] - a[..., two] * b[..., one]


class MovingBody(NamedTuple):
    """A free body on a floor with the normal z; its state are twist and attitude (the matrix)."""

    mass: float
    inertia: np.ndarray
    positions: np.ndarray
    twist: np.ndarray

    def mobility(self):
        g = rows(self.positions, [np.eye(3)] * len(self.positions))
        return delassus(self.mass, self.inertia, g).diagonal()[2::3].max()

    def start(self):
        return np.concatenate([self.twist, np.eye(3).ravel()])

    def velocities(self, state):
        return state[:3] + crossed(state[3:6], self.positions @ state[6:].reshape(3, 3).T)

    def rates(self, state, forces):
        attitude, turning = state[6:].reshape(3, 3), state[3:6]
        inertia = attitude @ self.inertia @ attitude.T
        moment = crossed(self.positions @ attitude.T, forces).sum(0) - crossed(turning, inertia @ turning)
        x, y, z = turning
        spin = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        return np.concatenate([forces.sum(0) / self.mass, np.linalg.solve(inertia, moment), (spin @ attitude).ravel()])


LOADS, UNLOADS, OPEN = range(3)

STEEP = 1e-4
"""The restitution of a spring on which there is none."""


class OnSprings(NamedTuple):
    """After an impact on springs: contact velocities (n, 3), the system's state, how often each contact closed again
    after it had opened, and whether it is over.
    """

    velocities: np.ndarray
    state: np.ndarray
    closed_again: np.ndarray
    over: bool


def on_springs(
    system,
    frictions,
    restitutions,
    stiffness,
    damping=0.0,
    *,
    gaps=False,
    distances=0.0,
    regularisation=1e-6,
    tolerance=1e-9,
    longest=1e3,
):
    """Contacts that touch press on springs until all have opened or press no more.

    Contact i has the stiffness K_i: F = K d while d grows, and back along the line to (1 - e^2) of the deepest d.
    `damping` adds a dashpot. A contact that has opened closes again as soon as it approaches, with d from zero; with
    `gaps`, only once it has come back. Contacts with `distances` are open at first, and close once they have come
    nearer by them, in time as it counts here. `regularisation` is a part of the greatest contact speed; `longest`
    counts in sqrt(1 / (K W)).
    """
    state = system.start()
    before = system.velocities(state)
    count = len(before)
    frictions, restitutions, stiffness, damping = (
        np.broadcast_to(np.asarray(each, float), count) for each in (frictions, restitutions, stiffness, damping)
    )
    speed = np.linalg.norm(before, axis=1).max()
    slip_scale = regularisation * speed
    mobility = system.mobility()
    unit = np.sqrt(1.0 / (np.min(stiffness) * mobility))
    # Without restitution the way back is steep: the depth stays, and the force is what holds it there.
    kept = 1.0 - np.maximum(restitutions, STEEP) ** 2
    distances = np.broadcast_to(distances, count)
    modes, deepest, again = np.where(distances > 0.0, OPEN, LOADS), np.zeros(count), np.zeros(count, int)
    y, time, end = np.concatenate([-distances, state]), 0.0, longest * unit

    def normal_forces(y, c):
        depth = y[:count]
        floor = kept * deepest
        back = stiffness * deepest * (depth - floor) / np.where(deepest > floor, deepest - floor, 1.0)
        force = np.where(modes == LOADS, stiffness * depth, back) - damping * c[:, 2]
        return np.where(modes == OPEN, 0.0, np.maximum(force, 0.0))

    def rates(_, y):
        c = system.velocities(y[count:])
        normal = normal_forces(y, c)
        friction = -(frictions * normal / np.sqrt(c[:, 0] ** 2 + c[:, 1] ** 2 + slip_scale**2))[:, None] * c[:, :2]
        sinks = -c[:, 2] if gaps else np.where(modes == OPEN, 0.0, -c[:, 2])
        return np.concatenate([sinks, system.rates(y[count:], np.column_stack([friction, normal]))])

    def speeds(y):
        return system.velocities(y[count:])[:, 2]

    def event(which, direction):
        which.terminal, which.direction = True, direction
        return which

    def events_of(number):
        """What changes the mode of a contact, and the mode it then has."""

        def speed_of(_, y):
            return speeds(y)[number]

        if modes[number] == LOADS:
            if damping[number]:
                return [(event(lambda _, y: y[number], -1.0), OPEN)]
            return [(event(speed_of, 1.0), UNLOADS)]
        if modes[number] == UNLOADS:
            low, high = kept[number] * deepest[number], deepest[number]
            return [
                (event(lambda _, y: y[number] - low, -1.0), OPEN),
                (event(lambda _, y: y[number] - high, 1.0), LOADS),
            ]
        return [(event(lambda _, y: y[number], 1.0) if gaps else event(speed_of, -1.0), LOADS)]

    over = False
    while time < end and not over:
        changes = [(number, *change) for number in range(count) for change in events_of(number)]

        def quiet(_, y):
            c = system.velocities(y[count:])
            pressing = np.max(normal_forces(y, c) / np.sqrt(stiffness)) * np.sqrt(mobility) / speed
            return max(pressing, -c[:, 2].min() / speed) - 1e-7

        over = time > 0.0 and quiet(time, y) <= 0.0
        if over:
            break
        found = solve_ivp(
            rates,
            (time, end),
            y,
            "Radau",
            events=[event(quiet, -1.0), *(change[1] for change in changes)],
            rtol=tolerance,
            atol=tolerance * np.concatenate([np.full(count, speed * unit), np.maximum(np.abs(y[count:]), speed)]),
        )
        time, y = found.t[-1], found.y[:, -1]
        over = len(found.t_events[0]) > 0
        for (number, _, mode), times in zip(changes, found.t_events[1:], strict=True):
            if not len(times):
                continue
            if mode == UNLOADS:
                deepest[number] = y[number]
            if mode == OPEN or modes[number] == OPEN:
                y[number], deepest[number] = 0.0, 0.0
            again[number] += modes[number] == OPEN
            modes[number] = mode
    return OnSprings(system.velocities(y[count:]), y[count:], again, over)
