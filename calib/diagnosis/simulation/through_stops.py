"""What is left of covariances where codes stop: a sample below the level moves with nothing.

A line whose signal moves by d has stored codes that move by d times the share of its samples above
the level, on average: what lines and neighbours have in common goes with the square of that.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from calib.diagnosis.simulation.fault_surroundings import Surroundings, variance_of_pixels
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.expected import second_moments
from calib.diagnosis.statistics.pooled import Pooled
from calib.forward.code_fault import CodeFault

Floats = NDArray[np.float64]

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
    # What pixels' own noise makes of covariances of residuals follows from the noise that is left.
    white = np.stack([
        _of_own_noise(b, row, surroundings) for b, row in enumerate(change.pooled)
    ])  # fmt: skip
    left = change.pooled.copy()
    for kind, where in surroundings.evidence.pooled.places.items():
        if kind not in OWN:
            own = white[:, where]
            left[:, where] = own + share[:, None] ** 2 * (left[:, where] - own)
    return replace(change, pooled=left)


def _of_own_noise(b: int, pooled: Floats, surroundings: Surroundings) -> Floats:
    """Return what the change of pixels' own variances makes of a block's statistics."""
    evidence = surroundings.evidence
    moved = variance_of_pixels(pooled, evidence)
    n, sensor = int(evidence.n[b]), evidence.sensor
    return Pooled(second_moments(moved, n, sensor, evidence.counts)).vector()


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
