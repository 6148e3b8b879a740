"""What the calibration leaves: each block's mean against the model, by column and block."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from calib.arrays import Columns
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.recording.block_statistics import BlockStatistics
from calib.report.style import new_figure

CELLS_ACROSS = 512


def residual_map(found: CoefficientSet, blocks: Sequence[BlockStatistics]) -> Figure:
    """Draw (block mean − model) over its standard uncertainty, columns pooled to a screen's width.

    The source's level is fitted for each block, since its certificate is less sure than a mean.
    """
    rows = [_standardised(found, block) for block in blocks]
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


def _standardised(found: CoefficientSet, block: BlockStatistics) -> Columns:
    """Return residuals over their standard error, averaged over neighbouring columns."""
    use = found.valid & (block.n_at_full_scale == 0) & (block.n_at_zero == 0)
    signal = block.mean_dn - found.dark_level_dn(block.block.exposure_us)
    shape = np.where(use, found.slope, 0.0)
    level = float(signal[use] @ shape[use] / (shape[use] @ shape[use])) if use.any() else 0.0
    variance = block.variance_dn2 / block.n_lines
    if block.block.kind == "dark":
        # Darks do not enter the fit: they meet intercepts that are uncertain themselves.
        level, variance = 0.0, variance + found.dark_offset_dn_std**2
    with np.errstate(invalid="ignore", divide="ignore"):
        z = (signal - level * shape) / np.sqrt(variance)
    z = np.where(use & np.isfinite(z), z, np.nan)
    groups = np.array_split(z, min(CELLS_ACROSS, len(z)))
    return np.array([_pooled(group) for group in groups])


def _pooled(z: Columns) -> float:
    """Return the sum over the root of the count: unit spread again where only noise is left."""
    known = z[np.isfinite(z)]
    return float(np.sum(known) / np.sqrt(len(known))) if len(known) else float("nan")
