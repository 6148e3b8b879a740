"""DN0, the slope with its smooth profile, and QE, column by column: AgCam's Figs. 3 and 4."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from calib.arrays import Columns
from calib.radiometric.calibration import Calibration
from calib.report.style import BLUE, GREY, INK, ORANGE, new_figure, unit_text


def dark_offset(calibration: Calibration) -> Figure:
    """Draw DN0 with its ±2σ band and the mean of the capped darks, and below it its uncertainty."""
    figure = new_figure(height_in=4.2)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    found = calibration.coefficients
    offset = _only(found.dark_offset_dn, found.valid)
    _banded(upper, offset, found.dark_offset_dn_std, BLUE)
    if np.nanmin(offset) < 0.0:
        upper.axhline(0.0, color=INK, linewidth=0.8)
    if calibration.darks is not None:
        upper.axhline(
            calibration.darks.capped_mean_dn,
            color=ORANGE,
            linestyle="--",
            label=f"mean of the capped darks, {calibration.darks.capped_mean_dn:.2f} DN",
        )
        figure.legend(loc="outside upper right")
    upper.set(title="Dark offset DN0", ylabel="DN")
    lower.plot(_only(found.dark_offset_dn_std, found.valid), color=ORANGE, linewidth=0.5)
    lower.set(ylabel="u(DN0), DN", xlabel="column")
    lower.set_ylim(0.0, 1.15 * lower.get_ylim()[1])
    return figure


def slope(calibration: Calibration) -> Figure:
    """Draw VE·QE of each column and the smooth profile through it."""
    figure = new_figure()
    axes = figure.subplots()
    found = calibration.coefficients
    axes.plot(_only(found.slope, found.valid), color=GREY, linewidth=0.5, label="VE·QE, by column")
    axes.plot(
        calibration.figures.profile_slope,
        color=ORANGE,
        label=f"polynomial of order {found.vignette_order}",
    )
    axes.axvline(
        found.axis_column,
        color=BLUE,
        linewidth=0.8,
        linestyle=":",
        label=f"axis, column {found.axis_column:.0f}",
    )
    axes.set(
        title=f"Response and vignette: falls by {found.edge_fall_percent:.1f} % at the edge",
        xlabel="column",
        ylabel=f"DN / ({unit_text(found.radiance_unit)} µs)",
    )
    figure.legend(loc="outside lower center", ncols=3)
    return figure


def responsivity(calibration: Calibration) -> Figure:
    """Draw QE and, below it, its relative standard uncertainty."""
    figure = new_figure(height_in=4.2)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    found = calibration.coefficients
    upper.plot(_only(found.responsivity, found.valid), color=BLUE, linewidth=0.5)
    upper.set(
        title=f"Responsivity QE: columns scatter by {calibration.figures.prnu_percent:.2f} %",
        ylabel=f"DN / ({unit_text(found.radiance_unit)} µs)",
    )
    with np.errstate(invalid="ignore"):
        relative = 100.0 * found.responsivity_std / found.responsivity
    lower.plot(_only(relative, found.valid), color=ORANGE, linewidth=0.5)
    lower.set(ylabel="u(QE), %", xlabel="column")
    lower.set_ylim(0.0, 1.15 * lower.get_ylim()[1])
    return figure


def _only(values: Columns, valid: np.ndarray) -> Columns:
    """Return a gap where a column is masked, so that nothing is drawn across it."""
    return np.where(valid, values, np.nan)


def _banded(axes: Axes, values: Columns, std: Columns, color: str) -> None:
    """Draw a curve with its ±2σ band."""
    columns = np.arange(len(values))
    axes.fill_between(columns, values - 2 * std, values + 2 * std, color=color, alpha=0.25, lw=0)
    axes.plot(values, color=color, linewidth=0.5)
