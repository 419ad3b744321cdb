"""What the next touchdown costs and how exact it is, with scipy's DOP853 beside it.

    python benchmarks/bench_motion.py

A row prints the median time of a call in microseconds and that of the slowest tenth, the relative errors of the time
and of the twist at the touchdown, and how many times as long DOP853 takes with events for whatever may happen next, at
the loosest of its tolerances 1e-3, 1e-4, ... that keeps both errors within 1e-9. DOP853 is given the least there is to
integrate: the angle, its rate and the slip. The truth of the golden falls is their 40-digit energy integral, that of
the other rows DOP853 at 1e-13. The next touchdown is called with its own default tolerance.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from time import perf_counter_ns
from typing import Any, NamedTuple

from scipy.integrate import solve_ivp

from impact_predictor.mechanics.motion import PlanarState, next_touchdown
from impact_predictor.mechanics.types import Vector

FALLS = Path(__file__).resolve().parents[1] / "test/mechanics/golden/motion.json"
PLATE = ((-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3))
GRAVITY = 9.81
CALLS = 2000
PEER_CALLS = 15
WANTED = 1e-9

Touchdown = tuple[float, float, float, float]
"""Time in s, and the twist: velocity in m/s and angular velocity in rad/s."""
Event = Callable[[float, Any], float]


class Case(NamedTuple):
    """Arguments of `next_touchdown`."""

    state: PlanarState
    points: tuple[Vector, ...]
    stance: int | None
    rho_squared: float
    friction: float


def standing(point: Vector, angle: float, omega: float, slip: float) -> PlanarState:
    """A body that stands on a point, turns about it and slips."""
    sine, cosine = math.sin(angle), math.cos(angle)
    x, y = cosine * point[0] - sine * point[1], sine * point[0] + cosine * point[1]
    return PlanarState(0.0, -y, angle, slip + omega * y, -omega * x, omega)


def cases() -> Iterator[tuple[str, Case, Touchdown | None]]:
    """What is timed, and the touchdown where it is known."""
    for fall in json.loads(FALLS.read_text())["falls"]:
        a, h, rho_squared, _, angle, omega, time, rate = (float(value) for value in fall.values())
        points = ((-a, -h), (a, -h))
        name = f"golden fall, a = {a}, h = {h}, phi0 = {angle}, omega0 = {omega}"
        end = time, -rate * h, rate * a, rate
        yield name, Case(standing(points[0], angle, omega, 0.0), points, 0, rho_squared, math.inf), end
    fallen = standing(PLATE[0], 0.2, -0.5, 0.0)
    yield "plate, turning inside the friction cone", Case(fallen, PLATE, 0, 0.1, 1.0), None
    yield "plate, slip starts on the way", Case(standing(PLATE[0], 0.2, 0.0, 0.0), PLATE, 0, 0.1, 0.2), None
    yield "plate, slip stops on the way", Case(standing(PLATE[0], 0.2, 0.0, 0.02), PLATE, 0, 0.1, 1.0), None
    yield "plate, slips all the way", Case(standing(PLATE[0], 0.2, -0.5, 1.0), PLATE, 0, 0.1, 0.2), None
    yield "plate, thrown", Case(PlanarState(0.0, 1.0, 0.2, 1.0, 0.5, 6.0), PLATE, None, 0.1, 0.2), None


class Peer:
    """The same motion by scipy's DOP853, phase after phase; a phase has its own equations and events."""

    def __init__(self, case: Case, tolerance: float) -> None:
        self.case, self.tolerance = case, tolerance

    def heights(self) -> list[Event]:
        """Of each point that may touch."""
        case = self.case
        base = case.points[case.stance] if case.stance is not None else (0.0, 0.0)

        def event(x: float, y: float) -> Event:
            if case.stance is None:
                return lambda _, s: s[1] + x * math.sin(s[2]) + y * math.cos(s[2])
            return lambda _, s: x * math.sin(s[0]) + y * math.cos(s[0])

        return [event(x - base[0], y - base[1]) for k, (x, y) in enumerate(case.points) if k != case.stance]

    def run(self, rates: Callable[[float, Any], list[float]], start: list[float], events: list[Event]) -> Any:
        """Until the first event; its number and the time and state there."""
        for event in events:
            event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        tight = {"rtol": self.tolerance, "atol": 1e-2 * self.tolerance}
        run = solve_ivp(rates, (0.0, 10.0), start, method="DOP853", events=events, **tight)
        return next(k for k, times in enumerate(run.t_events) if len(times)), run.t[-1], run.y[:, -1]

    def touchdown(self) -> Touchdown:
        """The time and the twist at the next touchdown."""
        case = self.case
        if case.stance is None:
            _, time, s = self.run(lambda _, s: [s[3], s[4], s[5], 0.0, -GRAVITY, 0.0], [*case.state], self.heights())
            return time, s[3], s[4], s[5]
        px, py = case.points[case.stance]

        def arm(angle: float) -> Vector:
            sine, cosine = math.sin(angle), math.cos(angle)
            return py * sine - px * cosine, -px * sine - py * cosine

        angle, omega = case.state.angle, case.state.omega
        slip, time = case.state.vx + omega * arm(angle)[1], 0.0
        drag = math.copysign(case.friction, slip) if abs(slip) > 1e-12 else 0.0
        sticks = not drag
        for _ in range(10):

            def turning(_: float, s: Any) -> list[float]:
                x, y = arm(s[0])
                return [s[1], -GRAVITY * x / (case.rho_squared + x * x + y * y)]

            def sliding(_: float, s: Any, drag: float = drag) -> list[float]:
                x, y = arm(s[0])
                square, lever = s[1] * s[1], x + drag * y
                alpha = (square * y - GRAVITY) * lever / (case.rho_squared + x * lever)
                load = alpha * x - square * y + GRAVITY
                return [s[1], alpha, -drag * load + alpha * y + square * x]

            def margin(side: float) -> Event:
                def inside(_: float, s: Any) -> float:
                    x, y = arm(s[0])
                    alpha = -GRAVITY * x / (case.rho_squared + x * x + y * y)
                    push, load = -alpha * y - s[1] * s[1] * x, alpha * x - s[1] * s[1] * y + GRAVITY
                    return case.friction * load - side * push

                return inside

            heights, sides = self.heights(), (1.0, -1.0)
            state = [angle, omega]
            if sticks and case.friction < math.inf:
                outside = [side for side in sides if margin(side)(0.0, state) < 0.0]
                sticks, drag = not outside, -outside[0] * case.friction if outside else drag
            if sticks:
                events = [] if case.friction == math.inf else [margin(side) for side in sides]
                which, part, (angle, omega) = self.run(turning, state, heights + events)
            else:
                side = math.copysign(1.0, drag)
                which, part, (angle, omega, slip) = self.run(
                    lambda t, s, drag=drag: sliding(t, s, drag),
                    [*state, slip],
                    [*heights, lambda _, s, side=side: side * s[2], lambda _, s: GRAVITY - s[1] * s[1] * arm(s[0])[1]],
                )
            time += part
            x, y = arm(angle)
            if which < len(heights):
                return time, slip - omega * y, omega * x, omega
            sticks, slip = not sticks, 0.0
        raise AssertionError("the phases do not end")


