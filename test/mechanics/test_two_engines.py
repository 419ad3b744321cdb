"""Impacts of 16,000 random bodies as two engines once answered them that shared no contact law: two_engines.npz.

One engine knew the planar body and the other only its W and c. The file holds the inputs (all kinds of random problems,
and rods down to 1e-7 thin with friction up to 8), the answers for the body by both laws, and which of them the engine
of W gave as well: all but those of bodies that are so slender, or whose contacts are so close, that W has lost the
digits. Positions and speeds are single-precision numbers, so that the file stays small.
"""

from pathlib import Path

import numpy as np
import pytest
from seen_by_contacts import seen_by_contacts, velocities

from impact_predictor import Contact, Flag, Mode, Twist, TwoPointBody, solve_impact
from impact_predictor.mechanics.contact_space import solve

KEPT = dict(np.load(Path(__file__).parent / "two_engines.npz"))
NAMES = KEPT["names"].tolist()
STIFF = ("slender", "close", "extreme", "extreme-apart")
"""Bodies of which one rounding can be much in the outcome."""
AGREED = 6e-13
"""Largest difference of the two engines, as a part of the contact speeds before the impact: roundings of W, which grow
with its condition number of up to 1e4."""
NEAR = 1e-14
"""The same times the square of the radius of gyration over the distance of the contacts: exact arithmetic says that
answers of contacts that are so near to each other are that uncertain, these and those before."""
UNCERTAIN = {"close": 2e-7, "extreme": 1e-8, "extreme-apart": 1e-8}
"""Kinds of which a few jam or end a jam so near to a border that exact arithmetic finds both answers off by as much."""
LOST = 0.04
"""The part of the stiff bodies of which the rank of W is a matter of rounding, so that its answer is too."""
SINGLE = 1e-7
"""The same for impulses, which are kept in single precision."""
OF_A_BODY = Flag.THIN_BODY | Flag.SLOW_IMPACT
"""What W and c cannot tell: they know neither shape nor weight."""
LAWS = ("path", "total")


def impacts(kind):
    """Number in the file, body and twist of each impact of a kind."""
    of_kind = np.flatnonzero(KEPT["kind"] == NAMES.index(kind))
    names = [name for name, values in KEPT.items() if values.dtype in (np.float32, float) and values.ndim == 1]
    rows = zip(*(KEPT[name][of_kind].tolist() for name in names), strict=True)
    for i, row in zip(of_kind.tolist(), rows, strict=True):
        given = dict(zip(names, row, strict=True))
        omega, slip, lift, turning = (given[name] for name in ("omega", "slip", "lift", "turning"))
        ax, ay, anx, any_, bx, by = (given[name] for name in ("ax", "ay", "anx", "any", "bx", "by"))
        ux, uy, wx, wy = (given[name] for name in ("ux", "uy", "wx", "wy"))
        # It turns about A, slips on it and leaves or strikes it; the supports move as one body, and B's also apart.
        twist = Twist(
            omega * ay + slip * any_ + lift * anx + ux, -omega * ax - slip * anx + lift * any_ + uy, omega + turning
        )
        old = Contact(ax, ay, given["fa"], (anx, any_), given["ea"], (ux - turning * ay, uy + turning * ax))
        support = ux - turning * by + wx, uy + turning * bx + wy
        new = Contact(bx, by, given["fb"], (given["bnx"], given["bny"]), given["eb"], support)
        body = TwoPointBody(given["mass"], given["mass"] * given["square"], old if KEPT["stands"][i] else None, new)
        yield i, body, twist


def speed_of(c):
    return max(abs(part) for part in c if abs(part) < np.inf)


def test_there_are_16000_bodies_of_all_modes():
    assert len(KEPT["kind"]) == 16000
    assert len(set(KEPT["kind"].tolist())) == len(NAMES) == 19
    for law in LAWS:
        assert set(KEPT[f"{law}_mode"].tolist()) == set(map(int, Mode))
        assert KEPT[f"{law}_by_w"].mean() > 0.95
    rare = Flag.REVERSED_SLIP | Flag.JAMMED | Flag.WORK_LIMITED | Flag.SHARED_FRICTION | Flag.BOTH_STRUCK
    assert rare | Flag.LAST_RESORT | Flag.NO_SOLUTION in Flag(int(np.bitwise_or.reduce(KEPT["path_flags_by_w"])))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", NAMES)
def test_a_body_has_the_impact_that_it_had(kind, law):
    borders = 0
    for i, body, twist in impacts(kind):
        old, new = body.old or Contact(np.inf, 0.0, 0.0), body.new
        gap = np.hypot(new.x - old.x, new.y - old.y)
        if gap == 0.0:
            continue  # rounding decided where the contacts lie
        outcome = solve_impact(body, twist, law)
        kept = KEPT[f"{law}_twist"][i]
        rho = np.sqrt(body.inertia / body.mass)
        uncertain = AGREED + NEAR * (rho / gap) ** 2 + UNCERTAIN.get(kind, 0.0)
        size = speed_of(velocities(body, twist)[0]) + np.abs(kept[:2]).max() + rho * abs(kept[2])
        assert np.abs(outcome.twist - kept).max() <= uncertain * size, i
        assert (outcome.mode, outcome.unique) == (KEPT[f"{law}_mode"][i], KEPT[f"{law}_unique"][i]), i
        borders += outcome.flags != KEPT[f"{law}_flags"][i]
        if kind not in STIFF:
            expected = KEPT[f"{law}_impulses"][i].astype(float)
            assert np.abs(np.ravel(outcome.impulses) - expected).max() <= SINGLE * np.abs(expected).max(), i
    assert borders <= 1  # where the expansion ends by Poisson's rule and by energy at once


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", NAMES)
def test_w_and_c_have_the_impact_that_they_had(kind, law):
    lost = borders = compared = 0
    for i, body, twist in impacts(kind):
        if not KEPT[f"{law}_by_w"][i]:
            continue
        w, c, *contacts = seen_by_contacts(body, twist)
        outcome = solve(w, c, *contacts, law)
        speeds = velocities(body, Twist(*KEPT[f"{law}_twist"][i]))[0]
        first = 0 if body.old is not None else 2
        wrong = np.abs(np.subtract(outcome.velocities[first:], speeds[first:])).max()
        as_before = (outcome.mode, outcome.unique) == (KEPT[f"{law}_mode"][i], KEPT[f"{law}_unique"][i])
        lost += not wrong <= 2.0 * AGREED * speed_of(c) or not as_before
        borders += outcome.flags != KEPT[f"{law}_flags_by_w"][i]
        compared += 1
        if kind not in STIFF:
            expected = KEPT[f"{law}_impulses"][i].astype(float)
            assert np.abs(np.ravel(outcome.impulses) - expected).max() <= SINGLE * np.abs(expected).max(), i
    assert lost <= (LOST * compared if kind in STIFF else 0)
    assert borders <= (LOST * compared if kind in STIFF else 2)
