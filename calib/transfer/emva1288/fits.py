"""Which blocks each of the standard's straight lines is drawn through, chosen once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from calib.transfer.emva1288.block_figures import CHANCE
from calib.transfer.emva1288.saturation import SaturationPoint
from calib.transfer.emva1288.series import Series

TRANSFER_RANGE = (0.0, 0.70)
LINEARITY_RANGE = (0.05, 0.95)
Weights = NDArray[np.float64]


@dataclass(frozen=True)
class DarkLine:
    """A straight line through darks against exposure; what it reads of them is linear in them.

    Attributes:
        darks: Their indices.
        intercept: Weights that make the value at no exposure of them.
        slope: Weights that make the change per second of them; empty of one exposure.
    """

    darks: tuple[int, ...]
    intercept: Weights
    slope: Weights


@dataclass(frozen=True)
class Fits:
    """The flats and darks that count.

    Attributes:
        transfer: Indices of the flats in 0 … 70 % of saturation, for K and R.
        linearity: Indices of the flats in 5 … 95 %.
        means: The darks' lines of the mean, temperature by temperature.
        variances: The darks' lines of the temporal variance.
    """

    transfer: NDArray[np.int64]
    linearity: NDArray[np.int64]
    means: tuple[DarkLine, ...]
    variances: tuple[DarkLine, ...]


def fits_of(series: Series, point: SaturationPoint) -> Fits:
    """Choose them."""
    dark = np.array([series.darks[k].mean_dn for k in series.dark_of])
    share = (np.array([f.mean_dn for f in series.flats]) - dark) / point.reference_dn
    clipped = np.array([f.share_at_full_scale > 0.002 for f in series.flats])
    order = np.arange(len(share))
    inside = ~clipped & ((order <= point.step) | (point.step < 0))
    lowest, highest = LINEARITY_RANGE
    linear = inside & (share >= lowest) & (share <= highest)
    return Fits(
        transfer=np.flatnonzero(inside & (share <= TRANSFER_RANGE[1])),
        linearity=np.flatnonzero(linear),
        means=tuple(_dark_line(series, group, extra=0) for group in series.temperatures),
        variances=tuple(_dark_line(series, group, extra=1) for group in series.temperatures),
    )


def _dark_line(series: Series, group: tuple[int, ...], extra: int) -> DarkLine:
    """Weigh darks by their frames less `extra`, as a mean or a variance gains from them."""
    t_s = np.array([series.darks[k].block.exposure_us for k in group]) * 1e-6
    weight = np.array([series.darks[k].n_frames - extra for k in group], dtype=np.float64)
    weight /= weight.sum()
    centre = float(np.sum(weight * t_s))
    spread = float(np.sum(weight * (t_s - centre) ** 2))
    n_exposures = len({round(each, 12) for each in t_s.tolist()})
    if n_exposures < 2:
        return DarkLine(group, weight, np.array([]))
    slope = weight * (t_s - centre) / spread
    if n_exposures < 3:  # two make no line that could be checked: the shorter stands for both
        shortest = np.where(t_s == t_s.min(), weight, 0.0)
        return DarkLine(group, shortest / shortest.sum(), slope)
    return DarkLine(group, weight - centre * slope, slope)


def misfit(residual: Weights, std: Weights, free: int) -> float:
    """Return by how much residuals exceed their noise: √(χ²/ν), or 1 where chance may do it."""
    if free < 1 or not np.all(std > 0):
        return 1.0
    squared = float(np.sum((residual / std) ** 2))
    return float(np.sqrt(squared / free)) if squared > chi2.isf(CHANCE, free) else 1.0
