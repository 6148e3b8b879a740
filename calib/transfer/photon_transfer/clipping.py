"""Where a difference is an outlier: limits from a block's first exposures, cell by cell.

The noise grows with the signal, so that cells of like signal share a limit: those of a tap are
ordered by their mean and put into groups of some thousand differences. In a group the standard
deviation is found by clipping at 5σ until it stays; between groups, and beyond the outer ones, its
square follows straight lines.
A limit 3 % off changes what is kept of the variance by 1e-5, and that share is worked out for the
limit that was used (`truncation`).
"""

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns, RawLines
from calib.transfer.photon_transfer.cells import CellLayout

_LINES = 256
_GROUP = 4096
_MOST_GROUPS = 24
_SMALLEST_DN = 0.75
"""Differences of codes that hardly change would else have a limit of nothing."""


def first_limits(exposures: RawLines, layout: CellLayout, clip_sigma: float) -> NDArray[np.float64]:
    """Return how far a difference may be off, DN, (n_bands, columns).

    Args:
        exposures: The first ones, two or more: lines, or frames of which two are looked at.
        layout: Of the cells.
        clip_sigma: In standard deviations of a difference.
    """
    few = exposures[: 2 if layout.is_area else _LINES].astype(np.float64)
    if layout.is_area:
        samples = _by_cell(few[1] - few[0], layout)
        mean = np.nanmean(_by_cell(few.mean(axis=0), layout), axis=0)
    else:
        samples, mean = np.diff(few, axis=0), few.mean(axis=0)
    tap = layout.tap.ravel()
    for number in range(layout.n_taps):
        own = samples[:, tap == number]
        shared = np.nanmedian(own, axis=None if layout.is_area else 1, keepdims=True)
        samples[:, tap == number] = own - shared
    return limits(samples, mean, tap, clip_sigma).reshape(layout.tap.shape)


def _by_cell(frame: NDArray[np.float64], layout: CellLayout) -> NDArray[np.float64]:
    """Return a frame's pixels as (rows of the highest band, n_cells); NaN where a band ends."""
    heights = np.diff(layout.edges)
    found = np.full((int(heights.max()), layout.n_bands, layout.columns), np.nan)
    for band, height in enumerate(heights):
        found[:height, band] = frame[layout.edges[band] : layout.edges[band + 1]]
    return found.reshape(len(found), -1)


def limits(
    differences: NDArray[np.float64],
    mean_dn: Columns,
    tap: NDArray[np.intp],
    clip_sigma: float,
) -> Columns:
    """Return how far a difference may be off, DN, (n_cells,).

    Args:
        differences: Of pairs of exposures, what their tap shares taken off, (n_samples, n_cells).
        mean_dn: Of those exposures, (n_cells,).
        tap: (n_cells,).
        clip_sigma: In standard deviations of a difference.
    """
    sigma = np.empty(len(mean_dn))
    for number in np.unique(tap):
        cells = np.flatnonzero(tap == number)
        cells = cells[np.argsort(mean_dn[cells], kind="stable")]
        samples = len(differences) * len(cells)
        n_groups = int(np.clip(samples // _GROUP, 1, min(_MOST_GROUPS, len(cells))))
        groups = np.array_split(cells, n_groups)
        centres = [float(mean_dn[g].mean()) for g in groups]
        squares = [_clipped_sigma(differences[:, g], clip_sigma) ** 2 for g in groups]
        sigma[cells] = np.sqrt(_line_by_line(mean_dn[cells], centres, squares))
    return clip_sigma * sigma


def _line_by_line(at: Columns, centres: list[float], values: list[float]) -> Columns:
    """Return `values` interpolated, and extrapolated to no less than half of the outer one."""
    found = np.interp(at, centres, values)
    for end, next_one in ((0, 1), (-1, -2)):
        beyond = at < centres[0] if end == 0 else at > centres[-1]
        if len(centres) > 1 and centres[next_one] != centres[end]:
            slope = (values[next_one] - values[end]) / (centres[next_one] - centres[end])
            line = values[end] + slope * (at - centres[end])
            found = np.where(beyond, np.maximum(line, 0.5 * values[end]), found)
    return np.asarray(found)


def _clipped_sigma(differences: NDArray[np.float64], clip_sigma: float) -> float:
    values = np.abs(differences[np.isfinite(differences)])
    sigma = max(float(np.median(values)) / 0.6745, _SMALLEST_DN) if values.size else _SMALLEST_DN
    for _ in range(20):
        kept = values[values <= clip_sigma * sigma]
        found = max(float(np.sqrt(np.mean(kept**2))) if kept.size else 0.0, _SMALLEST_DN)
        if abs(found - sigma) < 1e-6 * sigma:
            break
        sigma = found
    return sigma
