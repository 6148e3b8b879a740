"""The standard's temporal figures: photon transfer, sensitivity, SNR, linearity, dark current."""

import numpy as np
from matplotlib.figure import Figure

from calib.report.style import BLUE, CYCLE, GREEN, GREY, INK, ORANGE, new_figure
from calib.transfer.emva1288.fits import LINEARITY_RANGE
from calib.transfer.emva1288.report.words import rounded
from calib.transfer.emva1288.sheet import DataSheet


def photon_transfer(sheet: DataSheet) -> Figure:
    """Draw the variance against the signal, and the line through the origin, section 6.6."""
    figure = new_figure(height_in=4.4)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2.4, 1))
    curve, gain = sheet.transfer, sheet["system_gain_dn_per_e"]
    used = curve.in_transfer
    for chosen, style, label in ((used, {"color": BLUE}, "0 … 70 % of saturation"),
                                 (~used, {"color": GREY}, "not in the fit")):  # fmt: skip
        upper.plot(curve.signal_dn[chosen], curve.variance_dn2[chosen], "o", ms=4, label=label,
                   **style)  # fmt: skip
    if gain.is_known:
        span = np.array([0.0, np.max(curve.signal_dn)])
        label = f"K = {rounded(gain)} DN/e⁻"
        upper.plot(span, gain.value * span, color=ORANGE, label=label)
        left = curve.variance_dn2 - gain.value * curve.signal_dn
        line = np.maximum(gain.value * curve.signal_dn, 1e-12)
        lower.errorbar(curve.signal_dn[used], 100 * (left / line)[used],
                       yerr=100 * (curve.variance_std / line)[used], fmt="o", ms=3, lw=0.8,
                       capsize=2, color=BLUE)  # fmt: skip
    lower.axhline(0.0, color=INK, lw=0.8)
    upper.set(title="Photon transfer", ylabel="σ²_y − σ²_y.dark, DN²", ylim=(0.0, None))
    upper.legend(loc="upper left")
    lower.set(xlabel="µ_y − µ_y.dark, DN", ylabel="residual ± σ, %", xlim=(0.0, None))
    return figure


def sensitivity(sheet: DataSheet) -> Figure:
    """Draw the signal against the light, and the line through the origin, section 6.6."""
    figure = new_figure()
    axes = figure.subplots()
    curve = sheet.transfer
    light, label, slope = _abscissa(sheet)
    used = curve.in_transfer
    axes.plot(light[used], curve.signal_dn[used], "o", color=BLUE, ms=4,
              label="0 … 70 % of saturation")  # fmt: skip
    axes.plot(light[~used], curve.signal_dn[~used], "o", color=GREY, ms=4, label="not in the fit")
    span = np.array([0.0, float(np.max(light))])
    axes.plot(span, slope * span, color=ORANGE, label=f"slope {slope:.4g}, through the origin")
    point = sheet["saturation_dn"]
    if point.is_known:
        dark = float(sheet.darks.mean_dn[0])
        axes.axhline(point.value - dark, color=INK, lw=0.8, ls="--", label="saturation")
    top = 1.08 * float(np.max(curve.signal_dn))
    axes.set(title="Sensitivity", xlabel=label, ylabel="µ_y − µ_y.dark, DN", ylim=(0.0, top),
             xlim=(0.0, None))  # fmt: skip
    axes.legend(loc="lower right")
    return figure


def signal_to_noise(sheet: DataSheet) -> Figure:
    """Draw SNR and total SNR with what the model and an ideal sensor make of it, Eqs. 21-23, 69."""
    figure = new_figure(height_in=4.2)
    axes = figure.subplots()
    curve, gain = sheet.transfer, sheet["system_gain_dn_per_e"].value
    efficiency, unit = sheet["quantum_efficiency"].value, "photons"
    if not sheet["quantum_efficiency"].is_known:
        efficiency, unit = 1.0, "e"
    sound = ~(curve.share_at_full_scale > 0.002) & (curve.signal_dn > 0)
    seen = curve.signal_dn[sound] / gain / efficiency
    axes.plot(seen, curve.signal_dn[sound] / curve.noise_dn[sound], "o", ms=4, color=BLUE,
              label="measured")  # fmt: skip
    span = np.logspace(0.0, np.log10(2.0 * float(np.max(seen))), 200)
    electrons = efficiency * span
    temporal = (sheet["temporal_dark_noise_dn"].value / gain) ** 2 + electrons
    axes.plot(span, electrons / np.sqrt(temporal), color=BLUE, lw=1.0, label="linear model")
    dsnu, prnu = sheet["dsnu_e"], sheet["prnu_percent"]
    if dsnu.is_known or prnu.is_known:
        fixed = np.nan_to_num(dsnu.value) ** 2
        fixed += (np.nan_to_num(prnu.value) / 100 * electrons) ** 2
        axes.plot(span, electrons / np.sqrt(temporal + fixed), color=ORANGE,
                  label="total, with DSNU and PRNU")  # fmt: skip
    ideal = "shot noise alone" if unit == "e" else "ideal sensor"
    axes.plot(span, np.sqrt(span), color=GREY, ls="--", lw=1.0, label=ideal)
    for name, text in (
        ("sensitivity_threshold", "threshold"),
        ("saturation_capacity", "saturation"),
    ):
        at = sheet[f"{name}_{unit}"]
        if at.is_known:
            axes.axvline(at.value, color=INK, lw=0.8, ls=":")
            axes.annotate(f" {text}", (at.value, 0.13), rotation=90, va="bottom", ha="right",
                          fontsize=8)  # fmt: skip
    axes.set(xscale="log", yscale="log", ylim=(0.1, None), title="Signal-to-noise ratio",
             xlabel="photons per pixel" if unit == "photons" else "signal, e⁻",
             ylabel="SNR")  # fmt: skip
    axes.legend(loc="lower center")
    return figure


