"""What two draws of an effect have in common: the rest of each is chance."""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.noisy import NOISY_SIGMA, few

Floats = NDArray[np.float64]


def reproduced(
    one: Change, other: Change, evidence: Evidence, moved_dn: Floats, *, exact: bool
) -> Change:
    """Return the mean of two draws, each part of it shrunk by how badly the other repeats it.

    Args:
        one: A draw.
        other: Another.
        evidence: The recording.
        moved_dn: What the links' own means have moved by, (n_blocks, n_pixels): no chance has a
            part in it, and pixels absorb it, each as it is.
        exact: Whether means are alike in both.
    """
    half = (one + other) * 0.5
    signal = (evidence.baseline.mean_dn - evidence.baseline.offset_dn).reshape(one.means.shape)
    means = one.means
    if not exact:
        added = (_of_quiet(each, evidence, moved_dn) for each in (one, other))
        means = moved_dn + _shrunk(*(_along_profile(each, signal) for each in added))
    white = [evidence.pooled.over_std(c.pooled) for c in (one, other)]
    pooled = half.pooled.copy()
    for where in evidence.pooled.places.values():
        pooled[:, where] *= _share(white[0][:, where], white[1][:, where])
    return Change(
        means, _shrunk(one.onset, other.onset), pooled, half.rare,
        one.pixel_variance, np.stack([one.codes[0], other.codes[-1]]), half.tones,
        one.pixel_misfit,
    )  # fmt: skip


def _of_quiet(change: Change, evidence: Evidence, moved_dn: Floats) -> Floats:
    """Return what is added to the means, but of pixels that would be left out for their noise."""
    z = change.pixel_variance * np.sqrt((evidence.n - 1).sum() / 2.0)
    misfit = evidence.misfit(change.means, observed=False)
    noisy = few(np.flatnonzero((z > NOISY_SIGMA) | (misfit > NOISY_SIGMA)), len(z))
    means = change.means - moved_dn
    means[:, noisy] = 0.0
    return means


def _along_profile(means: Floats, signal: Floats) -> Floats:
    """Return each block's means fitted by a constant and the block's own profile of signal."""
    ones = np.ones(means.shape[1])
    centred = signal - signal.mean(axis=1, keepdims=True)
    spread = np.einsum("bp,bp->b", centred, centred)
    slope = np.einsum("bp,bp->b", centred, means) / np.maximum(spread, 1e-12)
    slope = np.where(spread > 1e-9 * np.maximum((signal**2).sum(axis=1), 1e-12), slope, 0.0)
    return np.asarray(means.mean(axis=1)[:, None] * ones + slope[:, None] * centred)


def _share(one: Floats, other: Floats) -> float:
    """Return which share of the mean's energy is not chance, from what two draws have in common."""
    mean2 = float(((one + other) ** 2).sum()) / 4
    noise2 = float(((one - other) ** 2).sum()) / 4
    return max(0.0, 1.0 - 1.3 * noise2 / mean2) if mean2 > 0 else 0.0


def _shrunk(one: Floats, other: Floats) -> Floats:
    return np.asarray((one + other) * 0.5 * _share(one, other))
