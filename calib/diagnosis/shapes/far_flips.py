"""How much likelier bits that stick, or flip, make the samples that lie far out.

A bit that sticks at a value moves those codes by 2^bit that have it at the other one, and leaves it
at that value in all: samples lie by exactly so much from where their pixel's codes are, and what
is stored tells at which value. Tails and charges reach such places as often as those beside them.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.far_events import FarEvents
from calib.diagnosis.shapes.far_likelihood import normal, ratio_of, samples_of
from calib.diagnosis.statistics.far_samples import LEAST_SIGMA

Floats = NDArray[np.float64]
Bit = tuple[int, int]
"""Which, and the value at which it sticks."""

BOTH_FLIPPED = 1e-3
"""Share of samples with the bit moved that is taken for the one beside another."""


def stuck(events: FarEvents, evidence: Evidence) -> dict[Bit, tuple[Floats, float]]:
    """Return density ratios of each bit that sticks at each value, and how many are far."""
    base = evidence.baseline
    mean, sigma = (
        x.reshape(evidence.n_blocks, -1) for x in (base.mean_dn, np.sqrt(base.variance_dn2))
    )
    found = {}
    for bit in range(evidence.sensor.camera.bit_depth):
        moved = 2.0**bit
        far = samples_of(evidence) * ndtr(moved / sigma - LEAST_SIGMA)
        up = share_set(mean, sigma, moved)
        for value, free in ((0, up), (1, 1.0 - up)):
            log_ratio = _log_ratio(moved if value else -moved, events)
            stored = (events.code >> bit & 1) == value
            found[bit, value] = (
                np.where(stored, ratio_of(log_ratio), 0.0),
                float((far * free).sum()),
            )
    return found


def flipped(events: FarEvents, evidence: Evidence) -> tuple[Floats, float]:
    """Return density ratios of any bit that flips, up or down, likewise."""
    sigma = np.sqrt(evidence.baseline.variance_dn2.reshape(evidence.n_blocks, -1))
    depth, samples = evidence.sensor.camera.bit_depth, samples_of(evidence)
    ratio, far = np.zeros_like(events.null), 0.0
    for moved in 2.0 ** np.arange(depth):
        for sign in (1.0, -1.0):
            ratio += ratio_of(_log_ratio(sign * moved, events)) / (2.0 * depth)
        far += float((samples * ndtr(moved / sigma - LEAST_SIGMA)).sum()) / depth
    return ratio, far


def _log_ratio(moved: float, events: FarEvents) -> Floats:
    """Return ln of the density ratios of samples that were moved by so much, DN, (n,)."""
    own = normal(events.off_dn - moved, events.variance_dn2) - events.null
    over = (moved / np.sqrt(events.variance_dn2))[:, None]
    beside = np.where(np.isfinite(events.beside_sigma), events.beside_sigma, 0.0)
    likelier = np.exp(np.minimum(over * beside - 0.5 * over**2, 300.0))
    return np.asarray(own + np.log1p(BOTH_FLIPPED * (likelier - 1.0)).sum(axis=1))


def share_set(mean: Floats, sigma: Floats, width: float) -> Floats:
    """Return the share of samples whose codes have the bit that is worth `width` DN.

    It is set in every other interval as wide; of those that tell, no pixel reaches two.
    """
    x, s = np.mod((mean + 0.5) / width, 2.0), sigma / width
    return np.asarray(np.clip(ndtr((x - 1.0) / s) - ndtr((x - 2.0) / s) + ndtr(-x / s), 0.0, 1.0))
