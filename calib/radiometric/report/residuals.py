"""What the calibration leaves: each block's mean against the model, by column and block."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.recording.block_statistics import BlockStatistics
from calib.report.style import new_figure

CELLS_ACROSS = 512


def residual_map(found: CoefficientSet, blocks: Sequence[BlockStatistics]) -> Figure:
    """Draw (block mean − model) over its standard uncertainty, columns pooled to a screen's width.

    The source's level is fitted for each block, since its certificate is less sure than a mean.
    Darks do not enter the fit. Against intercepts, all of them would show the intercepts' error,
    one pattern in every row: they are held against their own mean, less the dark current, by
    column. A single dark meets the intercepts.
    """
    darks = [s for s in blocks if s.block.kind == "dark"]
    rows = [
        _pooled_columns(
            _of_dark(found, block, darks) if block.block.kind == "dark" else _of_flat(found, block)
        )
        for block in blocks
    ]
    figure = new_figure(height_in=max(2.4, 0.14 * len(rows) + 1.4))
    axes = figure.subplots()
    image = axes.imshow(
        np.array(rows), aspect="auto", cmap="RdBu_r", vmin=-4, vmax=4, interpolation="nearest",
        extent=(0.0, float(found.n_columns), len(rows) - 0.5, -0.5),
    )  # fmt: skip
    axes.set(title="Residuals in standard deviations", xlabel="column", ylabel="block")
    axes.set_yticks(range(len(rows)), [_label(s) for s in blocks], fontsize=6)
    axes.grid(visible=False)
    figure.colorbar(image, ax=axes)
    return figure


def _label(block: BlockStatistics) -> str:
    b = block.block
    return f"{b.block}: {b.kind} {b.level:g}, {b.exposure_us:g} µs"


def _of_flat(found: CoefficientSet, block: BlockStatistics) -> Columns:
    """Return residuals over their standard error, of the level that fits the block best."""
    use = _usable(found, block)
    signal = _signal(found, block)
    shape = np.where(use, found.slope, 0.0)
    level = float(signal[use] @ shape[use] / (shape[use] @ shape[use])) if use.any() else 0.0
    return _standardised(signal - level * shape, block.variance_dn2 / block.n_lines, use)


def _of_dark(
    found: CoefficientSet, block: BlockStatistics, darks: Sequence[BlockStatistics]
) -> Columns:
    """Return a dark less the darks' mean over its standard error, or less DN0 if it is alone."""
    own = block.variance_dn2 / block.n_lines
    if len(darks) == 1:
        variance = own + found.dark_offset_dn_std**2
        return _standardised(_signal(found, block), variance, _usable(found, block))
    use = np.all([_usable(found, dark) for dark in darks], axis=0)
    mean = np.mean([_signal(found, dark) for dark in darks], axis=0)
    of_mean = sum(dark.variance_dn2 / dark.n_lines for dark in darks) / len(darks) ** 2
    variance = own * (1.0 - 2.0 / len(darks)) + of_mean
    return _standardised(_signal(found, block) - mean, variance, use)


def _usable(found: CoefficientSet, block: BlockStatistics) -> NDArray[np.bool_]:
    clipped = (block.n_at_full_scale > 0) | (block.n_at_zero > 0)
    return np.asarray(found.valid & ~clipped)


def _signal(found: CoefficientSet, block: BlockStatistics) -> Columns:
    return np.asarray(block.mean_dn - found.dark_level_dn(block.block.exposure_us))


def _standardised(residual: Columns, variance: Columns, use: NDArray[np.bool_]) -> Columns:
    """Return the quotient, NaN where a column cannot be used."""
    with np.errstate(invalid="ignore", divide="ignore"):
        z = residual / np.sqrt(variance)
    return np.where(use & np.isfinite(z), z, np.nan)


def _pooled_columns(z: Columns) -> Columns:
    """Return `z` averaged over neighbouring columns."""
    groups = np.array_split(z, min(CELLS_ACROSS, len(z)))
    return np.array([_pooled(group) for group in groups])


def _pooled(z: Columns) -> float:
    """Return the sum over the root of the count: unit spread again where only noise is left."""
    known = z[np.isfinite(z)]
    return float(np.sum(known) / np.sqrt(len(known))) if len(known) else float("nan")
