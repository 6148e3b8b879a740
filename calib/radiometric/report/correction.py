"""Before and after: the same lines raw and as radiance, as images and as one line's profile."""

import numpy as np
from matplotlib.figure import Figure

from calib.arrays import RawLines
from calib.radiometric.correction.apply import Correction
from calib.report.style import BLUE, GREY, ORANGE, new_figure, unit_text

LINES_SHOWN = 200


def before_and_after(raw: RawLines, correction: Correction, block: str) -> Figure:
    """Draw `raw`, (n_lines, n_columns), and the radiance that `correction` makes of it."""
    lines = raw[:LINES_SHOWN]
    radiance = correction.lines(lines).radiance
    figure = new_figure(height_in=5.4)
    grid = figure.subplots(2, 2, height_ratios=(1, 1.3))
    unit = unit_text(correction.coefficients.radiance_unit)
    for axes, image, name in (
        (grid[0, 0], lines, f"Raw DN, block {block}"),
        (grid[0, 1], radiance, f"Radiance, {unit}"),
    ):
        middle = float(np.nanmedian(image))
        shown = axes.imshow(
            image, aspect="auto", cmap="gray", vmin=0.4 * middle, vmax=1.3 * middle,
            interpolation="nearest",
        )  # fmt: skip
        axes.set(title=name, ylabel="line")
        axes.grid(visible=False)
        figure.colorbar(shown, ax=axes, shrink=0.9)
    for axes, image, label, color in (
        (grid[1, 0], lines, "DN", ORANGE),
        (grid[1, 1], radiance, unit, BLUE),
    ):
        mean = image.mean(axis=0)
        axes.plot(image[0], color=GREY, lw=0.4, label="one line")
        axes.plot(mean, color=color, lw=0.6, label=f"mean of {len(image)} lines")
        axes.set(xlabel="column", ylabel=label, ylim=(0.0, 1.25 * float(np.nanmax(mean))))
        axes.legend(loc="lower center", ncols=2)
    return figure
