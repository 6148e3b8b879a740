"""Noise of single pixels: variance against signal, before and after."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from calib.diagnosis.answer.amended import beside
from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.report.compared import Compared
from calib.diagnosis.report.panel import AFTER, BEFORE, QUIET, RECORDED, Group, Panel, on_axes

Floats = NDArray[np.float64]


def noise_group(seen: Compared, weight: float) -> Group:
    """Return the photon-transfer curve and what the models miss of it."""
    caption = (
        "Variance against signal (black: recorded, one point per block, tap and quarter of the "
        "columns). Orange: the plain model. Blue: with what was found. Dotted: the straight line "
        "of system gain and read noise that is underneath it."
    )
    panels = (
        Panel("photon-transfer", on_axes(lambda axes: _curve(seen, axes))),
        Panel("photon-transfer-residuals", on_axes(lambda axes: _residuals(seen, axes))),
        Panel("kurtosis", on_axes(lambda axes: _tails(seen, axes))),
    )
    return Group("noise", "Noise of single pixels", caption, panels, weight)


def _used(seen: Compared) -> tuple[Floats, ...]:
    """Return signal, recorded, plain, final and std of the variances that count, by signal."""
    recorded, plain, final, std = seen.pooled("variance")
    signal = seen.group_signal_dn
    used = np.isfinite(std)
    order = np.argsort(signal[used])
    return tuple(each[used][order] for each in (signal, recorded, plain, final, std))


def _curve(seen: Compared, axes: Axes) -> None:
    signal, recorded, _, final, _ = _used(seen)
    evidence = seen.examined.evidence
    span = np.array([0.0, float(signal.max(initial=1.0))])
    axes.plot(signal, recorded, ".", color=RECORDED, ms=3.5)
    axes.plot(span, _line(evidence.baseline, span), color=BEFORE)
    if seen.found:
        axes.plot(*_pooled(signal, final), color=AFTER)
        true = beside(seen.examined.model, evidence)
        axes.plot(span, _line(true, span), color=AFTER, ls=":", lw=1.0)
    axes.set(title="variance against signal", xlabel="signal, DN", ylabel="DN²", ylim=(0.0, None))


def _line(base: Baseline, signal: Floats) -> Floats:
    return np.asarray(base.read_variance_dn2.mean() + base.gain_dn_per_e.mean() * signal)


def _residuals(seen: Compared, axes: Axes) -> None:
    signal, recorded, plain, final, std = _used(seen)
    both = ((plain, BEFORE), (final, AFTER))
    for model, color in both if seen.found else both[:1]:
        axes.errorbar(
            signal, 100.0 * (recorded - model) / plain, yerr=100.0 * std / plain, fmt="o", ms=2.5,
            color=color, elinewidth=0.5, alpha=0.8,
        )  # fmt: skip
    axes.axhline(0.0, color=QUIET, lw=0.8)
    axes.set(title="variance − model", xlabel="signal, DN", ylabel="of the plain model's, %")


def _tails(seen: Compared, axes: Axes) -> None:
    recorded, plain, final, std = seen.pooled("kurtosis")
    used = np.isfinite(std)
    signal = seen.group_signal_dn[used]
    both = ((plain, BEFORE), (final, AFTER))
    for model, color in both if seen.found else both[:1]:
        z = ((recorded - model) / std)[used]
        axes.plot(signal, z, "o", ms=2.5, color=color, alpha=0.8)
    axes.axhline(0.0, color=QUIET, lw=0.8)
    axes.set(title="tails (kurtosis)", xlabel="signal, DN", ylabel="standard deviations")


def _pooled(signal: Floats, values: Floats, classes: int = 24) -> tuple[Floats, Floats]:
    """Return the means of both over classes of like signal, in order."""
    groups = np.array_split(np.arange(len(signal)), min(classes, max(len(signal), 1)))
    kept = [g for g in groups if len(g)]
    return np.array([signal[g].mean() for g in kept]), np.array([values[g].mean() for g in kept])
