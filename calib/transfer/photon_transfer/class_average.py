"""A class of cells in one block, averaged: each pixel with the same weight."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.difference_sums import Lag
from calib.transfer.photon_transfer.cells import BlockCells
from calib.transfer.photon_transfer.classes import Numbers
from calib.transfer.photon_transfer.dark_level import DarkLevel
from calib.transfer.photon_transfer.recorded_cells import RecordedCells

_NEAR_AN_END_SIGMA = 4.5
"""What is cut off there changes the variance by 1e-4 and less."""
_MOST_CLIPPED = 1e-4


def near_an_end(block: BlockCells, full_scale_dn: int) -> NDArray[np.bool_]:
    """Return which cells' codes come so near to an end of their range that some are cut off."""
    width = _NEAR_AN_END_SIGMA * np.sqrt(np.maximum(np.nan_to_num(block.variance_dn2), 0.0))
    near = (block.mean_dn + width >= full_scale_dn) | (block.mean_dn - width <= 0)
    return np.asarray(near | (block.clipped_share > _MOST_CLIPPED))


def class_average(
    recorded: RecordedCells,
    block: BlockCells,
    dark: DarkLevel,
    named: dict[str, object],
    cells: Numbers,
) -> dict[str, object]:
    """Return what `Points` has of a class, by name, `named` included."""
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
    ends = near_an_end(_one_cell(block, cells, share), recorded.full_scale_dn)
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
