"""Gathers the codes of each tap's darks, and the means of their pixels."""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.dark_codes import DarkCodes

Floats = NDArray[np.float64]

LOW, HIGH = 14.0, 8.0
"""So many standard deviations below and above the middle codes are told apart: a hot pixel has none
of its own."""
REACH = 6.0
"""Pixels so many standard deviations beyond those have no sample among them."""
WIDEST_DN = 250.0
"""Of wider noise tables of chances would be large."""
GROUPED = 0.02
"""Of a standard deviation: pixels whose means are as close are taken for one."""
FEWEST_LINES = 16
"""Of fewer, a pixel's own mean follows its samples."""


def dark_codes(evidence: Evidence) -> tuple[DarkCodes | None, ...]:
    """Return what the darks of each tap give; None of one that has too few lines of them."""
    base = evidence.baseline
    dark = (base.dose.max(axis=(1, 2)) == 0.0) & (evidence.n >= FEWEST_LINES)
    blocks = np.flatnonzero(dark).tolist()
    return tuple(_of_tap(tap, blocks, evidence) for tap in range(evidence.sensor.n_taps))


def _of_tap(tap: int, blocks: list[int], evidence: Evidence) -> DarkCodes | None:
    if not blocks:
        return None
    of_tap = evidence.sensor.tap == tap
    sums = [evidence.sums[b] for b in blocks]
    means = np.concatenate([each.mean_dn[of_tap] for each in sums])
    weight = np.concatenate([np.full(of_tap.sum(), float(each.n_lines)) for each in sums])
    squares = sum(float(each.products.squares[of_tap].mean()) for each in sums)
    variance = squares / sum(each.n_lines for each in sums) - 1.0 / 12.0
    std = max(float(np.sqrt(max(variance, 0.0))), 0.2)
    counts = np.sum([each.by_code[tap] for each in sums], axis=0)
    if std > WIDEST_DN:
        return None
    middle = float(np.median(means))
    first = max(int(middle - LOW * std), 0)
    last = min(int(middle + HIGH * std) + 2, len(counts) - 1)
    seen = counts[first : last + 1].astype(np.float64)
    seen[0], seen[-1] = seen[0] + counts[:first].sum(), seen[-1] + counts[last + 1 :].sum()
    held = np.clip(means, first - REACH * std, last + REACH * std)
    return DarkCodes(seen, first, *_together(held, weight, std * GROUPED), std)


def _together(means: Floats, weight: Floats, width: float) -> tuple[Floats, Floats]:
    """Return the means of pixels that are alike to a `width`, and their weights, (n,) each."""
    _, which = np.unique(np.rint(means / width), return_inverse=True)
    whole = np.bincount(which, weight).astype(np.float64)
    return np.bincount(which, weight * means) / whole, whole
