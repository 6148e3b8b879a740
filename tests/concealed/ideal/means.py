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
    shape = plain[0].scan.sensor.shape
    normal, right, total = np.zeros((*shape, 2, 2)), np.zeros((*shape, 2)), np.zeros(shape)
    for clean, with_it in zip(plain, hidden, strict=True):
        weight = 1.0 / clean.variance[0]
        design = np.stack([np.ones(shape), clean.signal[0]], axis=-1)
        n = clean.scan.n_samples
        shift = with_it.dn - clean.dn
        normal += n * weight[..., None, None] * design[..., :, None] * design[..., None, :]
        right += (weight * shift.sum(axis=0))[..., None] * design
        total += weight * (shift**2).sum(axis=0)
    scale = np.sqrt(np.einsum("...ii->...i", normal)) + 1e-300
    scaled = normal / scale[..., :, None] / scale[..., None, :]
    taken = np.linalg.pinv(scaled, rcond=1e-9, hermitian=True) @ (right / scale)[..., None]
    absorbed = np.einsum("...i,...i->...", right / scale, taken[..., 0])
    return float(np.clip(total - absorbed, 0.0, None).sum())


def variance_deviance(plain: Sequence[Expected], excess: Sequence[Floats]) -> float:
    """Return the deviance of `excess` variance, DN²: system gain and read noise are free.

    Args:
        plain: The blocks without what is hidden.
        excess: Of each block, what broadcasts to its pixels, beyond what its mean calls for.
    """
    rows = []
    for clean, more in zip(plain, excess, strict=True):
        variance, every = clean.variance[0], np.broadcast_to(more, clean.dn.shape).mean(axis=0)
        weight = 0.5 * (clean.scan.n_samples - 1) / variance**2
        rows.append((weight, clean.signal[0], every))
    weight, signal, every = (np.stack(each).ravel() for each in zip(*rows, strict=True))
    design = np.stack([np.ones_like(signal), signal / signal.max()], axis=1)
    root = np.sqrt(weight)
    taken, *_ = np.linalg.lstsq(design * root[:, None], every * root, rcond=None)
    return float(((root * (every - design @ taken)) ** 2).sum())


def excess_of(plain: Sequence[Expected], hidden: Sequence[Expected]) -> list[Floats]:
    """Return the variance beyond what the plain system gain makes of the hidden mean, DN²."""
    return [
        with_it.variance - clean.variance - clean.gain * (with_it.dn - clean.dn)
        for clean, with_it in zip(plain, hidden, strict=True)
    ]
