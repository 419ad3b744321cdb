"""When the total-impulse law has one answer only, in law code (see `pair`).

The law is a map: from the impulses of the contacts that hold and the velocities of those that open or slip, to the
contact velocities before the impact. It is linear while the contact states stay, one piece for each pair of states. If
the determinants of all pieces are positive, every velocity before the impact is met equally often; and one at which
nothing touches is met once, because impulses would only cost energy there. So the law then has one answer.
"""

from __future__ import annotations

from .pair import Pair


def one_answer(pair: Pair, cta: float, ctb: float) -> bool:
    """Whether the total law has one answer for all impacts of a pair, as far as the determinants tell.

    The slips c_tA and c_tB before the impact matter on one flat floor alone, where they stay the same if they are.
    The determinants are linear in each friction, which enters with both signs.
    """
    cos, sin, qa, sa, qb, sb, fa, fb = pair
    # A contact slips and the other is open.
    if fa * abs(qa * sa) >= 1.0 + qa * qa or fb * abs(qb * sb) >= 1.0 + qb * qb:
        return False
    if sin == 0.0 and cos > 0.0 and sa == sb and cta == ctb:
        return abs((fb - fa) * sa) < abs(qb - qa)
    # A contact slips and the other sticks.
    if fa * abs(sb * cos - qb * sin - sa) >= abs(qb * cos + sb * sin - qa):
        return False
    if fb * abs(sa * cos + qa * sin - sb) >= abs(qa * cos - sa * sin - qb):
        return False
    # Both slip: nA x nB, which is (x, y, sin), times the cross product of nA +- fa tA and nB +- fb tB.
    x, y = qb - qa * cos, -qa * sin
    normals = x * x + y * y + sin * sin
    old = fa * (y * (sa * sin + qb) + cos * (x * sa - sin))
    new = fb * (x * (sb - qa * sin) + cos * (y * qa - sin))
    both = fa * fb * (x * sa * sin - y * (sa * cos - sb) - sin * sin)
    return abs(old + new) < normals + both and abs(old - new) < normals - both
