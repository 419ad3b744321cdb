"""Impacts of bodies that also slip across the impact plane."""

from __future__ import annotations

import math
import random
import subprocess
import sys

import numpy as np
import pytest

from impact_predictor import Contact, Flag, Mode, Twist, TwoPointBody, Validity, solve_impact
from impact_predictor.mechanics import transverse_step
from impact_predictor.mechanics.transverse import Transverse, TransverseOutcome
from impact_predictor.mechanics.transverse import solve_transverse_impact as solve

FINE = 1e-6
"""Tolerance of a step."""

CLOSE = 1e-5
"""Of the speeds: ten times as much for the steps of a path."""

Case = tuple[TwoPointBody, Twist, Transverse]


def rows(contact: Contact) -> list[list[float]]:
    """How the velocities (vx, vy, omega, vz, roll, yaw) make those of a contact along normal, tangent and z."""
    (nx, ny), arm = contact.normal, (contact.x, contact.y, 0.0)
    made = []
    for way in ((nx, ny, 0.0), (ny, -nx, 0.0), (0.0, 0.0, 1.0)):
        moment = np.cross(arm, way)
        made.append([way[0], way[1], moment[2], way[2], moment[0], moment[1]])
    return made


class Body:
    """A case as a rigid body in space: rows of its contacts (old contact first), inverse masses of its velocities."""

    def __init__(self, body: TwoPointBody, twist: Twist, across: Transverse) -> None:
        contacts = [contact for contact in (body.old, body.new) if contact is not None]
        self.rows = np.array([row for contact in contacts for row in rows(contact)])
        self.velocities = np.array([*twist, across.velocity, across.roll, across.yaw])
        inertias = (body.mass, body.mass, body.inertia, body.mass, across.roll_inertia, across.yaw_inertia)
        self.mobilities = 1.0 / np.array(inertias)
        self.frictions = [contact.friction for contact in contacts]
        self.restitution = body.new.restitution
        self.speed = float(np.abs(self.rows @ self.velocities).sum())

    def energy(self, velocities: np.ndarray) -> float:
        moves = self.mobilities > 0.0
        return float(0.5 * (velocities[moves] ** 2 / self.mobilities[moves]).sum())

    def stepped(self, steps: int) -> np.ndarray:
        """The velocities after the impact, with the normal impulse at B growing in small equal steps.

        In each the other impulses are such that at its end an old contact neither approaches nor pulls, and that both
        slip against their friction or rest within it (Gauss, Seidel).
        """
        c = self.rows @ self.velocities
        w = (self.rows * self.mobilities) @ self.rows.T
        step, impulse, work = -c[3] / w[3, 3] / steps, 0.0, 0.0
        total, p, target = np.zeros(6), [0.0] * 6, math.inf
        w_rows = w.tolist()
        while impulse < target and (target == math.inf or work > 0.0):
            c = c.tolist()
            p[3] = step
            for _ in range(500):
                last = list(p)
                for normal in (3, 0):
                    if normal == 0:
                        p[0] = max(0.0, p[0] - (c[0] + dot(w_rows[0], p)) / w_rows[0][0])
                    t, z = normal + 1, normal + 2
                    stiff = max(w_rows[t][t], w_rows[z][z])
                    pt, pz = p[t] - (c[t] + dot(w_rows[t], p)) / stiff, p[z] - (c[z] + dot(w_rows[z], p)) / stiff
                    most, size = self.frictions[normal // 3] * p[normal], math.hypot(pt, pz)
                    cut = most / size if size > most else 1.0
                    p[t], p[z] = cut * pt, cut * pz
                if max(abs(one - other) for one, other in zip(p, last, strict=True)) < 1e-9 * step:
                    break
            now = np.array(c) + w @ p
            work -= 0.5 * step * (c[3] + now[3])
            total, impulse, c = total + p, impulse + step, now
            if c[3] >= 0.0 and target == math.inf:
                target = (1.0 + self.restitution) * impulse
        return self.velocities + self.mobilities * (self.rows.T @ total)


def solve_transverse_impact(
    body: TwoPointBody, twist: Twist, across: Transverse, tolerance: float = FINE
) -> TransverseOutcome:
    return solve(body, twist, across, tolerance)


def dot(u: list[float], v: list[float]) -> float:
    return sum(a * b for a, b in zip(u, v, strict=True))


def velocities(outcome: TransverseOutcome) -> np.ndarray:
    return np.array([*outcome.outcome.twist, *outcome.transverse[:3]])


def random_case(source: random.Random, most: float = 1.2) -> Case:
    """A body on a flat floor, a step or a wedge, which turns about A or slips there, and which nothing can jam.

    Where f_A |x_A y_A| exceeds rho^2 + x_A^2 the path may have several answers (Painleve), and steps may find another.
    """
    uniform = source.uniform
    while True:
        old, new = (-uniform(0.05, 1.0), -uniform(0.05, 1.0)), (uniform(0.05, 1.0), -uniform(0.05, 1.0))
        angle = source.choice([0.0, 0.0, uniform(-1.0, 1.0)])
        if source.random() < 0.5:
            new = (new[0], old[1])
        radius = uniform(0.2, 1.0)
        stood = Contact(*old, uniform(0.0, most))
        restitution = source.choice([0.0, uniform(0.1, 1.0)])
        struck = Contact(*new, uniform(0.0, most), (-math.sin(angle), math.cos(angle)), restitution)
        omega, slip = uniform(-2.0, 2.0), source.choice([0.0, uniform(-1.0, 1.0)])
        twist = Twist(omega * old[1] + slip, -omega * old[0], omega)
        inertias = [source.choice([math.inf, uniform(0.05, 1.0)]) for _ in range(2)]
        roll, yaw = (uniform(-1.0, 1.0) if inertia < math.inf else 0.0 for inertia in inertias)
        velocity = uniform(-1.0, 1.0) if source.random() < 0.7 else yaw * old[0] - roll * old[1]
        body, across = TwoPointBody(1.0, radius**2, stood, struck), Transverse(velocity, roll, yaw, *inertias)
        approach = Body(body, twist, across).rows[3] @ [*twist, *across[:3]]
        if stood.friction * abs(old[0] * old[1]) < radius**2 + old[0] ** 2 and approach < -0.05:
            return body, twist, across


def cases(count: int, seed: int = 0) -> list[Case]:
    source = random.Random(seed)
    return [random_case(source) for _ in range(count)]


def test_without_slip_across_the_plane_the_planar_law_answers_to_the_last_bit() -> None:
    for body, twist, _ in cases(300):
        expected = solve_impact(body, twist)
        for still in (Transverse(0.0), Transverse(0.0, 0.0, 0.0, 0.3, 0.2)):
            assert solve_transverse_impact(body, twist, still) == TransverseOutcome(expected, still, (0.0, 0.0))


def test_who_does_not_ask_for_it_does_not_load_it() -> None:
    code = (
        "import sys, impact_predictor; impact_predictor.solve_impact; print([m for m in sys.modules if 'transv' in m])"
    )
    loaded = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert loaded.stdout.strip() == "[]"


def test_a_little_slip_across_the_plane_changes_little() -> None:
    """1e-4 of it, in bodies that jam too; the worst of the few that change their course is 0.01."""
    source = random.Random(5)
    changes, jams, others = [], 0, 0
    for _ in range(1500):
        body, twist, across = random_case(source)
        if source.random() < 0.5:
            assert body.old is not None
            body = body._replace(old=body.old._replace(friction=source.uniform(1.0, 3.0)))
        expected = solve_impact(body, twist)
        slight = across._replace(velocity=1e-4 * across.velocity, roll=1e-4 * across.roll, yaw=1e-4 * across.yaw)
        answer = solve_transverse_impact(body, twist, slight)
        jams += bool(answer.outcome.flags & expected.flags & Flag.JAMMED)
        others += bool((answer.outcome.flags ^ expected.flags) & Flag.JAMMED)
        changes.append(max(abs(one - other) for one, other in zip(answer.outcome.twist, expected.twist, strict=True)))
    assert jams >= 20
    assert others <= 2
    assert np.percentile(changes, 99) < 1e-3
    assert max(changes) < 0.02


@pytest.mark.parametrize("ratio", [0.3, 1.0, 2.0])
@pytest.mark.parametrize("roll_inertia", [math.inf, 0.1])
def test_a_single_contact_below_the_mass_centre_slips_along_a_power_law(ratio: float, roll_inertia: float) -> None:
    """d c_t / d c_z = (w_t c_t) / (w_z c_z), so that c_t ~ c_z^(w_t / w_z), whatever the normal impulse."""
    body = TwoPointBody(2.0, 0.2, None, Contact(0.0, -0.3, 0.1))
    answer = solve_transverse_impact(
        body, Twist(1.0, -2.0, 0.0), Transverse(ratio, roll_inertia=roll_inertia), tolerance=1e-8
    )
    after = answer.outcome.twist
    slip = after.vx + 0.3 * after.omega
    across = answer.transverse.velocity - 0.3 * answer.transverse.roll
    w_t, w_z = 0.5 + 0.09 / 0.2, 0.5 + 0.09 / roll_inertia
    assert slip == pytest.approx((across / ratio) ** (w_t / w_z), abs=1e-7)
    (_, (normal, tangential)), lateral = answer.outcome.impulses, answer.impulses[1]
    assert normal == pytest.approx(4.0, abs=1e-12)
    # The path bends, so that the whole impulse of friction is a little less than f N.
    assert 0.95 * 0.1 * normal < math.hypot(tangential, lateral) <= 0.1 * normal * (1.0 + 1e-9)


@pytest.mark.parametrize("friction", [0.05, 10.0])
def test_a_ball_slips_straight_on_or_leaves_without_slip(friction: float) -> None:
    """All directions are alike for it: friction f N against the slip, or 2/7 of the slip's momentum if that is less."""
    mass, radius, restitution, slip = 0.5, 0.1, 0.6, (3.0, -4.0)
    inertia = 0.4 * mass * radius**2
    body = TwoPointBody(mass, inertia, None, Contact(0.0, -radius, friction, restitution=restitution))
    answer = solve_transverse_impact(
        body, Twist(slip[0], -2.0, 0.0), Transverse(slip[1], roll_inertia=inertia, yaw_inertia=inertia)
    )
    normal = mass * 2.0 * (1.0 + restitution)
    push = min(friction * normal, 2.0 / 7.0 * mass * 5.0) / 5.0
    twist, across = answer.outcome.twist, answer.transverse
    assert (twist.vx, across.velocity) == pytest.approx([part * (1.0 - push / mass) for part in slip], abs=CLOSE)
    assert twist.vy == pytest.approx(2.0 * restitution)
    assert answer.outcome.mode is Mode.FLIGHT
    if friction > 1.0:
        assert answer.outcome.segments == ("O+", "OS", "OS")
        assert twist.vx + radius * twist.omega == pytest.approx(0.0, abs=CLOSE)
        assert across.velocity - radius * across.roll == pytest.approx(0.0, abs=CLOSE)


@pytest.mark.slow
def test_the_path_is_that_of_a_body_in_space_which_is_struck_in_small_steps() -> None:
    """1000 steps to the end of compression err by 1e-4 of the speeds in the median, and by 1e-3 at the worst."""
    modes, errors = set(), []
    for body, twist, across in cases(30, seed=2):
        space = Body(body, twist, across)
        answer = solve_transverse_impact(body, twist, across)
        difference = space.rows @ (velocities(answer) - space.stepped(1000))
        errors.append(float(np.abs(difference).max()) / space.speed)
        modes.add(answer.outcome.mode)
        assert not answer.outcome.flags & (Flag.LAST_RESORT | Flag.JAMMED)
    assert np.median(errors) < 3e-4
    assert max(errors) < 2e-3
    assert len(modes) >= 4


def test_the_answer_converges_with_the_tolerance() -> None:
    exact = [velocities(solve_transverse_impact(*case, tolerance=1e-7)) for case in cases(40, seed=3)]
    for tolerance in (1e-3, 1e-4, 1e-5):
        errors = []
        for case, best in zip(cases(40, seed=3), exact, strict=True):
            space = Body(*case)
            answer = velocities(solve_transverse_impact(*case, tolerance=tolerance))
            errors.append(float(np.abs(space.rows @ (answer - best)).max()) / space.speed)
        assert max(errors) < 10.0 * tolerance
        assert np.median(errors) < 0.5 * tolerance


def test_implicit_steps_follow_the_same_path(monkeypatch: pytest.MonkeyPatch) -> None:
    """All steps of a path, not only those after its first explicit ones."""
    explicit = [velocities(solve_transverse_impact(*case, tolerance=1e-5)) for case in cases(40, seed=9)]
    monkeypatch.setattr(transverse_step, "EXPLICIT", 0)
    for case, expected in zip(cases(40, seed=9), explicit, strict=True):
        space = Body(*case)
        implicit = velocities(solve_transverse_impact(*case, tolerance=1e-5))
        assert np.abs(space.rows @ (implicit - expected)).max() < 2e-4 * space.speed


def test_a_body_that_yaws_far_more_easily_than_it_moves_needs_no_more_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """A million times as easily; explicit steps alone would be lost after hundreds of them."""
    body = TwoPointBody(1.0, 0.1, Contact(-0.5, -0.3, 0.2), Contact(0.5, -0.3, 0.2))
    twist = body.turning(-1.0)
    case = body, twist._replace(vx=twist.vx + 2.0), Transverse(1.0, yaw_inertia=1e-6)
    answer = solve(*case)
    assert not answer.outcome.flags & Flag.LAST_RESORT
    assert answer.outcome.twist == pytest.approx(solve_transverse_impact(*case).outcome.twist, abs=1e-4)
    monkeypatch.setattr(transverse_step, "EXPLICIT", 10**6)
    assert solve(*case).outcome.flags & Flag.LAST_RESORT


@pytest.mark.parametrize("velocity", [0.9, 1e-7])
def test_a_jam_ends_by_a_tangential_impact_at_the_old_contact(velocity: float) -> None:
    """A plate that slips backwards; with hardly any slip across the plane it does what the planar law says."""
    body = TwoPointBody(1.0, 1.81 / 12.0, Contact(-0.5, -0.45, 5.0), Contact(0.5, -0.45, 5.0))
    twist = body.turning(-1.0)
    twist = twist._replace(vx=twist.vx - 0.7)
    outcome = solve_transverse_impact(body, twist, Transverse(velocity)).outcome
    assert outcome.flags & Flag.JAMMED
    assert not outcome.flags & Flag.LAST_RESORT
    assert outcome.energy_lost > 0.0
    if velocity < 1e-6:
        assert outcome.twist == pytest.approx(solve_impact(body, twist).twist, abs=1e-6)


def test_momentum_energy_and_friction_are_kept() -> None:
    for body, twist, across in cases(300, seed=4):
        space = Body(body, twist, across)
        answer = solve_transverse_impact(body, twist, across)
        after = velocities(answer)
        pairs = zip(answer.outcome.impulses, answer.impulses, strict=True)
        impulses = np.array([part for (normal, tangential), z in pairs for part in (normal, tangential, z)])
        expected = space.velocities + space.mobilities * (space.rows.T @ impulses)
        assert after == pytest.approx(expected, abs=1e-9)
        for k, friction in enumerate(space.frictions):
            normal, tangential, lateral = impulses[3 * k : 3 * k + 3]
            assert normal >= -CLOSE * space.speed
            assert math.hypot(tangential, lateral) <= friction * normal + CLOSE * space.speed
        lost = space.energy(space.velocities) - space.energy(after)
        scale = body.mass * space.speed**2
        assert lost >= -CLOSE * scale
        assert answer.outcome.energy_lost == pytest.approx(lost, abs=CLOSE * scale)
        contacts = space.rows @ after
        assert contacts[0] >= -CLOSE * space.speed
        assert contacts[3] >= -CLOSE * space.speed


def test_sides_may_be_swapped() -> None:
    for body, twist, across in cases(100, seed=6):
        answer = solve_transverse_impact(body, twist, across)
        swapped = across._replace(velocity=-across.velocity, roll=-across.roll, yaw=-across.yaw)
        other = solve_transverse_impact(body, twist, swapped)
        assert velocities(other)[:3] == pytest.approx(velocities(answer)[:3], abs=CLOSE)
        assert velocities(other)[3:] == pytest.approx(-velocities(answer)[3:], abs=CLOSE)

        assert body.old is not None
        old, new = (one._replace(x=-one.x, normal=(-one.normal[0], one.normal[1])) for one in (body.old, body.new))
        mirrored = solve_transverse_impact(
            body._replace(old=old, new=new),
            Twist(-twist.vx, twist.vy, -twist.omega),
            across._replace(yaw=-across.yaw),
        )
        signs = np.array([-1.0, 1.0, -1.0, 1.0, 1.0, -1.0])
        assert velocities(mirrored) == pytest.approx(signs * velocities(answer), abs=CLOSE)


def test_units_do_not_matter() -> None:
    for body, twist, across in cases(50, seed=7):
        answer = velocities(solve_transverse_impact(body, twist, across))
        length, mass, time = 1e3, 1e-2, 1e-4
        assert body.old is not None
        old, new = (one._replace(x=one.x * length, y=one.y * length) for one in (body.old, body.new))
        scaled = TwoPointBody(body.mass * mass, body.inertia * mass * length**2, old, new)
        speed, rate, inertia = length / time, 1.0 / time, mass * length**2
        moved = Twist(twist.vx * speed, twist.vy * speed, twist.omega * rate)
        side = Transverse(
            across.velocity * speed,
            across.roll * rate,
            across.yaw * rate,
            across.roll_inertia * inertia,
            across.yaw_inertia * inertia,
        )
        units = np.array([speed, speed, rate, speed, rate, rate])
        assert velocities(solve_transverse_impact(scaled, moved, side)) / units == pytest.approx(answer, abs=CLOSE)


def test_segments_tell_the_states_with_the_sign_of_the_slip_in_the_plane() -> None:
    """A cube that lands on its face while it slides along its edge: the face slides, and the back edge lifts again."""
    cube = TwoPointBody(0.37, 8.1e-4, Contact(-0.052, -0.052, 0.18), Contact(0.052, -0.052, 0.18, restitution=0.125))
    twist = cube.turning(-8.0)
    answer = solve_transverse_impact(cube, twist, Transverse(0.3, yaw_inertia=8.1e-4))
    assert answer.outcome.mode is Mode.BACK_PIVOT
    assert answer.outcome.segments == ("++", "++")
    assert 0.0 < answer.transverse.velocity < 0.3
    assert answer.outcome.law == "path"


def test_a_contact_at_rest_slips_when_the_other_pulls_it_across() -> None:
    """A stands still with little friction while B slips across the plane, and yaws the body out of A's hold."""
    body = TwoPointBody(1.0, 0.1, Contact(-0.3, -0.2, 0.05), Contact(0.5, -0.2, 0.8))
    turning = body.turning(-1.0)
    across = Transverse(-0.3 * 2.0, 0.0, 2.0, math.inf, 0.02)
    answer = solve_transverse_impact(body, turning, across)
    space = Body(body, turning, across)
    assert (space.rows @ space.velocities)[2] == pytest.approx(0.0)
    assert abs((space.rows @ velocities(answer))[2]) > 0.01
    assert velocities(answer) == pytest.approx(space.stepped(2000), abs=5e-3)


def test_where_rigid_theory_is_too_simple_the_outcome_says_so() -> None:
    """Also where the planar law answers; the limits are those that are given."""
    flat = Contact(-0.5, -0.004, 0.3), Contact(0.5, -0.004, 0.3)
    rod = TwoPointBody(1.0, 1.0 / 12.0, *flat)
    for across in (Transverse(0.5), Transverse(0.0)):
        for omega, slow in ((-1.0, False), (-1e-3, True)):
            flags = solve(rod, rod.turning(omega), across).outcome.flags
            assert bool(flags & Flag.THIN_BODY)
            assert bool(flags & Flag.SLOW_IMPACT) is slow
        thick = solve(rod, rod.turning(-1e-3), across, FINE, Validity(slenderness=0.007, gravity=0.0)).outcome.flags
        assert not thick & (Flag.THIN_BODY | Flag.SLOW_IMPACT)


STILL = TwoPointBody(1.0, 0.1, Contact(-0.3, -0.2, 0.3), Contact(0.3, -0.2, 0.3))


@pytest.mark.parametrize(
    ("twist", "flags"), [(Twist(0.3, -1.0, 0.0), Flag.BOTH_STRUCK), (STILL.turning(1.0), Flag.NONE)]
)
def test_where_both_contacts_or_none_are_struck_the_planar_law_answers_for_the_plane(twist: Twist, flags: Flag) -> None:
    across = Transverse(0.5)
    answer = solve_transverse_impact(STILL, twist, across)
    assert answer == TransverseOutcome(solve_impact(STILL, twist), across, (0.0, 0.0))
    assert flags in answer.outcome.flags


@pytest.mark.parametrize(
    "across",
    [
        Transverse(math.nan),
        Transverse(0.1, math.inf),
        Transverse(0.1, 0.0, -math.inf),
        Transverse(0.1, roll_inertia=0.0),
        Transverse(0.1, yaw_inertia=-1.0),
        Transverse(0.1, yaw_inertia=math.nan),
    ],
)
def test_motion_that_no_body_has_is_flagged(across: Transverse) -> None:
    answer = solve_transverse_impact(STILL, STILL.turning(-1.0), across)
    assert answer.outcome.flags is Flag.INVALID_INPUT
    assert answer.outcome.mode is Mode.NO_IMPACT
    assert answer.outcome.twist == STILL.turning(-1.0)
    assert all(map(math.isfinite, answer.transverse[:3]))
    body = STILL._replace(mass=0.0)
    assert solve_transverse_impact(body, Twist(0.0, -1.0, -1.0), Transverse(0.5)).outcome.flags is Flag.INVALID_INPUT


def test_any_magnitude_has_an_answer_that_gains_no_energy() -> None:
    """Six decades up and down in every number; where the path is lost among them the planar law answers, flagged."""
    source = random.Random(8)

    def decades() -> float:
        return float(10.0 ** source.uniform(-6.0, 6.0))

    def signed() -> float:
        return source.choice([-1.0, 0.0, 1.0]) * decades()

    lost = 0
    for _ in range(1500):
        angle = source.choice([0.0, source.uniform(-3.0, 3.0)])
        old = Contact(-decades(), -decades(), source.choice([0.0, source.random(), 100.0 * source.random()]))
        new = Contact(
            decades(),
            source.choice([old.y, -decades()]),
            source.choice([0.0, source.random(), 100.0 * source.random()]),
            (-math.sin(angle), math.cos(angle)),
            source.choice([0.0, source.random()]),
        )
        body = TwoPointBody(decades(), decades(), source.choice([None, old, old]), new)
        omega = signed()
        twist = Twist(omega * old.y + signed(), -omega * old.x, omega)
        across = Transverse(signed(), signed(), signed(), decades(), source.choice([math.inf, decades()]))
        answer = solve_transverse_impact(body, twist, across)
        assert np.isfinite([*velocities(answer), *answer.impulses, answer.outcome.energy_lost]).all()
        if answer.outcome.flags & Flag.LAST_RESORT:
            lost += 1
            assert answer.transverse == across
        elif answer.outcome.mode is not Mode.NO_IMPACT and not answer.outcome.flags & Flag.BOTH_STRUCK:
            assert answer.outcome.energy_lost >= -1e-4 * body.mass * Body(body, twist, across).speed ** 2
    assert lost < 30


def test_a_motion_of_the_least_number_is_no_division_by_zero():
    old = Contact(5e-324, 1.9445664225274308, 1.3, (-1.0, 6.123233995736766e-17), velocity=(0.4, -0.5))
    new = Contact(
        2.0, -0.2, 1.5457746530755716, (0.944756277222261, 0.3277736668024665), 1e-8, (1.278155162288905, -1.3)
    )
    body = TwoPointBody(1.1, 4.411711866015143e-97, old, new)
    across = Transverse(-0.29304327883637216, -0.8874921986639221, -1.3)
    found = solve(body, Twist(0.4, -0.5, 5e-324), across)
    assert all(map(math.isfinite, (*found.outcome.twist, *found.transverse[:3], *found.impulses)))
