"""The time function of all slow drifts: a first-order approach to an equilibrium."""

import numpy as np

from calib.arrays import Columns


def settled(times_s: Columns, time_constant_s: float) -> Columns:
    """Return 1 - exp(-time / time_constant), (n_lines,): 0 at the recording's start, at last 1.

    >>> settled(np.array([0.0]), 5.0)
    array([0.])
    """
    return -np.expm1(-times_s / time_constant_s) + 0.0
