"""What a line's pixels do together: spectrum of the lines, shared noise, the first lines."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter
from numpy.typing import NDArray

from calib.diagnosis.report.compared import Compared
from calib.diagnosis.report.panel import AFTER, BEFORE, QUIET, RECORDED, Group, Panel, on_axes
from calib.diagnosis.statistics.pooled import ONSET_LINES

Floats = NDArray[np.float64]

FIRST_LINES = 12
MOST_STEPS = 4
"""Blocks of which the first lines are drawn."""
FINEST = 512
"""Points of a spectrum; more are averaged in their maxima."""


def rhythm_group(seen: Compared, weight: float) -> Group:
    """Return the spectra and the noise that all columns of a line share."""
    caption = (
        "Power by line frequency over that of white noise, all blocks together, and the variance "
        "that the columns of a line share. Triangles mark tones that stand out."
    )
    panels = [
        Panel("spectrum-lines", on_axes(lambda axes: _spectrum(seen, None, axes))),
        Panel("shared-noise", on_axes(lambda axes: _shared(seen, axes))),
    ]
    peaks = [peak for peak in seen.examined.evidence.peaks if peak.stands_out]
    along = sorted({peak.cycles_along for peak in peaks} - {0})
    if along:
        panels.append(Panel("spectrum-tone", on_axes(lambda axes: _spectrum(seen, along[0], axes))))
    return Group("rhythm", "Rhythm of the lines", caption, tuple(panels), weight)


def first_lines_group(seen: Compared, weight: float) -> Group:
    """Return how the first lines of a block differ from its later ones."""
    caption = (
        "Mean of each of a block's first lines less that of its second half; blue: expected with "
        "what was found. The plain model expects 0."
    )
    panel = Panel("first-lines", on_axes(lambda axes: _first_lines(seen, axes)), (5.0, 2.8))
    return Group("onset", "First lines after a change", caption, (panel,), weight)


def _spectrum(seen: Compared, along: int | None, axes: Axes) -> None:
    evidence = seen.examined.evidence
    shapes = [each.power.shape for each in evidence.sums]
    shape = max(set(shapes), key=shapes.count)
    column = along or 0
    used = [s for s in evidence.sums if s.power.shape == shape and shape[1] > column]
    rows = [s.power[:, column] / max(float(np.median(s.power[:, column])), 1e-12) for s in used]
    n = shape[0]
    power = np.log(2.0) * np.mean(rows, axis=0) if rows else np.zeros(n)
    half = power[2 : n // 2 + 1] if along is None else np.fft.fftshift(power)
    cycles = np.arange(2, n // 2 + 1) / n if along is None else np.arange(-(n // 2), n - n // 2) / n
    step = -(-len(half) // FINEST)
    usable = len(half) // step * step
    cycles = cycles[:usable].reshape(-1, step).mean(axis=1)
    axes.semilogy(cycles, half[:usable].reshape(-1, step).max(axis=1), color=RECORDED, lw=0.9)
    axes.axhline(1.0, color=QUIET, lw=0.8)
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_ylim(0.1, max(4.0, axes.get_ylim()[1]))
    for peak in evidence.peaks:
        if peak.cycles_along == column and peak.stands_out:
            x = abs(peak.cycles_per_line) if along is None else peak.cycles_per_line
            axes.plot(x, axes.get_ylim()[1], "v", color=BEFORE, ms=7, clip_on=False)
    of = "of the lines' means" if along is None else f"{column} cycles along a line"
    axes.set(title=f"spectrum, {of}", xlabel="cycles per line", ylabel="over white noise")


def _shared(seen: Compared, axes: Axes) -> None:
    recorded, plain, final, std = seen.pooled("common")
    signal = seen.examined.evidence.signal_dn
    order = np.argsort(signal)
    white = plain.mean(axis=1)
    axes.plot(signal[order], np.ones(len(order)), color=BEFORE)
    if seen.found:
        axes.plot(signal[order], (final.mean(axis=1) / white)[order], color=AFTER)
    error = np.sqrt((std**2).mean(axis=1) / std.shape[1]) / white
    axes.errorbar(
        signal, recorded.mean(axis=1) / white, yerr=np.where(np.isfinite(error), error, 0.0),
        fmt="o", ms=3, color=RECORDED, elinewidth=0.7,
    )  # fmt: skip
    axes.set(title="variance of the lines' means", xlabel="signal, DN", ylabel="over white noise")


def _first_lines(seen: Compared, axes: Axes) -> None:
    evidence, model = seen.examined.evidence, seen.examined.model
    size = np.abs(model.observed.onset).max(axis=1)
    size[0] = 0.0
    names = evidence.table.names
    for j, b in enumerate(np.argsort(size)[::-1][:MOST_STEPS]):
        line = evidence.sums[b].products.line_means.mean(axis=(1, 2))
        settled = float(line[len(line) // 2 :].mean())
        shown = line[:FIRST_LINES] - settled
        x = np.arange(1, len(shown) + 1)
        axes.plot(x, shown, "o-", color=RECORDED, ms=3, lw=0.7, alpha=1.0 - 0.2 * j)
        axes.annotate(names[b], (x[-1], shown[-1]), xytext=(4, 0), textcoords="offset points",
            fontsize=7, va="center")  # fmt: skip
        if model.change is not None:
            axes.plot(
                x[:ONSET_LINES], model.change.onset[b][: len(x)], "_", color=AFTER, ms=12, mew=2
            )
    axes.axhline(0.0, color=BEFORE, lw=0.9)
    axes.set(
        title="blocks with the largest step",
        xlabel="line of the block",
        ylabel="DN",
    )
