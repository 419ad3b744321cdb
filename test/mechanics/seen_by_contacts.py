"""Contact space of a planar body: what its contacts do."""

import math

import numpy as np

from impact_predictor import Contact


def rows_of(body):
    """Contact velocities as products with the twist (vx, vy, omega); without an old contact its rows are no numbers."""
    rows = []
    for contact in (body.old, body.new):
        if contact is None:
            rows += [[math.nan] * 3] * 2
            continue
        nx, ny = contact.normal
        rows += [(ux, uy, contact.x * uy - contact.y * ux) for ux, uy in ((nx, ny), (ny, -nx))]
    return np.array(rows)


def contact_velocity(contact, twist):
    """Normal and tangential velocity of a body at a contact, relative to its support."""
    (nx, ny), (ux, uy) = contact.normal, contact.velocity
    cx, cy = twist[0] - twist[2] * contact.y - ux, twist[1] + twist[2] * contact.x - uy
    return nx * cx + ny * cy, ny * cx - nx * cy


def velocities(body, twist):
    """Contact velocities relative to the supports, and the sizes of the terms that they are the sums of."""
    speeds, sizes = [], []
    for contact in (body.old, body.new):
        if contact is None:
            speeds, sizes = [math.inf, math.nan], [0.0, 0.0]
            continue
        speeds += contact_velocity(contact, twist)
        terms = (*twist[:2], twist[2] * contact.x, twist[2] * contact.y, *contact.velocity)
        sizes += [sum(map(abs, terms))] * 2
    return speeds, sizes


def condition(w):
    """Condition number of W on its range, its diagonal scaled to 1: how many roundings an error may be."""
    scale = np.sqrt(np.diag(w))
    sizes = np.linalg.eigvalsh(w / scale / scale[:, None])
    return sizes[-1] / min(size for size in sizes if size > 1e-12)


def seen_by_contacts(body, twist):
    """W and c of a planar body, and its frictions and restitutions; a contact that rests up to rounding rests."""
    rows = rows_of(body)
    w = rows / (body.mass, body.mass, body.inertia) @ rows.T
    speeds, sizes = velocities(body, twist)
    c = [0.0 if abs(speed) <= 1e-14 * size else speed for speed, size in zip(speeds, sizes, strict=True)]
    contacts = (body.old or Contact(0.0, 0.0, math.nan, restitution=math.nan), body.new)
    return w, c, tuple(one.friction for one in contacts), tuple(one.restitution for one in contacts)
