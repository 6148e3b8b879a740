"""What is left of covariances where codes stop: a sample below the level moves with nothing.

A line whose signal moves by d has stored codes that move by d times the share of its samples above
the level, on average: what lines and neighbours have in common goes with the square of that.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import norm

from calib.diagnosis.simulation.fault_surroundings import Surroundings
from calib.diagnosis.statistics.change import Change
from calib.forward.code_fault import CodeFault

QUANTILES = norm.ppf((np.arange(16) + 0.5) / 16)
"""Of a pixel's noise, of equal weight."""
SOME_PIXELS = 1024
"""Of each block, which stand for all."""
OWN = ("variance", "kurtosis")
"""Statistics of a pixel alone, which are worked out from its codes."""


def through_stops(
    change: Change, faults: Sequence[CodeFault], surroundings: Surroundings
) -> Change:
    """Return what is left of a change of covariances behind `faults` that act after it."""
    stops = [fault for fault in faults if type(fault).slope is not CodeFault.slope]
    if not stops:
        return change
    share = np.array([_slope(b, stops, surroundings) for b in range(len(change.pooled))])
    left = np.ones_like(change.pooled)
    for kind, where in surroundings.evidence.pooled.places.items():
        if kind not in OWN:
            left[:, where] = share[:, None] ** 2
    return replace(change, pooled=change.pooled * left)


def _slope(b: int, stops: Sequence[CodeFault], surroundings: Surroundings) -> float:
    """Return by how much the stored codes of a block move with the signal, on average."""
    sensor = surroundings.evidence.sensor
    # An odd step meets all taps.
    some = slice(None, None, sensor.n_pixels // SOME_PIXELS // 2 * 2 + 1)
    mean, variance = (x[b].ravel()[some] for x in (surroundings.means, surroundings.variance))
    values = mean + QUANTILES[:, None] * np.sqrt(variance)
    moves, tap = np.ones_like(values), sensor.tap.ravel()[some]
    for fault in stops:
        acting = np.isin(tap, [t for t in range(sensor.n_taps) if fault.acts_on(t)])
        moves = moves * np.where(acting, fault.slope(values), 1.0)
    return float(moves.mean())
