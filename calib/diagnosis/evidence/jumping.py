"""Pixels whose samples scatter more than their means explain, by the same variance in all blocks.

A pixel that jumps between two levels a apart, and is up for the share u of the time, has the
variance a^2 u (1 - u) beside that of its noise, whatever the light and however long it is gathered,
and stays in its level for some time (Kirton and Uren, Adv. Phys. 38, 367 (1989)): what it differs
by lasts from line to line, or does not where it jumps often, whichever is clearer. Blocks of little
noise tell most of what is added. What dark current or light makes of a pixel's noise grows with
them, and is told from jumps by which of the two explains more of it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.growing import CLEAR
from calib.diagnosis.evidence.pixel_scatter import (
    MOST_OF_A_BLOCK,
    lasting_scatter,
    white_scatter,
)
from calib.diagnosis.statistics.noisy import beyond, few

Floats = NDArray[np.float64]

SHOWS = 2.0
"""Standard deviations by which a block's variance is at least larger, where jumps add 5.5."""
ALIKE = 0.95
"""What grows explains so much more before it is preferred: of two exposures, one twice the other,
a constant explains 0.9 of what grows with them; of two dark blocks of one exposure, all of it."""


@dataclass(frozen=True)
class Jumping:
    """Pixels that jump.

    Attributes:
        pixels: Their flat indices, (n,).
        variance_dn2: What jumps add to the variance of each, (n,).
        deviance: That it explains of each one's variances, (n,).
    """

    pixels: NDArray[np.intp]
    variance_dn2: Floats
    deviance: Floats

    @property
    def amplitude_dn(self) -> float:
        """Height of the jumps, if the pixel that scatters most is up for half of the time."""
        return 2.0 * float(np.sqrt(self.variance_dn2.max()))


def jumping_pixels(evidence: Evidence) -> Jumping:
    """Return the pixels that jump; none where they are many."""
    expected = expected_variance(evidence)
    white, lasting = (each(evidence, expected) for each in (white_scatter, lasting_scatter))
    lasts = beyond(lasting.sigma, lasting.sigma) > beyond(white.sigma, white.sigma)
    # The largest of all has 2 ln(pixels) by chance.
    clear = np.sqrt(CLEAR + 2.0 * np.log(len(lasts)))
    scatter = lasting.where(lasts, white)
    weight, excess, z = scatter.weight, scatter.excess, scatter.sigma
    far = np.where(lasts, beyond(z, lasting.sigma), beyond(z, white.sigma)) > clear
    ones = np.ones((evidence.n_blocks, 1))
    exposure = evidence.table.exposure_us[:, None] * ones
    light = np.maximum(evidence.signal_dn, 0.0)[:, None]
    for grown in (exposure, light, light**2):
        far &= _explained(weight, excess, ones) > ALIKE * _explained(weight, excess, grown)
    pixels = few(np.flatnonzero(far), len(z))
    added = np.average(excess[:, pixels], axis=0, weights=weight[:, pixels])
    added = np.maximum(added, 0.0)
    shows = _shows_where_it_would(np.sqrt(weight[:, pixels]), excess[:, pixels], added)
    pixels, added = pixels[shows], added[shows]
    of_squares = _deviance(evidence.n, expected[:, pixels], added)
    return Jumping(pixels, added, np.maximum(of_squares, np.where(lasts, z, 0.0)[pixels] ** 2))


def _shows_where_it_would(root: Floats, excess: Floats, added: Floats) -> NDArray[np.bool_]:
    """Return whether what is added shows in most blocks in which it would, (n_pixels,).

    Two rays that happen to hit a pixel in two dark blocks raise no other block's variance.
    """
    would = root * added > MOST_OF_A_BLOCK
    shows = would & (root * excess > SHOWS)
    return np.asarray(2 * shows.sum(axis=0) >= would.sum(axis=0))


def _deviance(n: Floats, expected: Floats, added: Floats) -> Floats:
    """Return by how much variances of n normal samples fit better with what is added, (n_pixels,).

    Twice the logarithm of the likelihood ratio is (n - 1) (r - 1 - ln r), r the ratio of variances.
    """
    ratio = 1.0 + added / expected
    return np.asarray(((n[:, None] - 1.0) * (ratio - 1.0 - np.log(ratio))).sum(axis=0))


def expected_variance(evidence: Evidence) -> Floats:
    """Return the variance of each pixel's samples, dark charge's shot noise with it."""
    expected = evidence.baseline.variance_dn2.reshape(evidence.n_blocks, -1).copy()
    growing = evidence.growing
    if growing is not None:
        gain = evidence.baseline.gain_dn_per_e[evidence.sensor.tap].ravel()[growing.pixels]
        grown = np.outer(evidence.table.exposure_us, growing.dn_per_us)
        expected[:, growing.pixels] += np.maximum(gain, 0.0) * grown
    return expected


def _explained(weight: Floats, excess: Floats, shape: Floats) -> Floats:
    """Return the deviance that `shape`, (n_blocks, 1), explains of each pixel's excess."""
    length2 = np.maximum((weight * shape**2).sum(axis=0), 1e-300)
    return np.asarray(np.maximum((weight * shape * excess).sum(axis=0), 0.0) ** 2 / length2)
