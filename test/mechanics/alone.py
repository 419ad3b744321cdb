"""Problems of arrays, one by one."""

from itertools import repeat

import numpy as np

from impact_predictor.mechanics.random_problems import problems_of


def alone(values):
    """Each element of values whose fields are arrays (n,), with floats as fields."""
    if isinstance(values, tuple):
        parts = map(alone, values)
        return map(type(values), *parts) if hasattr(values, "_fields") else zip(*parts, strict=False)
    return repeat(None) if values is None else values.tolist()


def random_impacts(kind, count, seed):
    """Bodies and twists of one kind of problem."""
    _, body, twist = problems_of(kind, np.random.default_rng(seed), count)
    return list(zip(alone(body), alone(twist), strict=True))
