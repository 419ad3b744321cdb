"""Made touchdowns of a box whose coefficients are known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from impact_predictor.calibration.solver import Coefficients, Solver
from impact_predictor.calibration.touchdowns import ScoredTouchdown
from impact_predictor.prediction.scene import Scene, inertia_matrix

HALF = np.array([0.06, 0.05, 0.04])
SIGNS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
MASS = 0.5
MOMENTS = MASS / 3.0 * (HALF @ HALF - HALF**2)
TRUTH = Coefficients(friction=0.2, restitution=0.3, merge=2e-3)


def touchdowns(
    truth: Coefficients = TRUTH,
    number: int = 60,
    noise: float = 0.0,
    given: tuple[float, float, float] = (0.4, 0.0, 5e-4),
    seed: int = 0,
    slips: bool = True,
) -> list[ScoredTouchdown]:
    """Boxes that fall, each in a time of its own, every second one almost flat.

    `noise` is the standard deviation of each part of the measured twist, relative to the speed before.
    """
    rng = np.random.default_rng(seed)
    friction, restitution, merge = given
    tensor = inertia_matrix([*MOMENTS.tolist(), 0.0, 0.0, 0.0])
    scene = Scene(MASS, tensor, friction=friction, restitution=restitution, merge=merge)
    made = []
    for k in range(number):
        turn = Rotation.from_rotvec(rng.normal(0.0, 0.01, 3)) if k % 2 else Rotation.random(random_state=rng)
        matrix = turn.as_matrix()
        arms: NDArray[np.float64] = (SIGNS * HALF) @ matrix.T
        linear = np.array([*rng.normal(0.0, 1.0 if slips else 0.0, 2), -rng.uniform(0.5, 1.5)])
        made.append(
            ScoredTouchdown(
                body="",
                stamp=k * 10**10,
                kind="flight>corner",
                scene=scene,
                twist=np.array([*linear, *rng.normal(0.0, 5.0 if slips else 0.0, 3)]),
                inertia=matrix @ np.array(tensor) @ matrix.T,
                arms=arms,
                normals=np.tile([0.0, 0.0, 1.0], (8, 1)),
                gaps=arms[:, 2] - arms[:, 2].min(),
                stood=np.zeros(8, bool),
                size=0.04,
                measured=np.zeros(6),
            )
        )
    measured = Solver(made).after(truth)
    shaken = [
        after + one.speed * rng.normal(0.0, noise, 6) / one.scales for one, after in zip(made, measured, strict=True)
    ]
    return [one._replace(measured=after) for one, after in zip(made, shaken, strict=True)]
