"""Pixels whose codes grow with the exposure, whatever the light, far more than all others' do.

Each pixel's block means are fitted by offset + slope dose + growth exposure (weighted least
squares). Its growth is as uncertain as its own samples scatter, and where its means miss the fit by
more than that, by as much more (Birge, Phys. Rev. 40, 207 (1932)): a pixel that jumps does not pass
for one that grows, and one that grows along a curve still does.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.noisy import beyond, few

Floats = NDArray[np.float64]

CLEAR = 16.0
"""Deviance beyond 2 ln(pixels), what the largest of all has by chance."""


@dataclass(frozen=True)
class Growing:
    """Pixels that grow with the exposure.

    Attributes:
        pixels: Their flat indices, (n,).
        dn_per_us: By how much beyond the typical pixel, (n,).
        variance_dn2: Of their samples, as far as their means tell, (n_blocks, n).
    """

    pixels: NDArray[np.intp]
    dn_per_us: Floats
    variance_dn2: Floats

    def without(self, others: NDArray[np.intp]) -> "Growing":
        """Return those of them that are not among `others`."""
        kept = ~np.isin(self.pixels, others)
        return Growing(self.pixels[kept], self.dn_per_us[kept], self.variance_dn2[:, kept])


def growing_pixels(
    sums: Sequence[BlockSums], table: ConditionsTable, sensor: Sensor, baseline: Baseline
) -> Growing:
    """Return the pixels that stand out; none where the plan tells no growth, or where many do."""
    means = np.stack([each.mean_dn.ravel() for each in sums])
    means = means - baseline.mean_dn.reshape(means.shape)
    usable = baseline.usable.reshape(means.shape)
    # What all pixels of a block do is no pixel's own.
    common = np.array(
        [np.median(m[u]) if u.any() else 0.0 for m, u in zip(means, usable, strict=True)]
    )
    variance = np.maximum(_measured(sums, sensor), baseline.variance_dn2.reshape(means.shape))
    n = np.array([each.n_lines for each in sums], np.float64)
    weight = np.where(usable, n[:, None] / variance, 0.0)
    dose = baseline.dose.reshape(means.shape)
    growth, std, excess = fitted_growth(means - common[:, None], weight, dose, table.exposure_us)
    told = np.isfinite(std)
    z = np.where(told, growth / np.where(told, std, 1.0), 0.0)
    z = beyond(z, z[told] if told.any() else np.zeros(1))
    pixels = few(np.flatnonzero(told & (z > np.sqrt(CLEAR + 2.0 * log(len(z))))), len(z))
    typical = float(np.median(growth[told])) if told.any() else 0.0
    rate = (growth[pixels] - typical) / float(table.exposure_us.max())
    keep = rate > 0
    pixels, rate = pixels[keep], rate[keep]
    return Growing(pixels, rate, variance[:, pixels] * excess[pixels])


def fitted_growth(
    means: Floats, weight: Floats, dose: Floats, exposure_us: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return each pixel's growth in the longest exposure, its std, and excess of variance.

    Args:
        means: To be fitted by offset, slope and growth, DN, (n_blocks, n_pixels).
        weight: Inverse variances, likewise.
        dose: What the slope multiplies, likewise.
        exposure_us: What the growth multiplies, (n_blocks,): exposures, or what counts as such.
    """
    exposure = np.broadcast_to(exposure_us[:, None], means.shape)
    return _fitted(means, weight, np.stack([np.ones_like(means), _scaled(dose), _scaled(exposure)]))


def _scaled(values: Floats) -> Floats:
    return np.asarray(values / max(float(values.max()), 1e-300))


def _measured(sums: Sequence[BlockSums], sensor: Sensor) -> Floats:
    """Return the variance of each pixel's samples, DN^2, (n_blocks, n_pixels)."""
    size = max(sensor.n_columns / sensor.n_taps, 2.0)
    return np.stack(
        [x.products.squares.ravel() / max(x.n_lines - 1, 1) / (1.0 - 1.0 / size) for x in sums]
    )


def _fitted(means: Floats, weight: Floats, regressors: Floats) -> tuple[Floats, Floats, Floats]:
    """Return each pixel's last coefficient, its std (inf: not told), and excess of variance."""
    k = len(regressors)
    normal = np.einsum("ibp,bp,jbp->pij", regressors, weight, regressors)
    right = np.einsum("ibp,bp,bp->pi", regressors, weight, means)
    size = np.sqrt(np.maximum(np.einsum("pii->pi", normal), 1e-300))
    scaled = normal / (size[:, :, None] * size[:, None, :])
    told = (np.linalg.eigvalsh(scaled)[:, 0] > 1e-6) & ((weight > 0).sum(axis=0) > k)
    inverse = np.zeros_like(normal)
    inverse[told] = np.linalg.inv(scaled[told]) / (size[:, :, None] * size[:, None, :])[told]
    found = np.einsum("pij,pj->pi", inverse, right)
    missed = np.einsum(
        "bp,bp->p", weight, (means - np.einsum("ibp,pi->bp", regressors, found)) ** 2
    )
    freedom = np.maximum((weight > 0).sum(axis=0) - k, 1)
    excess = np.maximum(missed / freedom, 1.0)
    std = np.where(told, np.sqrt(np.maximum(inverse[:, -1, -1], 0.0) * excess), np.inf)
    return found[:, -1], std, excess
