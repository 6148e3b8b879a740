"""From exact sums of differences to the statistics of cells, biases undone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.difference_sums import STEPS_PER_DN, Lag, Steps
from calib.recording.header import Block
from calib.transfer.photon_transfer.band_sums import BandSums
from calib.transfer.photon_transfer.cells import BlockCells, CellLayout
from calib.transfer.photon_transfer.truncation import untruncated_share

_CENTRE_ROUNDING_DN2 = 1.0 / (12.0 * STEPS_PER_DN**2)
"""Variance of the rounding of what a tap shares."""


@dataclass(frozen=True)
class CommonSums:
    """Sums of what a tap's pixels share in a difference, DN, each (n_taps,).

    Attributes:
        n: How many differences.
        squares: Σ c².
    """

    n: int
    squares: NDArray[np.float64]

    @classmethod
    def zero(cls, n_taps: int) -> "CommonSums":
        """Return the sums over nothing."""
        return cls(0, np.zeros(n_taps))

    @classmethod
    def of(cls, centre: Steps) -> "CommonSums":
        """Return the sums over rows of (n_rows, n_taps)."""
        return cls(len(centre), ((centre / STEPS_PER_DN) ** 2).sum(axis=0))

    def __add__(self, other: "CommonSums") -> "CommonSums":
        """Return the sums over both."""
        return CommonSums(self.n + other.n, self.squares + other.squares)


def block_cells(
    block: Block,
    n_exposures: int,
    *,
    layout: CellLayout,
    bands: Sequence[BandSums],
    common: CommonSums,
    lags: tuple[Lag, ...],
    limit_dn: NDArray[np.float64],
) -> BlockCells:
    """Return a block's statistics; variances are NaN where there is no difference."""
    products = np.stack([b.lags.products for b in bands], axis=1).reshape(len(lags), -1)
    counts = np.stack([b.lags.counts for b in bands], axis=1).reshape(len(lags), -1)
    with np.errstate(invalid="ignore", divide="ignore"):
        half = products / (2.0 * STEPS_PER_DN**2 * counts)
    half[counts == 0] = np.nan
    limit = limit_dn.ravel()
    share = _share_kept(half[0], limit, layout)
    raw = half / np.concatenate([share[None], np.tile(share**2, (len(lags) - 1, 1))])
    tap = layout.tap.ravel()
    pixels = np.bincount(tap, layout.pixels, layout.n_taps)[tap].astype(np.float64)
    variance, mean_variance = _own_variance(raw[0], tap, pixels)
    covariance = _covariances(
        raw[1:], variance, mean_variance, lags=lags[1:], layout=layout, pixels=pixels
    )
    possible = layout.pixels * max(n_exposures - 1, 0)
    square, cumulant = variance_of_variance(n_exposures, layout.pixels)
    return BlockCells(
        block=block,
        n_exposures=n_exposures,
        mean_dn=np.concatenate([b.codes.mean_dn for b in bands]),
        variance_dn2=variance,
        covariance_dn2=covariance if layout.is_area else covariance[:-1],
        lags=lags[1:] if layout.is_area else lags[1:-1],
        lag_share=_lag_share(counts, layout),
        square_factor=square,
        cumulant_factor=cumulant,
        clipped_share=np.concatenate(
            [(b.codes.at_zero + b.codes.at_full_scale) / max(b.codes.n_lines, 1) for b in bands]
        ),
        limit_dn=limit,
        rejected_share=float(1.0 - counts[0].sum() / max(possible.sum(), 1.0)),
        common_dn2=_common_variance(common, mean_variance, tap, pixels, layout.n_taps),
        line_covariance_dn2=_line_covariance(raw, pixels, layout),
    )


def variance_of_variance(n_exposures: int, pixels: Columns) -> tuple[Columns, Columns]:
    """Return a and b of var V = a·V² + b·κ4 for all consecutive differences.

    Args:
        n_exposures: Lines or frames; with fewer than 2 both are infinite.
        pixels: Of each cell.
    """
    differences = n_exposures - 1
    if differences < 1:
        return np.full(len(pixels), np.inf), np.full(len(pixels), np.inf)
    square = (3.0 * differences - 1.0) / differences**2
    cumulant = (differences - 0.5) / differences**2
    return square / pixels, cumulant / pixels


