"""Classes of cells in one block, averaged: each pixel with the same weight."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.difference_sums import Lag
from calib.transfer.photon_transfer.cells import BlockCells
from calib.transfer.photon_transfer.classes import Numbers
from calib.transfer.photon_transfer.dark_level import DarkLevel
from calib.transfer.photon_transfer.unrounding import left_factor

_NEAR_AN_END_SIGMA = 4.5
"""What is cut off there changes the variance by 1e-4 and less."""
_MOST_CLIPPED = 1e-4


@dataclass(frozen=True)
class Members:
    """Which cells make which classes, the classes of a tap one after the other.

    Attributes:
        cells: Cells by class, (n_members,).
        first: Where each class begins in them, (n_classes,).
        tap: Of each class, (n_classes,).
        number: Of the class within its tap, (n_classes,).
        pixels: Of each member, (n_members,).
        full_scale_dn: The highest code.
    """

    cells: Numbers
    first: Numbers
    tap: Numbers
    number: Numbers
    pixels: Columns
    full_scale_dn: int

    @classmethod
    def of(
        cls,
        tap: Numbers,
        number: Numbers,
        *,
        out: NDArray[np.bool_],
        pixels: Columns,
        full_scale_dn: int,
    ) -> "Members":
        """Sort cells by tap and class, without those that are `out`; all (n_cells,)."""
        kept = np.flatnonzero(~out)
        cells = kept[np.lexsort((number[kept], tap[kept]))]
        key = tap[cells] * (int(number.max()) + 1) + number[cells]
        first = np.flatnonzero(np.diff(key, prepend=-1))
        at = cells[first]
        return cls(cells, first, tap[at], number[at], pixels[cells], full_scale_dn)

    @cached_property
    def size(self) -> Columns:
        """Pixels of each class, (n_classes,)."""
        return self.sum(np.ones(len(self.cells)))

    def sum(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return sums over classes, weighted by pixels; along the last axis."""
        return np.asarray(np.add.reduceat(values * self.pixels, self.first, axis=-1))

    def any(self, which: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return of which classes some cell is in `which`."""
        return np.asarray(np.logical_or.reduceat(which, self.first), np.bool_)

    def average(self, values: Columns) -> tuple[Columns, NDArray[np.bool_]]:
        """Return the averages of what is known, NaN where nothing is, and where something is."""
        known = np.isfinite(values)
        size = self.sum(1.0 * known)
        with np.errstate(invalid="ignore", divide="ignore"):
            return self.sum(np.where(known, values, 0.0)) / size, size > 0

    def spans(self) -> list[slice]:
        """Return where each class lies among the members."""
        last = [*self.first[1:].tolist(), len(self.cells)]
        return [slice(a, b) for a, b in zip(self.first.tolist(), last, strict=True)]


def near_an_end(
    block: BlockCells, full_scale_dn: int, variance_dn2: Columns | None = None
) -> NDArray[np.bool_]:
    """Return which cells' codes come so near to an end of their range that some are cut off.

    Args:
        block: The cells.
        full_scale_dn: The highest code.
        variance_dn2: What their codes are expected to have; None takes what is seen.
    """
    variance = np.nan_to_num(block.variance_dn2) if variance_dn2 is None else variance_dn2
    width = _NEAR_AN_END_SIGMA * np.sqrt(np.maximum(variance, 0.0))
    near = (block.mean_dn + width >= full_scale_dn) | (block.mean_dn - width <= 0)
    return np.asarray(near | (block.clipped_share > _MOST_CLIPPED))


@dataclass(frozen=True)
class PreparedBlock:
    """A block whose rounding is undone where it can be; arrays (n_cells,).

    Attributes:
        cells: Its statistics.
        unknown: Where the phase of rounding is not known, and matters.
        lever: By how much more σ² errs than a variance, where it is known.
        cut: Which cells of a dark come near an end of the codes.
    """

    cells: BlockCells
    unknown: NDArray[np.bool_]
    lever: Columns
    cut: NDArray[np.bool_]


def class_averages(
    members: Members, dark: DarkLevel, seen: PreparedBlock, n_darks: int
) -> dict[str, NDArray[np.generic]]:
    """Return what `Points` has of a block's classes, by name.

    Args:
        members: The classes.
        dark: The cells' dark level.
        seen: The block.
        n_darks: How many darks there are: they have their phases in common, so that what these
            make in each is counted so many times over, and comes out right of all together.
    """
    block, cells, size = seen.cells, members.cells, members.size
    is_dark = block.block.kind == "dark"
    mean = block.mean_dn[cells]
    level = mean - dark.offset_dn[cells]
    signal = members.sum(level) / size
    if is_dark:
        signal = dark.growth_dn_per_us[members.tap] * block.block.exposure_us
    variance, _ = members.average(block.variance_dn2[cells])
    covariance, covariance_factor = _covariances(members, block)
    left = [
        left_factor(mean[s], members.pixels[s], seen.unknown[cells[s]]) for s in members.spans()
    ]
    one = np.ones(len(size))
    with np.errstate(invalid="ignore", divide="ignore"):
        spread = 0.0 * one if is_dark else members.sum(level**2) / size / signal**2 - 1.0
    return {
        "number": members.number,
        "is_dark": one > 0 if is_dark else one < 0,
        "exposure_us": block.block.exposure_us * one,
        "level": block.block.level * one,
        "mean_dn": members.sum(mean) / size,
        "signal_dn": signal,
        "spread": spread,
        "variance_dn2": variance,
        "square_factor": members.sum(members.pixels * block.square_factor[cells]) / size**2,
        "cumulant_factor": members.sum(members.pixels * block.cumulant_factor[cells]) / size**2,
        "phase_factor": np.array(left) * (n_darks if is_dark else 1),
        "lever": members.sum(seen.lever[cells]) / size,
        "covariance_dn2": covariance,
        "covariance_factor": covariance_factor,
        "pixels": size,
        "samples": size * max(block.n_exposures, 1),
        "ends": members.any(seen.cut[cells]) if is_dark else _ends(members, block, variance),
    }


def _ends(members: Members, block: BlockCells, variance: Columns) -> NDArray[np.bool_]:
    """Return of which classes the lowest or the highest cell comes near an end of the range.

    A cell of the class's variance and clipped share is meant: one cell's own are too noisy.
    """
    mean = block.mean_dn[members.cells]
    clipped = members.sum(block.clipped_share[members.cells]) / members.size
    found = np.zeros(len(variance), np.bool_)
    for extreme in (np.minimum, np.maximum):
        one = replace(block, mean_dn=extreme.reduceat(mean, members.first), clipped_share=clipped)
        found |= near_an_end(one, members.full_scale_dn, np.nan_to_num(variance))
    return found


def _covariances(
    members: Members, block: BlockCells
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return covariance and c of each lag, both sides of it averaged, (n_lags, n_classes).

    Two pixels' covariance has half the factor a of the variance (their fourth cumulant is none).
    """
    sides: dict[Lag, list[tuple[Columns, Columns]]] = {}
    square = members.pixels * block.square_factor[members.cells]
    for k, (row, column) in enumerate(block.lags):
        own = block.covariance_dn2[k, members.cells]
        average, known = members.average(own)
        size = members.sum(1.0 * np.isfinite(own))
        with np.errstate(invalid="ignore", divide="ignore"):
            factor = members.sum(np.where(np.isfinite(own), square, 0.0)) / size**2
        factor = np.where(known, factor / (2.0 * max(float(block.lag_share[k]), 1e-9)), np.inf)
        sides.setdefault((row, abs(column)), []).append((average, factor))
    shape = (len(sides), len(members.first))
    values = [np.mean([v for v, _ in s], axis=0) for s in sides.values()]
    factors = [np.sum([f for _, f in s], axis=0) / len(s) ** 2 for s in sides.values()]
    return np.array(values).reshape(shape), np.array(factors).reshape(shape)
