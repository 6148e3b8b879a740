"""How much likelier heavy tails, or tracks of charge, make the samples that lie far out.

Of independent samples of which a share s has the density a in the place of p, those beyond a cut
give the log likelihood ratio sum ln(1 + s a / p) - s A, where A is how many would lie beyond the
cut if all had that density: that of an extended likelihood (Barlow, NIM A 297, 496 (1990)). It is
largest along s at once for both shares, since it is concave.

p is the density of shot noise of n electrons and Gaussian noise together by the method of steepest
descent (Daniels, Annals of Mathematical Statistics 25, 631 (1954)): a Poisson count of ten reaches
six standard deviations a thousand times oftener than a Gaussian.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import erfcx, ndtr
from scipy.stats import poisson

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.statistics.far_samples import LEAST_SIGMA

Floats = NDArray[np.float64]

UNKNOWN = 1e-10
"""Share of samples that have any code for no known reason, which bounds what one of them tells."""
BY_CHANCE = 0.1
"""Of all pixels so many, at the most, do by chance as often as one that has a reason of its own."""
HIT_BESIDE = 1.0
"""Pixels beside one that a track crosses that it crosses, too, on average."""
BOTH_TAILED = 1e-4
"""Share of readings with heavy tails that is taken for the one beside another."""
STEPS = 200
"""Of the search for the shares, each of which makes the likelihood larger."""
NEWTON_STEPS = 40
FARTHEST_SIGMA = 30.0
"""How far Gaussian noise and shot noise are told: beyond, neither ever reaches."""


@dataclass(frozen=True)
class FarEvents:
    """All samples of a recording that lie far out.

    Attributes:
        off_dn: By how much, (n,).
        variance_dn2: Of their noise, (n,).
        read_dn2: Of that, what the read noise makes, (n,).
        beside_sigma: What lies beside them over its noise, (n, n_beside); nan beyond the edge.
        null: Logarithms of their density, 1/DN, without a cause, (n,).
        exposure: Of their blocks over the mean exposure, (n,).
    """

    off_dn: Floats
    variance_dn2: Floats
    read_dn2: Floats
    beside_sigma: Floats
    null: Floats
    exposure: Floats


def far_events(evidence: Evidence) -> FarEvents:
    """Return the samples that lie far out, but those of pixels that are noisy or full."""
    of_blocks = [each.far for each in evidence.sums]
    pixels = np.concatenate([far.pixel for far in of_blocks])
    noisy = np.array(evidence.sensor.noisy, np.intp)
    skipped = np.concatenate([_often(pixels, evidence.sensor.n_pixels), noisy])
    anywhere = UNKNOWN / (evidence.sensor.camera.full_scale_dn + 1.0)
    relative = relative_exposure(evidence)
    parts = []
    for b, far in enumerate(of_blocks):
        used = ~np.isin(far.pixel, skipped) & (not evidence.saturated[b])
        at = far.pixel[used]
        usable = evidence.baseline.usable[b].ravel()[at]
        at, used = at[usable], np.flatnonzero(used)[usable]
        tap = evidence.sensor.tap.ravel()[at]
        base = evidence.baseline
        gain = np.maximum(base.gain_dn_per_e[tap], 0.0)
        signal = np.maximum((base.mean_dn[b] - base.offset_dn).ravel()[at], 0.0)
        variance = np.maximum(far.variance_dn2[used], base.variance_dn2[b].ravel()[at])
        read = base.read_variance_dn2[tap]
        off = far.off_dn[used]
        parts.append(
            FarEvents(
                off, variance, read,
                far.beside_dn[used] / np.sqrt(variance)[:, None],
                np.logaddexp(log_density(off, gain, signal, variance), np.log(anywhere)),
                np.full(len(at), relative[b]),
            )
        )  # fmt: skip
    names = FarEvents.__dataclass_fields__
    wide = max(part.beside_sigma.shape[1] for part in parts)
    some = [p for p in parts if p.beside_sigma.shape[1] == wide]
    return FarEvents(**{n: np.concatenate([getattr(p, n) for p in some]) for n in names})


def _often(pixels: NDArray[np.intp], n_pixels: int) -> NDArray[np.intp]:
    """Return those of `pixels`, one for each sample, that hold more of them than chance gives."""
    which, times = np.unique(pixels, return_counts=True)
    typical = float(np.minimum(times, 2).sum()) / n_pixels
    many = np.arange(2, 2 + len(pixels))
    limit = many[n_pixels * poisson.sf(many - 1, typical) < BY_CHANCE]
    return np.asarray(which[times >= limit[0]] if len(limit) else which[:0])


def log_density(off_dn: Floats, gain: Floats, signal: Floats, variance: Floats) -> Floats:
    """Return ln of the density, 1/DN, of noise of shot and Gaussian parts.

    Args:
        off_dn: Deviations from the mean.
        gain: DN per electron.
        signal: Mean DN above the offset.
        variance: Of all the noise, DN^2; what is beyond gain x signal is Gaussian.
    """
    farthest = FARTHEST_SIGMA * np.sqrt(variance)
    off = np.clip(off_dn, -farthest, farthest)
    shot = np.minimum(gain * signal, variance)
    electrons = np.where(gain > 0, shot / np.maximum(gain, 1e-12) ** 2, 0.0)
    rest = np.maximum(variance - shot, 1e-3 * variance)
    # From off / variance on, where the slope of the cumulants is too large, it goes down to it.
    t = off / variance
    for _ in range(NEWTON_STEPS):
        grown = electrons * np.exp(np.minimum(gain * t, 500.0))
        slope = gain * (grown - electrons) + rest * t
        t = t - (slope - off) / (gain**2 * grown + rest)
    grown = electrons * np.exp(np.minimum(gain * t, 500.0))
    cumulants = grown - electrons - electrons * gain * t + 0.5 * rest * t**2
    curvature = gain**2 * grown + rest
    return np.asarray(cumulants - t * off - 0.5 * np.log(2.0 * np.pi * curvature))


def tailed(events: FarEvents, evidence: Evidence, noises: float) -> tuple[Floats, float]:
    """Return density ratios of readings of `noises` times the read noise, and how many are far."""
    base = evidence.baseline
    wide = events.variance_dn2 + noises**2 * events.read_dn2
    log_ratio = _normal(events.off_dn, wide) - events.null
    beside = np.where(np.isfinite(events.beside_sigma), events.beside_sigma, 0.0)
    share = (events.variance_dn2 / wide)[:, None]
    likelier = np.exp(np.minimum(0.5 * beside**2 * (1.0 - share), 300.0)) * np.sqrt(share)
    by_chance = np.log1p(BOTH_TAILED * (likelier - 1.0)).sum(axis=1)
    variance = base.variance_dn2.reshape(evidence.n_blocks, -1)
    read = base.read_variance_dn2[evidence.sensor.tap].ravel()
    far = 2.0 * ndtr(-LEAST_SIGMA * np.sqrt(variance / (variance + noises**2 * read)))
    return _ratio(log_ratio + by_chance), float((_samples(evidence) * far).sum())


def hit(events: FarEvents, evidence: Evidence, noises: float) -> tuple[Floats, float]:
    """Return density ratios of charges, of `noises` times the read noise on average, likewise."""
    base = evidence.baseline
    mean = noises * np.sqrt(events.read_dn2)
    log_ratio = _charged(events.off_dn, events.variance_dn2, mean) - events.null
    beside = np.where(np.isfinite(events.beside_sigma), events.beside_sigma, 0.0)
    over = (mean / np.sqrt(events.variance_dn2))[:, None]
    gained = _charged(beside, np.ones_like(beside), over) - _normal(beside, np.ones_like(beside))
    share = HIT_BESIDE / beside.shape[1]
    tracks = np.log1p(share * (np.exp(np.minimum(gained, 300.0)) - 1.0)).sum(axis=1)
    ratio = _ratio(log_ratio + tracks) * events.exposure
    sigma = np.sqrt(base.variance_dn2.reshape(evidence.n_blocks, -1))
    q = noises * np.sqrt(base.read_variance_dn2[evidence.sensor.tap].ravel())
    far = np.exp(_charged(LEAST_SIGMA * sigma, sigma**2, q)) * q + ndtr(-LEAST_SIGMA)
    expected = _samples(evidence) * far * relative_exposure(evidence)[:, None]
    # Of those side by side in a track, the farthest is an event.
    return ratio, float(expected.sum()) / (1.0 + HIT_BESIDE)


def flipped(events: FarEvents, evidence: Evidence) -> list[tuple[Floats, float]]:
    """Return density ratios of bits that flip: of any bit, then of each by itself, up or down."""
    variance = evidence.baseline.variance_dn2.reshape(evidence.n_blocks, -1)
    sigma, samples = np.sqrt(variance), _samples(evidence)
    found = []
    for bit in range(evidence.sensor.camera.bit_depth):
        moved = 2.0**bit
        far = float((samples * ndtr(moved / sigma - LEAST_SIGMA)).sum())
        for sign in (1.0, -1.0):
            log_ratio = _normal(events.off_dn - sign * moved, events.variance_dn2) - events.null
            found.append((_ratio(log_ratio), far))
    share = 1.0 / len(found)
    every = sum((ratio for ratio, _ in found), np.zeros_like(events.null)) * share
    return [(every, sum(far for _, far in found) * share), *found]


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


def relative_exposure(evidence: Evidence) -> Floats:
    """Return exposures over their mean, (n_blocks,)."""
    exposure = np.asarray(evidence.table.exposure_us, np.float64)
    return np.asarray(exposure / max(float(exposure.mean()), 1e-300))


def _samples(evidence: Evidence) -> Floats:
    """Return how many samples of each pixel and block count, (n_blocks, n_pixels)."""
    used = evidence.baseline.usable.reshape(evidence.n_blocks, -1).copy()
    used[evidence.saturated] = False
    used[:, sorted(evidence.sensor.noisy)] = False
    return np.asarray(evidence.n[:, None] * used)


def _ratio(log_ratio: Floats) -> Floats:
    return np.asarray(np.exp(np.minimum(log_ratio, 300.0)))


def _normal(off: Floats, variance: Floats) -> Floats:
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
