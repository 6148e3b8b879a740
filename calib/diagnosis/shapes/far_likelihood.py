"""How much likelier heavy tails, or tracks of charge, make the samples that lie far out.

Of independent samples of which a share s has the density a in the place of p, those beyond a cut
give the log likelihood ratio sum ln(1 + s a / p) - s A, where A is how many would lie beyond the
cut if all had that density: that of an extended likelihood (Barlow, NIM A 297, 496 (1990)). It is
largest along s at once for both shares, since it is concave.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import erfcx, ndtr

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.far_events import FarEvents, relative_exposure
from calib.diagnosis.statistics.far_samples import LEAST_SIGMA

Floats = NDArray[np.float64]

HIT_BESIDE = 1.0
"""Pixels beside one that a track crosses that it crosses, too, on average."""
BOTH_TAILED = 1e-4
"""Share of readings with heavy tails that is taken for the one beside another."""
STEPS = 200
"""Of the search for the shares, each of which makes the likelihood larger."""


def tailed(events: FarEvents, evidence: Evidence, noises: float) -> tuple[Floats, float]:
    """Return density ratios of readings of `noises` times the read noise, and how many are far."""
    base = evidence.baseline
    wide = events.variance_dn2 + noises**2 * events.read_dn2
    log_ratio = normal(events.off_dn, wide) - events.null
    beside = np.where(np.isfinite(events.beside_sigma), events.beside_sigma, 0.0)
    share = (events.variance_dn2 / wide)[:, None]
    likelier = np.exp(np.minimum(0.5 * beside**2 * (1.0 - share), 300.0)) * np.sqrt(share)
    by_chance = np.log1p(BOTH_TAILED * (likelier - 1.0)).sum(axis=1)
    variance = base.variance_dn2.reshape(evidence.n_blocks, -1)
    read = base.read_variance_dn2[evidence.sensor.tap].ravel()
    far = 2.0 * ndtr(-LEAST_SIGMA * np.sqrt(variance / (variance + noises**2 * read)))
    return ratio_of(log_ratio + by_chance), float((samples_of(evidence) * far).sum())


def raised(events: FarEvents, evidence: Evidence, noises: float) -> tuple[Floats, float]:
    """Return density ratios of readings that only rise, by `noises` times the read noise, likewise.

    Each has the density of a charge, whatever is beside it, and as often in any exposure.
    """
    base = evidence.baseline
    mean = noises * np.sqrt(events.read_dn2)
    log_ratio = _charged(events.off_dn, events.variance_dn2, mean) - events.null
    sigma = np.sqrt(base.variance_dn2.reshape(evidence.n_blocks, -1))
    q = noises * np.sqrt(base.read_variance_dn2[evidence.sensor.tap].ravel())
    far = np.exp(_charged(LEAST_SIGMA * sigma, sigma**2, q)) * q + ndtr(-LEAST_SIGMA)
    return ratio_of(log_ratio), float((samples_of(evidence) * far).sum())


def hit(events: FarEvents, evidence: Evidence, noises: float) -> tuple[Floats, float]:
    """Return density ratios of charges, of `noises` times the read noise on average, likewise."""
    base = evidence.baseline
    mean = noises * np.sqrt(events.read_dn2)
    log_ratio = _charged(events.off_dn, events.variance_dn2, mean) - events.null
    beside = np.where(np.isfinite(events.beside_sigma), events.beside_sigma, 0.0)
    over = (mean / np.sqrt(events.variance_dn2))[:, None]
    gained = _charged(beside, np.ones_like(beside), over) - normal(beside, np.ones_like(beside))
    share = HIT_BESIDE / beside.shape[1]
    tracks = np.log1p(share * (np.exp(np.minimum(gained, 300.0)) - 1.0)).sum(axis=1)
    ratio = ratio_of(log_ratio + tracks) * events.exposure
    sigma = np.sqrt(base.variance_dn2.reshape(evidence.n_blocks, -1))
    q = noises * np.sqrt(base.read_variance_dn2[evidence.sensor.tap].ravel())
    far = np.exp(_charged(LEAST_SIGMA * sigma, sigma**2, q)) * q + ndtr(-LEAST_SIGMA)
    expected = samples_of(evidence) * far * relative_exposure(evidence)[:, None]
    # Of those side by side in a track, the farthest is an event.
    return ratio, float(expected.sum()) / (1.0 + HIT_BESIDE)


def most_likely(ratios: Floats, expected: Floats) -> float:
    """Return twice the largest log likelihood ratio of samples that are mixed of causes.

    Args:
        ratios: How much likelier each cause makes each sample, (n_causes, n).
        expected: How many samples each makes if all are of it, (n_causes,).
    """
    if len(ratios) == 0 or ratios.shape[1] == 0:
        return 0.0
    expected = np.maximum(expected, 1e-12)
    share = np.full(len(ratios), 0.5 * ratios.shape[1]) / expected
    for _ in range(STEPS):
        mixed = 1.0 + share @ ratios
        share = share * (ratios / mixed).sum(axis=1) / expected
    found = np.log(1.0 + share @ ratios).sum() - float(share @ expected)
    return 2.0 * max(float(found), 0.0)


def samples_of(evidence: Evidence) -> Floats:
    """Return how many samples of each pixel and block count, (n_blocks, n_pixels)."""
    used = evidence.baseline.usable.reshape(evidence.n_blocks, -1).copy()
    used[evidence.saturated] = False
    used[:, sorted(evidence.sensor.noisy)] = False
    return np.asarray(evidence.n[:, None] * used)


def ratio_of(log_ratio: Floats) -> Floats:
    """Return ratios, (n,), that are finite whatever their logarithms."""
    return np.asarray(np.exp(np.minimum(log_ratio, 300.0)))


def normal(off: Floats, variance: Floats) -> Floats:
    """Return ln of the density of Gaussian noise, 1/DN."""
    return np.asarray(-0.5 * off**2 / variance - 0.5 * np.log(2.0 * np.pi * variance))


def _charged(off: Floats, variance: Floats, mean: Floats) -> Floats:
    """Return ln of the density of Gaussian noise and an exponential charge of that mean."""
    sigma = np.sqrt(variance)
    x = (sigma / mean - off / sigma) / np.sqrt(2.0)
    # erfc(x) exp(x^2) by itself keeps its digits on the side where erfc is small.
    low = np.log(erfcx(np.maximum(x, 0.0))) - 0.5 * off**2 / variance
    high = np.log(2.0 * ndtr(-np.sqrt(2.0) * np.minimum(x, 0.0))) + (
        0.5 * variance / mean**2 - off / mean
    )
    return np.asarray(np.where(x > 0, low, high) - np.log(2.0 * mean))
