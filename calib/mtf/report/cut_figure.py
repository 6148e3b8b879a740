"""Cuts through the transfer function, with ±3σ."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from calib.mtf.figures_of_merit import PER_MM, Cut
from calib.mtf.result import TransferResult
from calib.report.style import BLUE, GREY, ORANGE, new_figure


def cut_figure(result: TransferResult) -> Figure:
    """Draw the cuts along x and y; below, the band alone, so that it can be read."""
    figure = new_figure(9.0, 4.4)
    grid = figure.subplots(2, 2, sharex=True, height_ratios=(3, 1))
    for column, cut in zip(grid.T, result.cuts, strict=True):
        upper, lower = column
        zero = result.first_zeros[0 if cut.axis == "x" else 1]
        draw_cut(upper, cut)
        if zero.is_known:
            upper.axvline(zero.value, color=GREY, lw=0.8, ls=":")
            text = f"zero {zero.value:.3f} ± {zero.std:.1g}/mm"
            upper.annotate(text, (zero.value, 0.1), xytext=(5, 8), textcoords="offset points")
        upper.set(title=f"Transfer function along {cut.axis}", ylim=(-0.35, 1.05))
        lower.plot(PER_MM * cut.frequency_per_um, 3 * _valid(cut, cut.values.std), color=BLUE)
        lower.set(xlabel=f"f{cut.axis} (1/mm)", ylabel="3σ", ylim=(0, None))
    grid[0, 0].legend(loc="upper right")
    return figure


def draw_cut(axes: Axes, cut: Cut) -> None:
    """Draw the real and the imaginary part of a cut, each in its band."""
    frequency = PER_MM * cut.frequency_per_um
    for part, std, color, name in (
        (cut.values.transfer.real, cut.values.real_std, BLUE, "real part, ± 3σ"),
        (cut.values.transfer.imag, cut.values.imaginary_std, ORANGE, "imaginary part"),
    ):
        low, high = _valid(cut, part - 3 * std), _valid(cut, part + 3 * std)
        axes.fill_between(frequency, low, high, color=color, alpha=0.3, lw=0)
        axes.plot(frequency, _valid(cut, part), color=color, label=name)
    axes.axhline(0, color=GREY, lw=0.7)


def _valid(cut: Cut, values: np.ndarray) -> np.ndarray:
    """Return a gap where the recording does not determine the value."""
    return np.where(cut.values.valid, values, np.nan)
