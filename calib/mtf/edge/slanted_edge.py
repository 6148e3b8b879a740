"""The slanted edge: from one edge's images to the transfer function across it.

ISO 12233:2017, annex D: pixels are sorted by their distance from the edge into bins of an
eighth of the pitch (the standard's quarter is too coarse: with few rows, bins are not filled
evenly), the mean of each is the edge-spread function, its difference quotient the line-
spread function, whose Fourier transform is the transfer function. What the bins (a box of one
bin) and the difference over two bins do to it is divided out. The pixels' noise is carried
through, all steps being linear.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.errors import NotDeterminedError
from calib.mtf.edge.edge_line import find_edge
from calib.mtf.harmonic_sums import Complex

Vector = NDArray[np.floating]
_BINS_PER_PIXEL = 8
_REACH_PIXELS = 4.0
_PLATEAU_PIXELS = 2.5
_STEPS_PER_PITCH = 32
_HIGHEST = 1.5  # in units of 1/pitch; at 2 the difference quotient is blind


@dataclass(frozen=True, eq=False)
class EdgeTransfer:
    """A transfer function in one direction.

    Attributes:
        frequency_per_um: Across the edge, (n,), from 0 on.
        transfer: 1 at 0, the line-spread function's centroid at 0, (n,).
        std: √E|δT|², (n,), from the pixels' noise.
        position_um: Of the line-spread function, (n_bins,).
        line_spread: ∫ = 1, per µm.
        angle_rad: Between the edge and the columns; 0 for a moving edge.
    """

    frequency_per_um: Vector
    transfer: Complex
    std: Vector
    position_um: Vector
    line_spread: Vector
    angle_rad: float


def slanted_edge(image: Vector, pitch_um: float, *, moving: bool = False) -> EdgeTransfer:
    """Reduce the image of an edge that crosses the columns.

    Args:
        image: (n_rows, n_columns), dark removed, in any unit.
        pitch_um: The pixels' distance, µm.
        moving: Rows are lines of a line sensor, along which a straight edge moves steadily.

    Raises:
        NotDeterminedError: `no-edge`, `no-slant`, `edge-at-border`, or `edge-too-short` where bins
            stay empty.
    """
    edge = find_edge(image)
    angle = 0.0 if moving else float(np.arctan(edge.slope))
    rows, columns = np.arange(len(image), dtype=float), np.arange(image.shape[1], dtype=float)
    _check_within(edge.at(rows), image.shape[1])
    away = (columns - edge.at(rows)[:, None]) * np.cos(angle)
    step = 1 / _BINS_PER_PIXEL
    reach = round(_REACH_PIXELS / step)
    at = np.floor(away / step + 0.5).astype(int)
    inside = np.abs(at) <= reach
    spread, variance = _edge_spread(image[inside], at[inside] + reach, 2 * reach + 1)
    place = pitch_um * step * np.arange(-reach, reach + 1)
    return _transform(spread, variance, place, pitch_um, angle)


def _check_within(column: Vector, n_columns: int) -> None:
    """Refuse an edge whose flanks are cut off at a border."""
    if column.min() < _REACH_PIXELS or column.max() > n_columns - 1 - _REACH_PIXELS:
        msg = f"the edge runs from column {column[0]:.1f} to {column[-1]:.1f}, nearer than"
        msg += f" {_REACH_PIXELS:.0f} pixels to the border: cut the image to where it stays inside"
        raise NotDeterminedError(msg, code="edge-at-border")


def _edge_spread(signal: Vector, at: NDArray[np.int64], n_bins: int) -> tuple[Vector, Vector]:
    """Return each bin's mean, and its variance from the scatter on the two plateaus."""
    count = np.bincount(at, minlength=n_bins)
    if count.min() < 2:
        msg = "too few pixels lie at some distance of the edge: record more rows, or centre it"
        raise NotDeterminedError(msg, code="edge-too-short")
    mean = np.bincount(at, signal, n_bins) / count
    square = np.bincount(at, (signal - mean[at]) ** 2, n_bins) / (count - 1)
    margin = round((_REACH_PIXELS - _PLATEAU_PIXELS) * _BINS_PER_PIXEL)
    low, high = square[:margin].mean(), square[-margin:].mean()
    share = np.clip((mean - mean[0]) / (mean[-1] - mean[0]), 0, 1)
    variance = (low + share * (high - low)) / count
    return mean, variance


def _transform(
    spread: Vector, variance: Vector, place: Vector, pitch_um: float, angle: float
) -> EdgeTransfer:
    step = place[1] - place[0]
    line = (spread[2:] - spread[:-2]) / (2 * step)
    inner = place[1:-1]
    total = line.sum()
    inner = inner - (inner * line).sum() / total
    n = round(_HIGHEST * _STEPS_PER_PITCH)
    frequency = np.arange(n + 1) / (_STEPS_PER_PITCH * pitch_um)
    correction = np.sinc(frequency * step) * np.sinc(2 * frequency * step)
    turned = np.exp(-2j * np.pi * np.multiply.outer(frequency, inner)) / total
    transfer = (turned @ line) / correction
    by_line = turned / correction[:, None] - transfer[:, None] * turned[0]
    by_line += np.multiply.outer(2j * np.pi * frequency * transfer, inner / total)
    slope = np.pad(by_line, ((0, 0), (2, 0))) - np.pad(by_line, ((0, 0), (0, 2)))
    std = np.sqrt((np.abs(slope) ** 2) @ variance) / (2 * step)
    return EdgeTransfer(frequency, transfer, std, inner, line / (total * step), angle)
