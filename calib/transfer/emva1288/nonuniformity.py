r"""Spatial variances of an averaged image: total, row, column and pixel.

Source: EMVA Standard 1288, Release 4.0 Linear, section 4.3 (Eqs. 33-42). A pixel of the averaged
image is a = µ + row + column + pixel + the residue of temporal noise, of variance σ²/L (Eq. 36).
The mean squares of the two-way layout give the three unbiased, for any number of rows and
columns: E[MS_residual] = s²_pixel + σ²/L, E[MS_column] = M s²_column + s²_pixel + σ²/L, and the
same for rows; the standard's Eq. 42 solves the same three equations with 1/(NM) in place of the
degrees of freedom.

What is estimated is the variance of the pixels that there are. Their number is no uncertainty;
the residue of temporal noise is.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from calib.transfer.emva1288.block_figures import BlockFigures
from calib.transfer.emva1288.block_image import Image
from calib.transfer.emva1288.highpass import ACROSS, ALONG, UNTOUCHED, Loss, highpass
from calib.transfer.emva1288.propagation import Batch


@dataclass(frozen=True)
class MeanSquares:
    """Mean squares less the temporal residue: independent of each other, free of bias.

    Attributes:
        pixel, column, row: DN², in this order, divided by what the filter leaves; of a line
            sensor only the first.
        std: Their standard uncertainties.
        shape: Rows and columns that they are from.
    """

    values: tuple[float, ...]
    std: tuple[float, ...]
    shape: tuple[int, int]


@dataclass(frozen=True)
class SpatialInputs:
    """The mean squares of the dark's and the 50 % flat's averaged image, filtered and not."""

    dark: MeanSquares
    flat: MeanSquares
    dark_unfiltered: MeanSquares
    flat_unfiltered: MeanSquares
    flat_index: int

    @property
    def parts(self) -> tuple[MeanSquares, ...]:
        """In the order in which the inputs' vector holds them."""
        return (self.dark, self.flat, self.dark_unfiltered, self.flat_unfiltered)


def mean_squares(image: Image, figures: BlockFigures, *, filtered: bool) -> MeanSquares:
    """Return the mean squares of an averaged image, (n_rows, n_columns)."""
    used = highpass(image) if filtered else image
    along, across = (ALONG, ACROSS) if filtered else (UNTOUCHED, UNTOUCHED)
    residue = figures.within_dn2 / figures.n_frames
    residue_std = figures.variance_dn2_std / figures.n_frames
    rows, columns = used.shape
    if rows == 1:
        only = _less_noise(float(np.var(used, ddof=1)), columns - 1, along, residue)
        return MeanSquares((only[0],), (math.hypot(only[1], residue_std),), used.shape)
    by_column = used.mean(axis=0)
    by_row = used.mean(axis=1)
    rest = used - by_column - by_row[:, None] + used.mean()
    free = (rows - 1) * (columns - 1)
    # Row and column means of a filtered pattern keep less of it than its pixels do.
    kept = rows * columns * across.power - (rows + columns) * along.power + 1.0
    pixel = _less_noise(float(np.sum(rest**2)) / kept, free, _whole(across), residue)
    column = _less_noise(rows * float(np.var(by_column, ddof=1)), columns - 1, along, residue)
    row = _less_noise(columns * float(np.var(by_row, ddof=1)), rows - 1, along, residue)
    found = (pixel, column, row)
    std = (math.hypot(pixel[1], residue_std), column[1], row[1])
    return MeanSquares(tuple(each[0] for each in found), std, used.shape)


def _whole(loss: Loss) -> Loss:
    """Return the loss of a mean square whose power has been restored already."""
    return Loss(1.0, loss.spread)


def _less_noise(square: float, free: int, loss: Loss, residue: float) -> tuple[float, float]:
    """Return a mean square less the temporal residue, and its standard uncertainty.

    Noise of variance v on a fixed pattern of mean square p: variance 2 v²/ν + 4 p v/ν.
    """
    pattern = square / loss.power - residue
    variance = (2.0 * residue**2 + 4.0 * max(0.0, pattern) * residue) * loss.spread / free
    return pattern, math.sqrt(variance)


def components(squares: Batch, shape: tuple[int, int]) -> dict[str, Batch]:
    """Return the spatial variances that mean squares make, Eq. 42; of a line its total alone."""
    if shape[0] == 1:
        return {"total": squares[..., 0]}
    rows, columns = shape
    pixel = squares[..., 0]
    column = (squares[..., 1] - pixel) / rows
    row = (squares[..., 2] - pixel) / columns
    return {"total": pixel + column + row, "row": row, "column": column, "pixel": pixel}


def nonuniformities(
    inputs: SpatialInputs, measured: Sequence[Batch], signal: Batch, gain: Batch
) -> Iterator[tuple[str, Batch]]:
    """Yield DSNU and PRNU, Eqs. 66 and 67, and the variances that they are the roots of."""
    dark, flat, dark_raw, flat_raw = (
        components(part, known.shape) for part, known in zip(measured, inputs.parts, strict=True)
    )
    yield "spatial_variance_dark_dn2", dark["total"]
    yield "spatial_variance_50_dn2", flat["total"]
    yield "dsnu_dn", np.sqrt(dark["total"])
    for name in dark:
        yield from _pair(
            "" if name == "total" else f"_{name}", dark[name], flat[name], signal, gain
        )
    yield from _pair("_unfiltered", dark_raw["total"], flat_raw["total"], signal, gain)


def _pair(
    tail: str, dark: Batch, flat: Batch, signal: Batch, gain: Batch
) -> Iterator[tuple[str, Batch]]:
    yield f"variance of dsnu{tail}", dark
    yield f"variance of prnu{tail}", flat - dark
    yield f"dsnu{tail}_e", np.sqrt(dark) / gain
    yield f"prnu{tail}_percent", 100.0 * np.sqrt(flat - dark) / signal
