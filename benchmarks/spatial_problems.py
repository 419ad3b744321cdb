"""Random impacts in three dimensions of one to eight contacts, and the same in another world or other units."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from impact_predictor import Body, ContactPoints
from impact_predictor.mechanics.invariants import UNITS

Array = NDArray[np.float64]

CHUNKS = (16, 16, 8, 8, 1, 1, 1, 1)
"""Chunks of each kind in a round, with 1 to 8 contacts: most scenes have one to four, and eight in all directions, or
between supports that part, take a hundred times as long."""


class Problems(NamedTuple):
    """Bodies (k) with n contacts each and their twists (k, 6)."""

    body: Any
    contacts: Any
    twist: Array

    def seen(self, twist: Array) -> Array:
        """Velocities (k, n, 3) of the contacts relative to their supports."""
        turning = np.cross(twist[:, None, 3:], self.contacts.positions)
        return np.asarray(twist[:, None, :3] + turning - self.contacts.velocities)

    def first(self, count: int) -> Problems:
        (mass, inertia), contacts, twist = self
        fields = (field[:count] for field in contacts[:-1])
        return Problems(Body(mass[:count], inertia[:count]), ContactPoints(*fields), twist[:count])


def problems_of(kind: str, n: int, source: np.random.Generator, k: int) -> Problems:
    """`k` problems of one of the `KINDS` with n contacts, of which up to three rest and the others mostly approach."""

    def some(low: float, high: float, *shape: int) -> Array:
        return source.uniform(low, high, (k, *shape))

    def directions(points: int) -> Array:
        found = source.normal(size=(k, points, 3))
        return np.asarray(found / np.linalg.norm(found, axis=-1, keepdims=True))

    positions, normals = some(-1.0, 1.0, n, 3), np.tile([0.0, 0.0, 1.0], (k, n, 1))
    positions[..., 2] = -some(0.05, 1.0, 1)
    if kind == "box":
        half = some(0.05, 1.0, 1, 3)
        corner = np.argsort(source.random((k, 4)), axis=1)[:, np.arange(n) % 4]
        signs = np.stack([np.where(corner & 1, 1, -1), np.where(corner & 2, 1, -1), -np.ones_like(corner)], axis=-1)
        positions = half * signs
    elif kind in ("any", "deck", "apart"):
        positions, normals = some(-1.0, 1.0, n, 3), directions(n)
    elif kind == "coincident":
        positions[:, n // 2 :] = positions[:, : n - n // 2]
        normals[:, n // 2 :] = directions(n - n // 2)
    elif kind == "nearly flat":
        positions[..., 2] += 10.0 ** some(-12.0, -2.0, 1) * some(-1.0, 1.0, n)
        normals = normals + 10.0 ** some(-12.0, -2.0, 1, 1) * directions(n)
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    elif kind == "thin":
        positions[..., 1:] *= 10.0 ** some(-4.0, -1.0, 1, 1)
    # The inertia of masses at random places, or of one that is as thin as its points.
    masses = some(-1.0, 1.0, 6, 3) * (np.abs(positions).max(1, keepdims=True) if kind in ("box", "thin") else 1.0)
    mass = 10.0 ** some(-2.0, 2.0)
    square = (masses * masses).sum((1, 2))[:, None, None] * np.eye(3) - np.einsum("kai,kaj->kij", masses, masses)
    twist = some(-2.0, 2.0, 6)
    twist[:, 2] -= some(0.0, 2.0)

    # Of some contacts the speed along the normal goes: they rest.
    rests = (source.random((k, n)) < 0.5) & (np.arange(n) < source.integers(0, 4, (k, 1)))
    rows = np.concatenate([normals, np.cross(positions, normals)], axis=-1) * rests[..., None]
    twist -= (np.linalg.pinv(rows, 1e-9) @ (rows @ twist[..., None]))[..., 0]
    velocities = np.zeros((k, n, 3))
    if kind == "apart":
        velocities = some(-2.0, 2.0, n, 3)
    elif kind == "deck":
        deck = some(-2.0, 2.0, 6)
        velocities, twist = deck[:, None, :3] + np.cross(deck[:, None, 3:], positions), twist + deck

    friction = some(0.0, 1.0, n) * source.choice([0.0, 0.5, 1.0, 3.0], (k, 1))
    friction = np.where(source.random((k, 1)) < 0.5, friction, friction[:, :1])
    restitution = source.choice([0.0, 0.0, 0.1, 0.5, 1.0], (k, 1)) * np.ones((k, n))
    restitution = np.where(source.random((k, 1)) < 0.7, restitution, some(0.0, 1.0, n))
    body = Body(mass, mass[:, None, None] * square)
    return Problems(body, ContactPoints(positions, friction, restitution, normals, velocities), twist)


ONE_FLOOR = ("box", "floor", "nearly flat", "thin")
"""The kinds whose points lie on one floor, as they do under a body; the others have any normals."""

KINDS = ("box", "floor", "any", "deck", "apart", "coincident", "nearly flat", "thin")

ROUND = [
    (kind, n)
    for _, n, kind in sorted(
        ((number + 0.5) / chunks, n, kind)
        for n, chunks in enumerate(CHUNKS, 1)
        for number in range(chunks)
        for kind in KINDS
    )
]
"""Kind and number of contacts of each chunk, spread so that a part of a round is like the whole."""


def turned(problems: Problems, turn: Array) -> Problems:
    """The world turned about z, or mirrored: `turn` (3, 3)."""
    (mass, inertia), contacts, twist = problems
    axial = turn * np.linalg.det(turn)
    vectors = {name: getattr(contacts, name) @ turn.T for name in ("positions", "normals", "velocities")}
    moved = np.concatenate([twist[:, :3] @ turn.T, twist[:, 3:] @ axial.T], axis=1)
    return Problems(Body(mass, turn @ np.asarray(inertia) @ turn.T), contacts._replace(**vectors), moved)


def in_units(problems: Problems) -> Problems:
    (mass, inertia), contacts, twist = problems
    m, x, t = UNITS
    return Problems(
        Body(np.asarray(mass) * m, np.asarray(inertia) * (m * x * x)),
        contacts._replace(positions=contacts.positions * x, velocities=contacts.velocities * (x / t)),
        twist * np.repeat([x / t, 1.0 / t], 3),
    )
