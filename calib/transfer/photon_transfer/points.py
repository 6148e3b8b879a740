"""The photon-transfer curve's points: signal, variance and covariances of a block's classes."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.kernels.pair_sums import Lag
from calib.transfer.photon_transfer.cells import BlockCells
from calib.transfer.photon_transfer.classes import Numbers, classes, defects, relative_signal
from calib.transfer.photon_transfer.dark_level import DarkLevel, dark_level
from calib.transfer.photon_transfer.recorded_cells import RecordedCells

_NEAR_AN_END_SIGMA = 4.5
"""What is cut off there changes the variance by 1e-4 and less."""
_MOST_CLIPPED = 1e-4


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
    usable = np.array([~_near_an_end(b, top) for b in blocks])
    bad = defects(blocks, tap, number, usable)
    taps = tuple(
        _points(recorded, blocks, dark, number=number, bad=bad, tap=t)
        for t in range(int(tap.max()) + 1)
    )
    size = np.bincount(tap, recorded.pixels * ~bad).astype(np.float64)
    return Curve(taps, dark, int(bad.sum()), size)


def _near_an_end(block: BlockCells, full_scale_dn: int) -> NDArray[np.bool_]:
    width = _NEAR_AN_END_SIGMA * np.sqrt(np.maximum(np.nan_to_num(block.variance_dn2), 0.0))
    near = (block.mean_dn + width >= full_scale_dn) | (block.mean_dn - width <= 0)
    return np.asarray(near | (block.clipped_share > _MOST_CLIPPED))


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
        _point(
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


def _point(
    recorded: RecordedCells,
    block: BlockCells,
    dark: DarkLevel,
    named: dict[str, object],
    cells: Numbers,
) -> dict[str, object]:
    """Return the averages over a class's cells, each pixel with the same weight."""
    pixels = recorded.pixels[cells]
    share = pixels / pixels.sum()
    known = np.isfinite(block.variance_dn2[cells])
    mean = float((share * block.mean_dn[cells]).sum())
    own = block.mean_dn[cells] - dark.offset_dn[cells]
    is_dark = block.block.kind == "dark"
    signal = float((share * own).sum())
    if is_dark:
        signal = float(dark.growth_dn_per_us[recorded.tap[cells[0]]] * block.block.exposure_us)
    covariance, factor = _covariances(block, cells, pixels)
    ends = _near_an_end(_one_cell(block, cells, share), recorded.full_scale_dn)
    return {
        **named,
        "is_dark": is_dark,
        "exposure_us": block.block.exposure_us,
        "level": block.block.level,
        "mean_dn": mean,
        "signal_dn": signal,
        "spread": float((share * (own - signal) ** 2).sum()) / signal**2 if not is_dark else 0.0,
        "variance_dn2": float(np.average(block.variance_dn2[cells][known], weights=pixels[known]))
        if known.any()
        else np.nan,
        "square_factor": float((share**2 * block.square_factor[cells]).sum()),
        "cumulant_factor": float((share**2 * block.cumulant_factor[cells]).sum()),
        "covariance_dn2": covariance,
        "covariance_factor": factor,
        "pixels": float(pixels.sum()),
        "samples": float(pixels.sum()) * max(block.n_exposures, 1),
        "ends": bool(ends.any()),
    }


def _one_cell(block: BlockCells, cells: Numbers, share: Columns) -> BlockCells:
    """Return the class's lowest and highest cell, with its variance and its clipped share."""
    variance = np.full(2, np.nanmean(block.variance_dn2[cells]))
    means = np.array([block.mean_dn[cells].min(), block.mean_dn[cells].max()])
    clipped = np.full(2, float((share * block.clipped_share[cells]).sum()))
    return replace(block, mean_dn=means, variance_dn2=variance, clipped_share=clipped)


def _covariances(
    block: BlockCells, cells: Numbers, pixels: Columns
) -> tuple[list[float], list[float]]:
    """Return covariance and c of each lag, both sides of it averaged.

    Two pixels' covariance has half the factor a of the variance (their fourth cumulant is none).
    """
    found: dict[Lag, list[tuple[float, float]]] = {}
    for k, (row, column) in enumerate(block.lags):
        own = block.covariance_dn2[k, cells]
        known = np.isfinite(own)
        size = pixels[known]
        if not known.any():
            found.setdefault((row, abs(column)), []).append((np.nan, np.inf))
            continue
        share = size / size.sum()
        factor = float((share**2 * block.square_factor[cells][known]).sum())
        factor /= 2.0 * max(float(block.lag_share[k]), 1e-9)
        found.setdefault((row, abs(column)), []).append((float(share @ own[known]), factor))
    values = [float(np.mean([v for v, _ in sides])) for sides in found.values()]
    factors = [float(np.sum([f for _, f in s])) / len(s) ** 2 for s in found.values()]
    return values, factors
