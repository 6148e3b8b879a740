"""What two draws of an effect have in common: the rest of each is chance."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.noisy import NOISY_SIGMA, few

Floats = NDArray[np.float64]

PIECES = 24
"""Of the range of signals, in each of which a law of the signal is straight: a bend like a square
misses its chord by (1/24)^2 / 4 of its end at most, 0.04 %."""
EDGES = (0.005, 0.995)
"""Quantiles of a block's signals between which its knots lie: single pixels are no profile."""


def reproduced(
    one: Change,
    other: Change,
    evidence: Evidence,
    moved_dn: Floats,
    sure_dn: Floats,
    *,
    exact: bool,
) -> Change:
    """Return the mean of two draws, each part of it shrunk by how badly the other repeats it.

    Args:
        one: A draw.
        other: Another.
        evidence: The recording.
        moved_dn: What the links' own means have moved by, (n_blocks, n_pixels).
        sure_dn: The same with what effects without a pattern of chance do beside it: chance has no
            part in either, and each pixel keeps its own.
        exact: Whether means are alike in both.
    """
    # Of the histogram nothing is drawn.
    half = (replace(one, codes=other.codes) + other) * 0.5
    first = (evidence.baseline.mean_dn - evidence.baseline.offset_dn).reshape(one.means.shape)
    means = one.means
    if not exact:
        added = np.stack([_of_quiet(each, evidence, sure_dn) for each in (one, other)])
        means = sure_dn + _shrunk(*_along_profile(added, first + moved_dn))
    white = [evidence.pooled.over_std(c.pooled) for c in (one, other)]
    pooled = half.pooled.copy()
    for where in evidence.pooled.places.values():
        pooled[:, where] *= _share(white[0][:, where], white[1][:, where])
    return Change(
        means, _shrunk(one.onset, other.onset), pooled, half.rare,
        one.pixel_variance, one.codes, half.tones, one.pixel_misfit,
    )  # fmt: skip


def _of_quiet(change: Change, evidence: Evidence, sure_dn: Floats) -> Floats:
    """Return what is added to the means, but of pixels that would be left out for their noise."""
    z = change.pixel_variance * np.sqrt((evidence.n - 1).sum() / 2.0)
    misfit = evidence.misfit(change.means, observed=False)
    noisy = few(np.flatnonzero((z > NOISY_SIGMA) | (misfit > NOISY_SIGMA)), len(z))
    means = change.means - sure_dn
    means[:, noisy] = 0.0
    return means


def _along_profile(means: Floats, signal: Floats) -> Floats:
    """Return each block's means of some draws fitted by functions of its own profile of signal.

    Of hats between knots: straight over a flat's narrow profile, and over each of `PIECES` pieces
    of the recording's range in a scene, where a bend may set in within the block.

    Args:
        means: Of all draws, (n_draws, n_blocks, n_pixels).
        signal: What they all are functions of, (n_blocks, n_pixels).
    """
    piece = max(float(np.ptp(signal)), 1e-12) / PIECES
    along = [_along(means[:, b], own, piece) for b, own in enumerate(signal)]
    return np.stack(along, axis=1)


def _along(means: Floats, signal: Floats, piece: float) -> Floats:
    """Return one block's means, (n_draws, n_pixels), fitted by hats as wide as about `piece`."""
    low, high = (float(edge) for edge in np.quantile(signal, EDGES))
    if high - low <= 1e-6 * piece:
        return np.broadcast_to(means.mean(axis=1, keepdims=True), means.shape)
    knots = np.linspace(low, high, 2 + int((high - low) / piece))
    at = (signal - low) / (knots[1] - knots[0])
    left = np.clip(np.floor(at), 0, len(knots) - 2).astype(np.intp)
    share, pixels = at - left, np.arange(len(signal))
    hats = np.zeros((len(signal), len(knots)))
    hats[pixels, left] = 1.0 - share
    hats[pixels, left + 1] = share
    return np.asarray((hats @ np.linalg.lstsq(hats, means.T)[0]).T)


def _share(one: Floats, other: Floats) -> float:
    """Return which share of the mean's energy is not chance, from what two draws have in common."""
    mean2 = float(((one + other) ** 2).sum()) / 4
    noise2 = float(((one - other) ** 2).sum()) / 4
    return max(0.0, 1.0 - 1.3 * noise2 / mean2) if mean2 > 0 else 0.0


def _shrunk(one: Floats, other: Floats) -> Floats:
    return np.asarray((one + other) * 0.5 * _share(one, other))
