"""Means: what of each block's mean the model misses, against what it might follow, and a map."""

from collections.abc import Iterator
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import FigureBase
from numpy.typing import NDArray

from calib.diagnosis.report.compared import Compared
from calib.diagnosis.report.panel import AFTER, BEFORE, QUIET, Group, Panel, on_axes

Floats = NDArray[np.float64]

MOST_BINS = 64
SPAN_SIGMA = 5.0
_LABELS = {
    "signal": "signal, DN",
    "exposure": "exposure, µs",
    "level": "level",
    "time": "wall time, s",
    "temperature": "temperature of the sensor, °C",
}
_OF = {"code": "signal", "previous_block": "time", "tap": "time"}
"""Beside what else a variable is looked at."""
TELLING = ("signal", "time")
"""Where no finding says what it follows."""


def means_groups(seen: Compared, follows: tuple[str, ...], weight: float) -> tuple[Group, Group]:
    """Return the panels of the variables that findings follow, and those of all others."""
    told = {_OF.get(name, name) for name in follows} & set(_LABELS) or set(TELLING)
    caption = (
        "What a block's mean differs by from the model, ± its standard error: orange from the "
        "plain model, blue with what was found. Offsets and slopes of the pixels are fitted anew."
    )
    along = tuple(_along(seen, [n for n in _LABELS if n in told]))
    first = (*along[:1], *_maps(seen), *along[1:], _columns(seen))
    others = tuple(_along(seen, [n for n in _LABELS if n not in told]))
    return (
        Group("means", "Means of blocks", caption, first, weight),
        Group("means-others", "Means against other variables", "Likewise.", others, 0.0),
    )


def _along(seen: Compared, names: list[str]) -> Iterator[Panel]:
    table = seen.examined.evidence.table
    values = {
        "signal": seen.examined.evidence.signal_dn,
        "exposure": table.exposure_us,
        "level": table.level,
        "time": table.mid_s,
        "temperature": table.temperature_c,
    }
    for name in names:
        x = np.asarray(values[name], np.float64)
        if np.ptp(x) > 1e-3 * max(float(np.abs(x).max()), 1e-9):
            yield Panel(f"means-{name}", on_axes(partial(_against, seen, name, x)))


def _against(seen: Compared, name: str, x: Floats, axes: Axes) -> None:
    std = seen.block_std
    step = 0.006 * float(np.ptp(x))
    both = ((seen.whitened_before, BEFORE, -step, 3.5), (seen.whitened_after, AFTER, step, 3.0))
    for whitened, color, shift, size in both if seen.found else both[:1]:
        axes.errorbar(
            x + shift, seen.block_means(whitened), yerr=std, fmt="o", ms=size, color=color,
            elinewidth=0.7, capsize=0, alpha=0.9,
        )  # fmt: skip
    axes.axhline(0.0, color=QUIET, lw=0.8)
    axes.set(xlabel=_LABELS[name], ylabel="mean − model, DN")
    axes.set_title(f"against {_LABELS[name].split(',')[0]}")


def _columns(seen: Compared) -> Panel:
    """Draw the residual along the columns in the block that shows the most."""
    before = seen.whitened_before
    b = int(np.argmax((before**2).sum(axis=1)))
    name = seen.examined.evidence.table.names[b]

    def draw(axes: Axes) -> None:
        both = ((before, BEFORE), (seen.whitened_after, AFTER))
        for whitened, color in both if seen.found else both[:1]:
            row = by_column(seen, whitened)[b]
            pooled, edges = binned(row[None])
            axes.plot(edges, pooled[0], color=color, lw=1.1)
        axes.axhline(0.0, color=QUIET, lw=0.8)
        axes.set(xlabel="column", ylabel="standard deviations", title=f"along block {name}")

    return Panel("means-columns", on_axes(draw))


def _maps(seen: Compared) -> tuple[Panel, ...]:
    """Return maps of the residuals by block and column, before and after."""

    def panel(name: str, whitened: Floats, title: str) -> Panel:
        def draw(figure: FigureBase) -> None:
            axes = figure.subplots()
            pooled, _ = binned(by_column(seen, whitened))
            n_columns = seen.examined.evidence.sensor.n_columns
            image = axes.imshow(
                pooled, aspect="auto", cmap="RdBu_r", vmin=-SPAN_SIGMA, vmax=SPAN_SIGMA,
                extent=(0, n_columns, len(pooled) - 0.5, -0.5), interpolation="nearest",
            )  # fmt: skip
            axes.set(title=title, xlabel="column", ylabel="block, as acquired")
            axes.grid(visible=False)
            figure.colorbar(image, ax=axes, label="σ", extend="both")

        return Panel(f"means-map-{name}", draw)

    before = panel("before", seen.whitened_before, "plain model, by block and column")
    if not seen.found:
        return (before,)
    return before, panel("after", seen.whitened_after, "with what was found")


def by_column(seen: Compared, whitened: Floats) -> Floats:
    """Return residuals by block and column, rows pooled to unit spread."""
    rows = seen.examined.evidence.sensor.n_rows
    return np.asarray(
        whitened.reshape(len(whitened), rows, -1).sum(axis=1) / np.sqrt(rows), np.float64
    )


def binned(values: Floats) -> tuple[Floats, Floats]:
    """Return neighbouring columns pooled to unit spread, and where their middles are."""
    step = max(1, -(-values.shape[1] // MOST_BINS))
    usable = values.shape[1] // step * step
    pooled = values[:, :usable].reshape(len(values), -1, step).sum(axis=2) / np.sqrt(step)
    return pooled, (np.arange(usable // step) + 0.5) * step
