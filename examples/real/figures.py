"""Figures of real recordings."""

from pathlib import Path

import h5py
import numpy as np
from matplotlib.figure import Figure

from calib.diagnosis.sums.diagnose import SumsExamination
from calib.report.style import BLUE, GREY, ORANGE, new_figure
from calib.transfer.photon_transfer.curve_fit import Model
from examples.real.numbers import dark_pair, spectrum

LAGS = range(1, 13)


def before_and_after(found: SumsExamination) -> Figure:
    """Draw what means and variances miss with the plain model and with what was found."""
    tap = found.measured.taps[0]
    figure = new_figure(7.2, 5.6)
    panels = figure.subplots(2, 1, sharex=True)
    for model, colour, label in (
        (Model.STRAIGHT, GREY, "plain model"), (found.model, BLUE, "bent response"),
    ):  # fmt: skip
        fit = tap.choice.fits[model]
        residual, _, square = fit.data.mean_errors(fit.solution.parameters)
        panels[0].plot(
            np.sqrt(square), 100 * residual / np.sqrt(square), ".-", color=colour,
            lw=0.7, ms=4, label=label,
        )  # fmt: skip
        flat = ~fit.data.points.is_dark
        panels[1].errorbar(
            fit.data.points.signal_dn[flat], 100 * fit.residual[flat], 100 * fit.sigma[flat],
            fmt=".-", color=colour, lw=0.7, ms=4, elinewidth=0.7,
        )  # fmt: skip
    panels[0].set(title="12-bit CCD: what is missed, of which sums survive", ylabel="mean, %")
    panels[0].set_ylim(-1.5, 1.5)
    panels[0].legend(loc="lower right")
    panels[1].set(ylabel="variance, %\n(bars: by its samples)", xlabel="signal, DN")
    return figure


def shared_noise(files: Path) -> Figure:
    """Draw a tap's noise spectrum and how noise correlates along the columns."""
    noise = dark_pair(files)
    figure = new_figure(7.2, 5.6)
    above, below = figure.subplots(2, 1)
    power = spectrum(noise[0])
    step = 200
    most = power[1 : 1 + (len(power) - 1) // step * step].reshape(-1, step).max(axis=1)
    above.semilogy(0.5 * (np.arange(len(most)) + 0.5) / len(most), most, color=BLUE, lw=0.8)
    above.axhline(np.median(power) / np.log(2), color=GREY, label="white level, of single bins")
    above.set(
        title="Dark noise of a CCD of four taps: tones that all taps share",
        xlabel="cycles a pixel, along the read-out of tap 0",
        ylabel="power, DN²\n(highest of 200 bins)",
    )
    above.legend(loc="upper left")
    for k, each in enumerate(noise):
        own = each - each.mean(axis=1, keepdims=True)
        by_lag = [float((own[:, :-j] * own[:, j:]).mean() / own.var()) for j in LAGS]
        below.plot(LAGS, by_lag, ".-", lw=0.8, label=f"tap {k}")
    below.axhline(0.0, color=GREY, lw=0.8)
    below.set(xlabel="lag, columns", ylabel="correlation of dark noise", ylim=(-0.4, 0.3))
    below.legend(loc="upper right", ncols=4)
    return figure


def step_and_neighbours(tooth: Path) -> Figure:
    """Draw the darks' means by frame, and how flats' and darks' noise correlates."""
    with h5py.File(tooth) as file:
        stacks = {n: file["exchange"][k][:] for n, k in (("flats", "data_white"),
                                                         ("darks", "data_dark"))}  # fmt: skip
    figure = new_figure(7.2, 5.6)
    above, below = figure.subplots(2, 1)
    darks = stacks["darks"].astype(np.float64)
    for row in range(darks.shape[1]):
        above.plot(darks[:, row].mean(axis=1), "o-", ms=4, lw=0.8, label=f"row {row}")
    above.set(
        title="X-ray camera: a step of the darks, and noise that neighbours share",
        xlabel="dark frame", ylabel="mean, counts",
    )  # fmt: skip
    above.legend(loc="upper right")
    for (name, stack), colour in zip(stacks.items(), (BLUE, ORANGE), strict=True):
        own = stack.astype(np.float64) - stack.mean(axis=0, dtype=np.float64)
        own -= own.mean(axis=2, keepdims=True)
        by_lag = [float((own[..., :-j] * own[..., j:]).mean() / own.var()) for j in LAGS]
        rows = float((own[:, 0] * own[:, 1]).mean() / own.var())
        print(f"{name}: columns {', '.join(f'{c:+.3f}' for c in by_lag[:3])}; rows {rows:+.3f}")
        label = f"{name}; the other row {rows:+.2f}"
        below.plot(LAGS, by_lag, ".-", color=colour, lw=0.8, label=label)
    below.axhline(0.0, color=GREY, lw=0.8)
    below.set(xlabel="lag, columns", ylabel="correlation of noise")
    below.legend(loc="upper right")
    return figure