def errors(found: Touchdown, truth: Touchdown) -> tuple[float, float]:
    """Relative, of the time and of the twist."""
    twist = math.dist(found[1:], truth[1:]) / math.hypot(*truth[1:])
    return abs(found[0] - truth[0]) / truth[0], twist


def timed(call: Callable[[], object], calls: int) -> list[float]:
    """Microseconds of each call, in ascending order."""
    times = []
    for _ in range(calls):
        start = perf_counter_ns()
        call()
        times.append((perf_counter_ns() - start) * 1e-3)
    return sorted(times)


def main() -> None:
    """Print a row for every case."""
    print(f"{'median':>8}{'90 %':>8}{'time':>10}{'twist':>10}{'DOP853':>10}{'rtol':>8}{'ratio':>7}")
    print(f"{'us':>8}{'us':>8}{'error':>10}{'error':>10}{'us':>10}")
    for name, case, known in cases():
        truth = known or Peer(case, 1e-13).touchdown()
        fall = next_touchdown(*case)
        time_error, twist_error = errors((fall.time, *fall.state[3:]), truth)
        tolerances = (10.0**-digits for digits in range(3, 14))
        peer = next(p for p in (Peer(case, t) for t in tolerances) if max(errors(p.touchdown(), truth)) <= WANTED)
        slow = timed(peer.touchdown, PEER_CALLS)[PEER_CALLS // 2]
        times = timed(lambda case=case: next_touchdown(*case), CALLS)
        median = times[CALLS // 2]
        print(
            f"{median:8.1f}{times[CALLS * 9 // 10]:8.1f}{time_error:10.1e}{twist_error:10.1e}"
            f"{slow:10.0f}{peer.tolerance:8.0e}{slow / median:7.0f}   {name}"
        )


if __name__ == "__main__":
    main()