def linearity(sheet: DataSheet) -> Figure | None:
    """Draw the response and its deviation from the relative line, section 6.9."""
    curve, error = sheet.transfer, sheet["linearity_error_percent"]
    if not error.is_known:
        return None
    figure = new_figure(height_in=4.4)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1.6, 1))
    light, label, _ = _abscissa(sheet)
    offset, slope = curve.line
    used = np.isfinite(curve.deviation_percent)
    upper.plot(light[used], curve.signal_dn[used], "o", color=BLUE, ms=4)
    upper.plot(light[~used], curve.signal_dn[~used], "o", color=GREY, ms=4)
    upper.plot(light, offset + slope * curve.light, color=ORANGE, lw=1.0)
    lower.errorbar(light[used], curve.deviation_percent[used], yerr=curve.deviation_std[used],
                   fmt="o-", color=BLUE, ms=3, lw=0.8, capsize=2)  # fmt: skip
    lower.axhline(0.0, color=INK, lw=0.8)
    share = "{:.0f} … {:.0f} %".format(*(100 * each for each in LINEARITY_RANGE))
    upper.set(title=f"Linearity: LE = {error.value:.3g} % over {share} of saturation",
              ylabel="µ_y − µ_y.dark, DN",
              ylim=(0.0, 1.08 * float(np.max(curve.signal_dn))))  # fmt: skip
    lower.set(xlabel=label, ylabel="deviation ± σ, %", xlim=(0.0, None))
    return figure


def dark_current(sheet: DataSheet) -> Figure | None:
    """Draw the darks' means and variances against the exposure, section 7."""
    darks = sheet.darks
    if len(np.unique(darks.exposure_us)) < 2:
        return None
    figure = new_figure()
    left, right = figure.subplots(1, 2)
    t_ms = darks.exposure_us * 1e-3
    known = np.where(np.isfinite(darks.temperature_c), np.rint(darks.temperature_c), 1e9)
    for index, at in enumerate(np.unique(known)):
        here = known == at
        color, label = CYCLE[index % len(CYCLE)], f"{at:.0f} °C" if at < 1e9 else None
        for axes, value, std in ((left, darks.mean_dn, darks.mean_std),
                                 (right, darks.variance_dn2, darks.variance_std)):  # fmt: skip
            axes.errorbar(t_ms[here], value[here], yerr=std[here], fmt="o", ms=4, lw=0.8,
                          capsize=2, color=color, label=label)  # fmt: skip
            if len(np.unique(t_ms[here])) > 1:
                slope, offset = np.polyfit(t_ms[here], value[here], 1, w=1.0 / std[here])
                span = np.array([0.0, float(t_ms[here].max())])
                axes.plot(span, offset + slope * span, color=color, lw=0.9)
    left.set(title="Dark signal", xlabel="exposure, ms", ylabel="µ_y.dark, DN", xlim=(0.0, None))
    right.set(title="Dark variance", xlabel="exposure, ms", ylabel="σ²_y.dark, DN²",
              xlim=(0.0, None))  # fmt: skip
    if known.min() < 1e9:
        left.legend(loc="best")
    return figure


def doubling(sheet: DataSheet) -> Figure | None:
    """Draw the dark current against temperature, where there are several, section 7.2."""
    currents = sheet.darks.currents_e_per_s
    if len(currents) < 2:
        return None
    figure = new_figure(height_in=3.0)
    axes = figure.subplots()
    at = np.array(sorted(currents))
    value = np.array([currents[c].value for c in at])
    std = np.array([currents[c].std for c in at])
    axes.errorbar(at, value, yerr=std, fmt="o", ms=4, capsize=2, color=BLUE)
    every = sheet["dark_current_doubling_c"]
    if every.is_known:
        middle = np.exp(np.mean(np.log(value)))
        axes.plot(at, middle * 2 ** ((at - at.mean()) / every.value), color=GREEN,
                  label=f"doubles every {rounded(every)} °C")  # fmt: skip
        axes.legend(loc="upper left")
    axes.set(title="Dark current", xlabel="sensor temperature, °C", ylabel="e⁻/s", yscale="log")
    return figure


def _abscissa(sheet: DataSheet) -> tuple[np.ndarray, str, float]:
    """Return the light, what it is, and the signal's slope against it."""
    curve, slope = sheet.transfer, sheet.response_dn_per_light.value
    if curve.photons is None:
        return curve.light, "exposure × level, µs", slope
    return curve.photons, "photons per pixel", sheet["responsivity_dn_per_photon"].value
