"""The harmonics of a support's last seconds, by linear prediction: what the learnt forecast of decks is compared with.

All channels obey one recursion y(t) = a_1 y(t - h) + ... + a_32 y(t - 32 h), whose solutions are damped harmonics that
they have in common: Prony's method (Makhoul, "Linear prediction: a tutorial review", Proc. IEEE 63, 1975, the
covariance method).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SECONDS = 0.1
"""Between two rows."""

ORDER = 32  # values in the recursion, over 3.2 s: sixteen harmonics, with their damping
RIDGE = 1e-7
"""Of the variance, added to that of each value: the recursion is not fitted to what is smaller. Noise does the same, as
far as there is any."""

REACH = 100  # rows that are predicted
DIVERGED = 1e6  # times the largest value in the window, beyond which a prediction is not led on
LIMIT = 1.5  # of the largest value in the window, beyond which nothing is predicted
REST = np.exp(-0.5 * np.arange(1, REACH + 1))[:, None]
"""What is left, at each of them, of that by which the last value missed the recursion: the next errors are like it, and
it does not jump where the prediction begins."""


def predicted(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """The last of some rows (n, 6) and REACH more, by the recursion that they obey best."""
    count = len(rows)
    mean = rows.mean(0)
    rows = rows - mean
    # One unit for what is felt and one for the rates: a quiet axis counts by what it has.
    unit = np.repeat([np.abs(rows[:, :3]).max(), np.abs(rows[:, 3:]).max()], 3)
    unit[unit == 0.0] = 1.0
    rows /= unit
    order = min(ORDER, count // 4)
    square, right = np.zeros((order, order)), np.zeros(order)
    lags = np.lib.stride_tricks.sliding_window_view(rows[:-1], order, axis=0).swapaxes(0, 1).copy()
    for before, after in zip(lags, rows[order:].T, strict=True):
        square += before.T @ before
        right += before.T @ after
    ridge = RIDGE * np.trace(square) / order + 1e-300
    factors = np.linalg.solve(square + ridge * np.eye(order), right)
    rest = REST * (rows[-1] - factors @ rows[-1 - order : -1])
    found = np.concatenate([rows, rest])
    limit = LIMIT * np.abs(rows).max(0)
    for i in range(count, count + REACH):
        found[i] += factors @ found[i - order : i]
        if i % 10 == 0 and not np.abs(found[i]).max() < DIVERGED:
            found[i:] = 0.0
            break
    ahead: NDArray[np.float64] = np.clip(found[count - 1 :], -limit, limit) * unit + mean
    return ahead
