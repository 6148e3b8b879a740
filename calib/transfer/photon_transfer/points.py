"""The photon-transfer curve's points: signal, variance and covariances of a block's classes."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.kernels.difference_sums import Lag
from calib.transfer.photon_transfer.cells import BlockCells
from calib.transfer.photon_transfer.class_average import class_average, near_an_end
from calib.transfer.photon_transfer.classes import Numbers, classes, defects, relative_signal
from calib.transfer.photon_transfer.dark_level import DarkLevel, dark_level
from calib.transfer.photon_transfer.recorded_cells import RecordedCells


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
    tap, top = recorded.tap, recorded.full_scale_dn
    dark = dark_level(blocks, tap, recorded.pixels)
    number = classes(relative_signal(blocks, dark.offset_dn, tap, top), tap)
    usable = np.array([~near_an_end(b, top) for b in blocks])
    bad = defects(blocks, tap, number, usable)
    taps = tuple(
        _points(recorded, blocks, dark, number=number, bad=bad, tap=t)
        for t in range(int(tap.max()) + 1)
    )
    size = np.bincount(tap, recorded.pixels * ~bad).astype(np.float64)
    return Curve(taps, dark, int(bad.sum()), size)


def _points(
    recorded: RecordedCells,
    blocks: list[BlockCells],
    dark: DarkLevel,
    *,
    number: Numbers,
    bad: NDArray[np.bool_],
    tap: int,
) -> Points:
    rows = [
        class_average(
            recorded,
            block,
            dark,
            {"block": k, "number": int(c)},
            np.flatnonzero(members),
        )
        for k, block in enumerate(blocks)
        for c in np.unique(number[recorded.tap == tap])
        if (members := (recorded.tap == tap) & (number == c) & ~bad).any()
    ]
    lags = tuple(dict.fromkeys((r, abs(c)) for r, c in blocks[0].lags))
    names = [n for n in Points.__dataclass_fields__ if n not in {"tap", "lags"}]
    stacked = {n: np.array([row[n] for row in rows]) for n in names}
    for name in _TWO_DIMENSIONAL:
        stacked[name] = stacked[name].reshape(len(rows), len(lags)).T
    return Points(tap=tap, lags=lags, **stacked)
