"""Cells of like signal are pooled into classes; cells that are not like the others are left out.

Variance is a bent function of the signal, and the mean of a bent function is not that of the mean:
over a class of width w (relative) a bend of size c, c·s² in the variance, adds c·s²·w²/12. With
w = 0.1 that is 8e-4 of the bend. A cell is a defect where its variance, block by block or over all
blocks, lies 6σ beside its class; as variances of few samples are skewed, cube roots are compared
(Wilson and Hilferty 1931), about the class's median, which defects do not pull, in units of the
scatter that is expected, or seen where that is larger (cells of a class differ a little in truth).
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.transfer.photon_transfer.cells import BlockCells

CLASS_WIDTH = 0.1
MOST_CLASSES = 12
_DEFECT_SIGMA = 6.0
_FEWEST = 8

Numbers = NDArray[np.intp]


def relative_signal(
    blocks: Sequence[BlockCells], offset_dn: Columns, tap: Numbers, full_scale_dn: int
) -> Columns:
    """Return each cell's signal relative to its tap's median, over the flats, (n_cells,)."""
    n_taps = int(tap.max()) + 1
    total = np.zeros(len(tap))
    n = 0
    for block in blocks:
        if block.block.kind != "flat":
            continue
        if float(np.median(block.mean_dn)) > 0.9 * full_scale_dn:
            continue
        signal = block.mean_dn - offset_dn
        medians = np.array([np.median(signal[tap == t]) for t in range(n_taps)])
        if (medians > 0).all():
            total += signal / medians[tap]
            n += 1
    return total / n if n else np.ones(len(tap))


def classes(relative: Columns, tap: Numbers) -> Numbers:
    """Return the class of each cell, counted from 0 within its tap."""
    found = np.zeros(len(tap), np.intp)
    for t in np.unique(tap):
        cells = np.flatnonzero(tap == t)
        low, high = np.quantile(relative[cells], [0.01, 0.99])
        n = int(np.clip(np.ceil((high - low) / CLASS_WIDTH), 1, MOST_CLASSES))
        edges = np.linspace(low, high, n + 1)[1:-1]
        number = np.digitize(relative[cells], edges)
        found[cells] = np.unique(number, return_inverse=True)[1]
    return found


def defects(
    blocks: Sequence[BlockCells], tap: Numbers, number: Numbers, usable: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return which cells' variances are not those of their class, (n_cells,).

    Args:
        blocks: The cells' statistics.
        tap: (n_cells,).
        number: Of the class, (n_cells,).
        usable: Where neither end of the code range is near, (n_blocks, n_cells).
    """
    group = tap * (int(number.max()) + 1) + number
    order = np.argsort(group, kind="stable")
    edges = np.flatnonzero(np.diff(group[order], prepend=-1, append=group.max() + 1))
    spans = [slice(a, b) for a, b in pairwise(edges.tolist())]
    total, count = np.zeros(len(tap)), np.zeros(len(tap))
    bad = np.zeros(len(tap), np.bool_)
    for block, use in zip(blocks, usable, strict=True):
        z = _deviation(block, order, use, spans)
        bad |= _is_far(z, spans)  # about a median that `_deviation` has made 0
        total += z
        count += use[order]
    found = np.empty(len(tap), np.bool_)
    over_all = total / np.sqrt(np.maximum(count, 1.0))
    for span in spans:
        over_all[span] -= np.median(over_all[span])
    found[order] = bad | _is_far(over_all, spans)
    return found


def _is_far(z: Columns, spans: Sequence[slice]) -> NDArray[np.bool_]:
    """Return which z lie far from 0, in units of their class's scatter or of 1."""
    found = np.zeros(len(z), np.bool_)
    for span in spans:
        rest = np.abs(z[span])
        if rest.max() > _DEFECT_SIGMA:
            found[span] = rest > _DEFECT_SIGMA * max(1.0, float(np.median(rest)) / 0.6745)
    return found


def _deviation(
    block: BlockCells, order: Numbers, use: NDArray[np.bool_], spans: Sequence[slice]
) -> Columns:
    """Return by how many standard deviations each cell's variance is off; 0 where it is unused.

    Cells are in `order`, in which the classes are `spans`.
    """
    root = np.cbrt(np.fmax(block.variance_dn2[order], 0.0))  # of NaN, 0
    third = np.sqrt(block.square_factor[order] / 9.0)
    used = use[order]
    z = np.zeros(len(root))
    for span in spans:
        own, good = root[span], used[span]
        chosen = own[good]
        if len(chosen) < _FEWEST:
            continue
        middle = float(np.median(chosen))
        if middle > 0:
            z[span] = np.where(good, (own - middle) / (middle * third[span]), 0.0)
    return z
