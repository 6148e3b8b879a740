"""What was found of the bench: stage errors, and the pixels' gain."""

import numpy as np
from matplotlib.figure import Figure

from calib.mtf.findings import stage_outliers
from calib.mtf.result import TransferResult
from calib.report.style import GREY, INK, new_figure


def bench_figure(result: TransferResult) -> Figure:
    """Draw each stage position's error with its std, and the pixels' gain as a histogram."""
    figure = new_figure(9.0, 3.2)
    left, right = figure.subplots(1, 2, width_ratios=(1.6, 1))
    found = result.measurement
    error, std = found.fit.stage_um
    position = np.array(found.fit.state.sampling.frames)
    for axis, name in enumerate("xy"):
        left.errorbar(
            position,
            error[:, axis],
            3 * std[:, axis],
            fmt="o",
            ms=3,
            capsize=2,
            label=f"along {name}",
        )
    for each in stage_outliers(found):
        at = (each.position, each.error_um[0])
        left.annotate(f"{each.position:03d}", at, xytext=(4, 4), textcoords="offset points")
    left.axhline(0, color=GREY, lw=0.7)
    left.set(title="Stage errors, ± 3σ", xlabel="stage position", ylabel="µm")
    left.legend(loc="best", ncols=2)
    gain = 100 * found.fit.gain[found.fit.good]
    right.hist(gain, bins=60, color=GREY, ec=INK, lw=0.3)
    title = f"Pixels' gain: scatter {100 * found.fit.gain_std:.2g} %"
    right.set(title=title, xlabel="from the mean, %", ylabel="pixels")
    return figure
