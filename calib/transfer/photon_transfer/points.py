"""The photon-transfer curve's points: signal, variance and covariances of a block's classes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.kernels.difference_sums import Lag
from calib.rounded_scatter import rounded_scatter
from calib.transfer.photon_transfer.class_average import class_averages
from calib.transfer.photon_transfer.classes import Numbers
from calib.transfer.photon_transfer.dark_level import DarkLevel
from calib.transfer.photon_transfer.prepared import prepare
from calib.transfer.photon_transfer.recorded_cells import RecordedCells
from calib.transfer.photon_transfer.variance_curve import rounded_variance


@dataclass(frozen=True)
class Points:
    """Points of one tap, in the order of blocks and classes; arrays (n_points,).

    Attributes:
        tap: Which.
        block: Number of the block among the recording's darks and flats.
        number: Of the class within the tap.
        is_dark: Whether the block is capped.
        exposure_us: Of the block.
        level: Of the block.
        mean_dn: Mean code.
        signal_dn: Above the dark level; above code 0 where there are no darks.
        spread: Relative variance of the signal among the class's cells.
        variance_dn2: Temporal.
        square_factor: a in var(variance) = a·V² + b·κ4.
        cumulant_factor: b.
        phase_factor: Share of S² (`unrounding`) that unknown phases add to var(variance).
        lever: By how much more they err for what was undone of rounding; 1 where nothing was.
        covariance_dn2: Of neighbours, lags on both sides averaged, (n_lags, n_points).
        covariance_factor: c in var(covariance) = c·V², as `covariance_dn2`.
        lags: (rows, columns), not negative.
        pixels: How many.
        samples: How many codes the mean is from.
        ends: True where codes come too near to either end of their range.
    """

    tap: int
    block: Numbers
    number: Numbers
    is_dark: NDArray[np.bool_]
    exposure_us: Columns
    level: Columns
    mean_dn: Columns
    signal_dn: Columns
    spread: Columns
    variance_dn2: Columns
    square_factor: Columns
    cumulant_factor: Columns
    phase_factor: Columns
    lever: Columns
    covariance_dn2: NDArray[np.float64]
    covariance_factor: NDArray[np.float64]
    lags: tuple[Lag, ...]
    pixels: Columns
    samples: Columns
    ends: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.block)

    def where(self, use: NDArray[np.bool_]) -> "Points":
        """Return the points in `use`."""
        one = {
            name: getattr(self, name)[use]
            for name, value in vars(self).items()
            if isinstance(value, np.ndarray) and value.ndim == 1
        }
        two = {name: getattr(self, name)[:, use] for name in _TWO_DIMENSIONAL}
        return replace(self, **one, **two)

    def variance_variance(self, before_dn2: Columns, fourth_dn4: Columns) -> Columns:
        """Return how the variances vary by statistics and by unknown phases of rounding, DN⁴.

        Args:
            before_dn2: The expected variances before rounding.
            fourth_dn4: κ4 before rounding.
        """
        # Below, an error of 0 would give all weight to what is least known.
        before = np.maximum(before_dn2, _LEAST_DN2)
        scatter, known = rounded_scatter(np.sqrt(before)), self.phase_factor == 0
        own = self.square_factor * (rounded_variance(before) ** 2 + scatter.variance_spread_dn4)
        fourth = fourth_dn4 + scatter.fourth_cumulant_dn4 + known * scatter.restored_dn4
        own = (own + self.cumulant_factor * fourth) * self.lever**2
        return np.asarray(own + self.phase_factor * scatter.variance_spread_dn4)


_LEAST_DN2 = 0.05**2
_TWO_DIMENSIONAL = ("covariance_dn2", "covariance_factor")


@dataclass(frozen=True)
class Curve:
    """All taps' points, and what they are from.

    Attributes:
        taps: The points of each tap.
        dark: The dark level of the cells.
        defects: How many cells were left out as their variance is not that of their class.
        pixels: Of each tap, (n_taps,).
    """

    taps: tuple[Points, ...]
    dark: DarkLevel
    defects: int
    pixels: Columns


def curve_of(recorded: RecordedCells) -> Curve:
    """Return the points of every tap.

    Raises:
        NotDeterminedError: `no-temporal-noise` where no flat has two exposures or more.
    """
    blocks = [b for b in recorded.blocks if np.isfinite(b.square_factor).any()]
    if not any(b.block.kind == "flat" for b in blocks):
        message = (
            "No block of flats has two lines (frames) or more, so that there is no temporal noise "
            "to look at: record flats of many lines at several exposures."
        )
        raise NotDeterminedError(message, code="no-temporal-noise")
    tap = recorded.tap
    prepared = prepare(recorded, blocks)
    if not len(prepared.members.cells):
        raise NotDeterminedError(
            "No cell's darks and flats lie between the ends of the code range.",
            code="photon-transfer-range",
        )
    n_darks = sum(b.block.kind == "dark" for b in blocks)
    rows = [
        class_averages(prepared.members, prepared.dark, seen, n_darks) for seen in prepared.blocks
    ]
    n_taps = int(tap.max()) + 1
    taps = tuple(_points(rows, prepared.members.tap, t, blocks[0].lags) for t in range(n_taps))
    size = np.bincount(prepared.members.tap, prepared.members.size, n_taps).astype(np.float64)
    return Curve(taps, prepared.dark, prepared.defects, size)


def _points(
    rows: Sequence[dict[str, NDArray[np.generic]]],
    tap_of_class: Numbers,
    tap: int,
    lags: tuple[Lag, ...],
) -> Points:
    """Stack the blocks' classes of one tap."""
    own = tap_of_class == tap
    stacked = {n: np.concatenate([row[n][..., own] for row in rows], axis=-1) for n in rows[0]}
    block = np.repeat(np.arange(len(rows)), int(own.sum()))
    apart = tuple(dict.fromkeys((r, abs(c)) for r, c in lags))
    return Points(tap=tap, block=block, lags=apart, **stacked)
