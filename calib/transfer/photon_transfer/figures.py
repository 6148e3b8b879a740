"""Figures of photon transfer: the curve with its models, and covariances of neighbours."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from calib.arrays import Columns
from calib.kernels.difference_sums import Lag
from calib.report.style import BLUE, CYCLE, GREEN, GREY, ORANGE, new_figure
from calib.transfer.photon_transfer.curve_fit import CurveFit, Model
from calib.transfer.photon_transfer.tap_transfer import TapTransfer

_COLOURS = {
    Model.STRAIGHT: GREY,
    Model.QUADRATIC: GREEN,
    Model.NONLINEAR: ORANGE,
    Model.BRIGHTER_FATTER: GREEN,
    Model.NONLINEAR_AND_BRIGHTER_FATTER: CYCLE[3],
}
_WORDS = {
    Model.STRAIGHT: "straight line",
    Model.QUADRATIC: "quadratic",
    Model.NONLINEAR: "bent response",
    Model.BRIGHTER_FATTER: "brighter-fatter",
    Model.NONLINEAR_AND_BRIGHTER_FATTER: "both",
}


def transfer_curve(tap: TapTransfer, title: str = "Photon transfer") -> Figure:
    """Draw variance, variance by signal and residuals of one tap against the signal."""
    figure = new_figure(7.2, 7.6)
    above, middle, below = figure.subplots(3, 1, sharex=True, height_ratios=(3, 2, 2))
    signal = tap.points.signal_dn
    _scatter(above, signal, tap.points.variance_dn2, tap)
    grid = np.linspace(0.0, float(np.nanmax(signal[tap.used.use])) * 1.02, 300)
    for fit in _drawn(tap):
        colour = _COLOURS[fit.model]
        above.plot(grid, fit.shape.variance(grid), color=colour, label=_told(fit))
    above.set(title=title, ylabel="temporal variance, DN²", ylim=(0.0, None))
    above.legend(loc="upper left")
    _by_signal(middle, tap, grid)
    _residuals(below, tap)
    below.set(xlabel="signal above the dark level, DN")
    return figure


def _drawn(tap: TapTransfer) -> Iterator[CurveFit]:
    """Yield the straight line and the other models that tell something."""
    order = (Model.STRAIGHT, Model.QUADRATIC, Model.NONLINEAR, Model.BRIGHTER_FATTER)
    for model in order:
        if model in tap.choice.fits and not (
            model in (Model.NONLINEAR, Model.BRIGHTER_FATTER)
            and Model.QUADRATIC in tap.choice.fits
            and tap.choice.used is not model
        ):
            yield tap.choice.fits[model]


def _told(fit: CurveFit) -> str:
    gain, std = fit.shape.system_gain, fit.std("system_gain")
    digits = max(4, 1 - math.floor(math.log10(std))) if 0 < std < math.inf else 4
    return f"{_WORDS[fit.model]}: K = {gain:.{digits}f} ± {std:.{digits}f} DN/e⁻"


def _scatter(axes: Axes, signal: Columns, value: Columns, tap: TapTransfer) -> None:
    use = tap.used.use
    axes.plot(signal[~use], value[~use], "x", color=GREY, ms=4, label="not used")
    axes.plot(signal[use], value[use], ".", color=BLUE, ms=4)


def _by_signal(axes: Axes, tap: TapTransfer, grid: Columns) -> None:
    """Draw (variance − read noise)/signal, which a straight line would leave level."""
    points = tap.points.where(tap.used.use & ~tap.points.is_dark)
    expected = tap.shape.variance(points.signal_dn)
    rounding = expected - tap.shape.variance_before_rounding(points.signal_dn)
    floor = tap.shape.read_variance_dn2 + rounding
    ratio = (points.variance_dn2 - floor) / points.signal_dn
    error = np.sqrt(points.square_factor) * expected / points.signal_dn
    axes.errorbar(points.signal_dn, ratio, error, fmt=".", color=BLUE, ms=4, elinewidth=0.8)
    inner = grid[grid > 0.02 * grid.max()]
    for fit in _drawn(tap):
        level = fit.shape.variance_before_rounding(inner) - fit.shape.read_variance_dn2
        axes.plot(inner, level / inner, color=_COLOURS[fit.model])
    low, high = np.quantile(ratio, [0.02, 0.98])
    room = 0.35 * (high - low) + 2.0 * float(np.median(error))
    axes.set(ylabel="(variance − floor) / signal, DN", ylim=(low - room, high + room))


def _residuals(axes: Axes, tap: TapTransfer) -> None:
    points = tap.points.where(tap.used.use)
    fit = tap.choice.fit
    axes.errorbar(
        points.signal_dn,
        100.0 * fit.residual,
        100.0 * fit.sigma,
        fmt=".",
        color=_COLOURS[fit.model],
        ms=4,
        elinewidth=0.8,
    )
    axes.axhline(0.0, color=GREY, lw=0.8)
    axes.set(ylabel=f"residual, %\n({_WORDS[fit.model]})")


def covariances(taps: Sequence[TapTransfer], title: str = "Covariance of neighbours") -> Figure:
    """Draw each tap's covariances over variance at the nearest lags, against the signal."""
    lags = [lag for lag in taps[0].points.lags if max(lag) == 1] or list(taps[0].points.lags)
    figure = new_figure(7.2, 0.6 + 2.1 * len(lags))
    for axes, lag in zip(
        figure.subplots(len(lags), 1, sharex=True, squeeze=False)[:, 0], lags, strict=True
    ):
        for tap in taps:
            _covariance(axes, tap, tap.points.lags.index(lag))
        axes.axhline(0.0, color=GREY, lw=0.8)
        axes.set(ylabel=f"covariance / variance\n{_between(lag)}")
        if lag == lags[0]:
            axes.set(title=title)
            axes.legend(loc="upper left", ncols=2)
    axes.set(xlabel="signal above the dark level, DN")
    return figure


def _between(lag: Lag) -> str:
    words = {(0, 1): "next column", (1, 0): "next row", (1, 1): "diagonal"}
    return words.get(lag, f"{lag[0]} rows, {lag[1]} columns off")


def _covariance(axes: Axes, tap: TapTransfer, k: int) -> None:
    points = tap.points.where(tap.used.use & ~tap.points.is_dark)
    expected = tap.shape.variance(points.signal_dn)
    share = points.covariance_dn2[k] / expected
    colour = CYCLE[tap.tap % len(CYCLE)]
    axes.errorbar(
        points.signal_dn,
        share,
        np.sqrt(points.covariance_factor[k]),
        fmt=".",
        color=colour,
        ms=4,
        elinewidth=0.6,
        alpha=0.6,
        label=f"tap {tap.tap}",
    )
    found = next((n for n in tap.neighbours if n.lag == points.lags[k]), None)
    if found is not None:
        grid = np.linspace(0.0, float(points.signal_dn.max()), 50)
        grown = found.growth_per_e * grid**2 / tap.shape.variance(grid)
        axes.plot(grid, grown, color=colour, lw=0.9)
