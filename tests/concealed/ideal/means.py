"""What a shift of means and variances is worth beside what the baseline absorbs of it."""

from collections.abc import Sequence

import numpy as np

from tests.concealed.ideal.expected import Expected
from tests.concealed.ideal.quiet import Floats


def mean_deviance(plain: Sequence[Expected], hidden: Sequence[Expected]) -> float:
    """Return the deviance of the means: offset and responsivity of each pixel are free.

    Weighted least squares, pixel by pixel: sum of w d² less what a + b s takes of it, s the
    plain signal, w = 1/variance.
    """
    blocks = mean_signature(plain, hidden)
    between = float(sum((block**2).sum() for block in blocks))
    within = 0.0
    for clean, with_it in zip(plain, hidden, strict=True):
        shift = with_it.dn - clean.dn
        within += float(((shift - shift.mean(axis=0)) ** 2 / clean.variance[0]).sum())
    return between + within


def mean_signature(plain: Sequence[Expected], hidden: Sequence[Expected]) -> Floats:
    """Return shifts of block means over their standard errors, what is absorbed taken away.

    (n_blocks, n_rows, n_columns).
    """
    weight = np.stack([np.sqrt(b.scan.n_samples / b.variance[0]) for b in plain])
    shift = np.stack(
        [h.dn.mean(axis=0) - p.dn.mean(axis=0) for p, h in zip(plain, hidden, strict=True)]
    )
    signal = np.stack([b.signal.mean(axis=0) for b in plain])
    columns: list[Floats] = []
    for each in (np.ones_like(signal), signal):  # Gram-Schmidt, pixel by pixel
        column = weight * each
        for before in columns:
            column = column - before * (before * column).sum(axis=0)
        length = np.sqrt((column**2).sum(axis=0))
        enough = length > 1e-6 * np.sqrt(((weight * each) ** 2).sum(axis=0))
        columns.append(np.where(enough, column / np.maximum(length, 1e-300), 0.0))
    rest = weight * shift
    for column in columns:
        rest = rest - column * (column * rest).sum(axis=0)
    return np.asarray(rest)


def variance_deviance(plain: Sequence[Expected], excess: Sequence[Floats]) -> float:
    """Return the deviance of `excess` variance, DN²: system gain and read noise are free."""
    return float((variance_signature(plain, excess) ** 2).sum())


def variance_signature(plain: Sequence[Expected], excess: Sequence[Floats]) -> Floats:
    """Return excess variances over their standard errors, what is absorbed taken away.

    Args:
        plain: The blocks without what is hidden.
        excess: Of each block, what broadcasts to its pixels, beyond what its mean calls for.
    """
    rows = []
    for clean, more in zip(plain, excess, strict=True):
        variance, every = clean.variance[0], np.broadcast_to(more, clean.dn.shape).mean(axis=0)
        root = np.sqrt(0.5 * (clean.scan.n_samples - 1)) / variance
        rows.append((root, clean.signal[0], every))
    root, signal, every = (np.stack(each).ravel() for each in zip(*rows, strict=True))
    design = np.stack([np.ones_like(signal), signal / signal.max()], axis=1) * root[:, None]
    taken, *_ = np.linalg.lstsq(design, every * root, rcond=None)
    return np.asarray(root * every - design @ taken)


def excess_of(plain: Sequence[Expected], hidden: Sequence[Expected]) -> list[Floats]:
    """Return the variance beyond what the plain system gain makes of the hidden mean, DN²."""
    return [
        with_it.variance - clean.variance - clean.gain * (with_it.dn - clean.dn)
        for clean, with_it in zip(plain, hidden, strict=True)
    ]