def _lag_share(counts: NDArray[np.int64], layout: CellLayout) -> Columns:
    """Return how many products there are at each lag but none, by those at none."""
    kept = counts[1:] if layout.is_area else counts[1:-1]
    return np.asarray(kept.max(axis=1, initial=0) / max(int(counts[0].max(initial=0)), 1))


def _share_kept(half: Columns, limit: Columns, layout: CellLayout) -> Columns:
    """Return f of each cell, from the variance that cells of like limit have together."""
    tap = layout.tap.ravel()
    share = np.ones(len(half))
    known = np.isfinite(half) & np.isfinite(limit)
    order = np.lexsort((limit, tap))
    order = order[known[order]]
    if not len(order):
        return share
    first = np.flatnonzero(np.r_[True, np.diff(tap[order]) > 0] | (np.arange(len(order)) % 32 == 0))
    size = np.diff(np.r_[first, len(order)])
    relative = np.add.reduceat(2.0 * half[order] / limit[order] ** 2, first) / size
    share[order] = np.repeat(untruncated_share(relative, np.ones(len(first))), size)
    return share


def _own_variance(
    observed: Columns, tap: NDArray[np.intp], pixels: Columns
) -> tuple[Columns, Columns]:
    """Return the pixels' variance, and its mean over the tap, with the common mean's share back.

    Of a difference less the mean of m pixels, half the mean square of pixel i is
    V_i·(1 − 2/m) + V̄/m, which averages to V̄·(1 − 1/m).
    """
    known = np.isfinite(observed)
    count = np.bincount(tap, known * 1.0)[tap]
    average = (np.bincount(tap, np.where(known, observed, 0.0))[tap]) / np.maximum(count, 1.0)
    mean = average / np.maximum(1.0 - 1.0 / pixels, 1e-9)
    own = (observed - mean / pixels) / np.maximum(1.0 - 2.0 / pixels, 1e-9)
    return own - _CENTRE_ROUNDING_DN2 / 2.0, mean


def _covariances(
    observed: NDArray[np.float64],
    variance: Columns,
    mean: Columns,
    *,
    lags: tuple[Lag, ...],
    layout: CellLayout,
    pixels: Columns,
) -> NDArray[np.float64]:
    """Return covariances of neighbours in which the common mean's share is put back.

    Of pixels i, j of one tap it took (V_i + V_j − V̄)/m; of pixels of two taps nothing.
    """
    found = np.empty_like(observed)
    tap = layout.tap
    for k, lag in enumerate(lags):
        beyond = np.clip(np.arange(layout.columns) + lag[1], 0, layout.columns - 1)
        other = variance.reshape(tap.shape)[:, beyond].ravel()
        same = (tap[:, beyond] == tap).ravel()
        taken = np.where(same, (variance + other - mean) / pixels, 0.0)
        found[k] = np.where(layout.are_neighbours(lag), observed[k] + taken, np.nan)
    return found


def _common_variance(
    common: CommonSums,
    mean_variance: Columns,
    tap: NDArray[np.intp],
    pixels: Columns,
    n_taps: int,
) -> Columns:
    """Return the variance of what a tap shares beyond the mean of its pixels' own noise, DN²."""
    if common.n == 0:
        return np.full(n_taps, np.nan)
    first = np.array([np.flatnonzero(tap == t)[0] for t in range(n_taps)])
    return np.asarray(common.squares / (2.0 * common.n) - (mean_variance / pixels)[first])


def _line_covariance(raw: NDArray[np.float64], pixels: Columns, layout: CellLayout) -> Columns:
    """Return γ1 − γ2 along the lines: half the differences' variance and their lag-1 covariance.

    With autocovariances γ of the lines, half the differences' products are γ0 − γ1 at lag 0 and
    (2γ1 − γ0 − γ2)/2 at lag 1.
    """
    if layout.is_area:
        return np.full(len(pixels), np.nan)
    return np.asarray((raw[0] + 2.0 * raw[-1]) / (1.0 - 1.0 / np.maximum(pixels, 2.0)))
