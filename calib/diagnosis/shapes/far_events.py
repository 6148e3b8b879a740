"""Samples that lie far out, of all blocks, and how likely each is without a cause.

Without one, samples have the density of shot noise of n electrons and Gaussian noise together, told
by the method of steepest descent (Daniels, Annals of Mathematical Statistics 25, 631 (1954)): a
Poisson count of ten reaches six standard deviations a thousand times oftener than a Gaussian.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import poisson

from calib.diagnosis.evidence.evidence import Evidence

Floats = NDArray[np.float64]

UNKNOWN = 1e-10
"""Share of samples that have any code for no known reason, which bounds what one of them tells."""
BY_CHANCE = 0.1
"""Of all pixels so many, at the most, do by chance as often as one that has a reason of its own."""
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
        code: As they are stored, (n,).
    """

    off_dn: Floats
    variance_dn2: Floats
    read_dn2: Floats
    beside_sigma: Floats
    null: Floats
    exposure: Floats
    code: NDArray[np.intp]


def far_events(evidence: Evidence) -> FarEvents:
    """Return the samples that lie far out, but those of pixels that are noisy or full."""
    of_blocks = [each.far for each in evidence.sums]
    pixels = np.concatenate([far.pixel for far in of_blocks])
    noisy = np.array(evidence.sensor.noisy, np.intp)
    skipped = np.concatenate([_often(pixels, evidence.sensor.n_pixels), noisy])
    parts = [_of_block(b, skipped, evidence) for b in range(evidence.n_blocks)]
    names = FarEvents.__dataclass_fields__
    # A block without any does not know how many pixels are side by side.
    wide = max(part.beside_sigma.shape[1] for part in parts)
    some = [p for p in parts if p.beside_sigma.shape[1] == wide]
    return FarEvents(**{n: np.concatenate([getattr(p, n) for p in some]) for n in names})


def _of_block(b: int, skipped: NDArray[np.intp], evidence: Evidence) -> FarEvents:
    """Return the samples of a block but those of `skipped` pixels."""
    far, base = evidence.sums[b].far, evidence.baseline
    usable = base.usable[b].ravel()[far.pixel] & (not evidence.saturated[b])
    used = np.flatnonzero(usable & ~np.isin(far.pixel, skipped))
    at, off = far.pixel[used], far.off_dn[used]
    tap = evidence.sensor.tap.ravel()[at]
    gain = np.maximum(base.gain_dn_per_e[tap], 0.0)
    signal = np.maximum((base.mean_dn[b] - base.offset_dn).ravel()[at], 0.0)
    variance = np.maximum(far.variance_dn2[used], base.variance_dn2[b].ravel()[at])
    anywhere = UNKNOWN / (evidence.sensor.camera.full_scale_dn + 1.0)
    return FarEvents(
        off, variance, base.read_variance_dn2[tap],
        far.beside_dn[used] / np.sqrt(variance)[:, None],
        np.logaddexp(log_density(off, gain, signal, variance), np.log(anywhere)),
        np.full(len(at), relative_exposure(evidence)[b]),
        far.code[used],
    )  # fmt: skip


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


def relative_exposure(evidence: Evidence) -> Floats:
    """Return exposures over their mean, (n_blocks,)."""
    exposure = np.asarray(evidence.table.exposure_us, np.float64)
    return np.asarray(exposure / max(float(exposure.mean()), 1e-300))
