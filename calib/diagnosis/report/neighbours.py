"""What neighbouring columns, and successive lines, have in common: correlations."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import STRETCHES
from calib.diagnosis.report.compared import Compared
from calib.diagnosis.report.panel import AFTER, BEFORE, RECORDED, Group, Panel, on_axes
from calib.kernels.residual_products import COLUMN_LAGS, LINE_LAGS

Floats = NDArray[np.float64]


def neighbours_group(seen: Compared, weight: float) -> Group:
    """Return the correlations of columns: by distance, by signal, and along the register."""
    caption = (
        "Correlation of the noise of neighbouring columns, in percent of its variance: black as "
        "recorded, orange by the plain model, blue with what was found."
    )
    panels = (
        Panel("columns-by-lag", on_axes(lambda axes: _by_lag(seen, "columns", axes))),
        Panel("columns-by-signal", on_axes(lambda axes: _by_signal(seen, "columns_1", axes))),
        Panel("columns-along", on_axes(lambda axes: _along(seen, axes))),
    )
    return Group("columns", "Neighbouring columns", caption, panels, weight)


def lines_group(seen: Compared, weight: float) -> Group:
    """Return the correlations of successive lines of one pixel."""
    caption = "Correlation of a pixel's noise from line to line, likewise."
    panels = (
        Panel("lines-by-lag", on_axes(lambda axes: _by_lag(seen, "lines", axes))),
        Panel("lines-by-signal", on_axes(lambda axes: _by_signal(seen, "lines_1", axes))),
    )
    return Group("lines", "Successive lines", caption, panels, weight)


def _shares(seen: Compared, kind: str) -> tuple[Floats, Floats, Floats, Floats]:
    """Return a covariance over the variance, percent: recorded, plain, final, std.

    What residuals about a block's and a line's own mean covary by is taken off: the plain is 0.
    """
    recorded, plain, final, std = seen.pooled(kind)
    own = 100.0 / seen.pooled("variance")[1]
    return (recorded - plain) * own, np.zeros_like(plain), (final - plain) * own, std * own


def _mean(values: Floats, std: Floats, keep: NDArray[np.bool_]) -> tuple[float, float]:
    weight = np.where(keep & np.isfinite(std), 1.0 / np.maximum(std, 1e-12) ** 2, 0.0)
    total = max(float(weight.sum()), 1e-300)
    return float((weight * values).sum() / total), float(1.0 / np.sqrt(total))


def _by_lag(seen: Compared, of: str, axes: Axes) -> None:
    lags = range(1, (COLUMN_LAGS if of == "columns" else LINE_LAGS) + 1)
    signal = seen.group_signal_dn
    bright = signal > 0.3 * signal.max(initial=0.0)
    rows = []
    for lag in lags:
        recorded, plain, final, std = _shares(seen, f"{of}_{lag}")
        middle, error = _mean(recorded, std, bright)
        rows.append((middle, error, _mean(plain, std, bright)[0], _mean(final, std, bright)[0]))
    table = np.array(rows).T
    axes.plot(lags, table[2], "_", color=BEFORE, ms=16, mew=2)
    if seen.found:
        axes.plot(lags, table[3], "_", color=AFTER, ms=16, mew=2)
    axes.errorbar(lags, table[0], yerr=table[1], fmt="o", ms=4, color=RECORDED, capsize=2)
    name = "columns" if of == "columns" else "lines"
    axes.set(title="by distance, bright blocks", xlabel=f"{name} apart", ylabel="correlation, %")
    axes.set_xticks(list(lags))
    axes.margins(x=0.15, y=0.15)


def _by_signal(seen: Compared, kind: str, axes: Axes) -> None:
    recorded, plain, final, std = _shares(seen, kind)
    signal = seen.group_signal_dn
    every = np.ones(signal.shape[1], bool)
    rows = []
    for b in np.argsort(signal.mean(axis=1)):
        if np.isfinite(std[b]).any():
            middle, error = _mean(recorded[b], std[b], every)
            models = (_mean(m[b], std[b], every)[0] for m in (plain, final))
            rows.append((signal[b].mean(), middle, error, *models))
    table = np.array(rows).reshape(-1, 5).T
    axes.plot(table[0], table[3], color=BEFORE)
    if seen.found:
        axes.plot(table[0], table[4], color=AFTER)
    axes.errorbar(table[0], table[1], yerr=table[2], fmt="o", ms=3, color=RECORDED, elinewidth=0.7)
    axes.set(title="next neighbours, by signal", xlabel="signal, DN", ylabel="correlation, %")


def _along(seen: Compared, axes: Axes) -> None:
    recorded, plain, final, std = _shares(seen, "columns_1")
    bright = seen.group_signal_dn > 0.3 * seen.group_signal_dn.max(initial=0.0)
    stretch = seen.stretch_of_group[None, :]
    columns = seen.examined.evidence.sensor.n_columns
    x = (np.arange(STRETCHES) + 0.5) * columns / STRETCHES
    both = ((plain, BEFORE), (final, AFTER))
    for model, color in both if seen.found else both[:1]:
        level = [_mean(model, std, bright & (stretch == k))[0] for k in range(STRETCHES)]
        axes.plot(x, level, color=color)
    points = np.array([_mean(recorded, std, bright & (stretch == k)) for k in range(STRETCHES)])
    axes.errorbar(x, points[:, 0], yerr=points[:, 1], fmt="o", ms=4, color=RECORDED, capsize=2)
    axes.set(title="next neighbours, by column", xlabel="column", ylabel="correlation, %")
