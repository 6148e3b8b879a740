"""The standard's spatial figures: spectrograms, profiles, defect histograms."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from calib.report.style import BLUE, GREY, INK, ORANGE, new_figure
from calib.transfer.emva1288.defects import Histogram
from calib.transfer.emva1288.sheet import DataSheet
from calib.transfer.emva1288.spatial_curves import ImageCurves, Profile, Spectrogram

NAMES = {"DN": "DSNU", "%": "PRNU"}


def spectrograms(image: ImageCurves) -> Figure:
    """Draw the square root of the power along rows and, of an area sensor, along columns."""
    found = [("horizontal", image.across)]
    if image.down is not None:
        found.append(("vertical", image.down))
    figure = new_figure(height_in=3.2)
    panels = np.atleast_1d(figure.subplots(1, len(found), sharey=True))
    for axes, (name, spectrogram) in zip(panels, found, strict=True):
        _spectrogram(axes, spectrogram)
        axes.set(title=f"{NAMES[image.unit]}, {name}", xlabel="cycles per pixel")
    panels[0].set_ylabel(f"√power, {image.unit}")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _spectrogram(axes: Axes, found: Spectrogram) -> None:
    inner = slice(1, None)  # the mean is taken off: nothing is at zero
    axes.plot(found.per_pixel[inner], np.sqrt(found.power[inner]), color=BLUE, lw=0.8)
    level = np.sqrt(np.mean(found.power[inner]))
    axes.axhline(level, color=ORANGE, lw=0.9, ls="--", label="standard deviation")
    axes.axhline(np.sqrt(found.white), color=GREY, lw=0.9, label="temporal noise left in it")
    axes.set(yscale="log", xlim=(0.0, 0.5))
    axes.yaxis.set_major_formatter(FuncFormatter(_plain))
    axes.yaxis.set_minor_formatter(FuncFormatter(_plain))


def _plain(value: float, _: int) -> str:
    """Return 1, 2 and 5 of each decade as numbers, and leave the others out."""
    return f"{value:g}" if f"{value:.0e}"[0] in "125" else ""


def profiles(image: ImageCurves) -> Figure:
    """Draw mean, extremes and the middle line along rows and, of an area sensor, columns."""
    found = [("horizontal", "column", image.horizontal)]
    if image.vertical is not None:
        found.append(("vertical", "row", image.vertical))
    figure = new_figure(height_in=2.4 * len(found) + 0.4)
    panels = np.atleast_1d(figure.subplots(len(found), 1, sharey=True))
    for axes, (name, along, profile) in zip(panels, found, strict=True):
        _profile(axes, profile)
        axes.set(title=f"{NAMES[image.unit]}, {name} profile", xlabel=along, ylabel=image.unit)
    if image.vertical is not None:
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper")
    return figure


def _profile(axes: Axes, found: Profile) -> None:
    at = np.arange(len(found.mean))
    if not np.array_equal(found.least, found.largest):
        axes.fill_between(at, found.least, found.largest, color="#dde6f0", lw=0,
                          label="least … largest")  # fmt: skip
        axes.plot(at, found.middle, color=GREY, lw=0.7, label="middle line")
    axes.plot(at, found.mean, color=BLUE, lw=1.0, label="mean")
    low, high = np.percentile(found.least, 0.5), np.percentile(found.largest, 99.5)
    room = 0.15 * (high - low) or 1.0
    axes.set(xlim=(0, max(1, len(at) - 1)), ylim=(low - room, high + room))


def defects(sheet: DataSheet) -> Figure | None:
    """Draw both images' logarithmic histograms, and how many pixels lie beyond a distance."""
    if sheet.spatial is None:
        return None
    figure = new_figure(height_in=5.2)
    panels = figure.subplots(2, 2)
    for row, image in zip(panels, (sheet.spatial.dark, sheet.spatial.flat), strict=True):
        _histogram(row[0], image.histogram)
        row[0].set(title=f"{NAMES[image.unit]} histogram, block {image.block}", ylabel="pixels",
                   xlabel=f"deviation from the mean, {image.unit}")  # fmt: skip
        row[1].plot(image.histogram.distance, 100.0 * image.histogram.share_beyond, color=BLUE)
        row[1].set(title="accumulated", yscale="log", ylabel="share of the pixels, %",
                   xlabel=f"absolute deviation, {image.unit}", xlim=(0.0, None))  # fmt: skip
    return figure


def _histogram(axes: Axes, found: Histogram) -> None:
    width = float(np.median(np.diff(found.deviation))) if len(found.deviation) > 1 else 1.0
    edges = np.append(found.deviation - width / 2, found.deviation[-1] + width / 2)
    axes.stairs(np.maximum(found.count, 0.1), edges, color=BLUE, baseline=0.1, fill=True)
    pixels = float(found.count.sum())
    spread = float(np.sqrt(np.sum(found.count * found.deviation**2) / pixels)) or width
    span = np.linspace(edges[0], edges[-1], 300)
    normal = pixels * width / (spread * np.sqrt(2 * np.pi)) * np.exp(-0.5 * (span / spread) ** 2)
    axes.plot(span, normal, color=INK, lw=0.8, ls="--")
    axes.set(yscale="log", ylim=(0.5, 2.0 * float(found.count.max())))
