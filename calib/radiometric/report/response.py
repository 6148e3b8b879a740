"""How the response follows exposure and radiance: linearity, and AgCam's Fig. 5."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from calib.radiometric.calibration import Calibration
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.recording.block_statistics import BlockStatistics
from calib.report.style import BLUE, CYCLE, GREY, INK, new_figure, unit_text


def linearity(calibration: Calibration, blocks: Sequence[BlockStatistics]) -> Figure:
    """Draw the mean signal against exposure by level, and what the straight line leaves."""
    found, common = calibration.coefficients, calibration.figures.dark_offset_common_std_dn
    figure = new_figure(height_in=4.4)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    flats = [s for s in blocks if s.block.kind == "flat"]
    full_scale = found.camera.full_scale_dn
    for index, level in enumerate(sorted({s.block.level for s in flats})):
        chosen = sorted(
            (s for s in flats if s.block.level == level), key=lambda s: s.block.exposure_us
        )
        exposure = np.array([s.block.exposure_us for s in chosen])
        signal = np.array([_signal(found, s) for s in chosen])
        whole = np.array([_unclipped(found, s) for s in chosen])
        color = CYCLE[index % len(CYCLE)]
        upper.plot(exposure[whole], signal[whole], "o", color=color, ms=4, label=f"level {level:g}")
        upper.plot(exposure[~whole], signal[~whole], "x", color=GREY, ms=5)
        if not whole.any():
            continue
        per_us = float(np.sum(signal[whole]) / np.sum(exposure[whole]))
        upper.plot([0.0, *exposure[whole]], [0.0, *per_us * exposure[whole]], color=color, lw=0.6)
        if whole.sum() > 1:  # a single exposure leaves no residual
            line = per_us * exposure[whole]
            std = np.array([_signal_std(found, s, common) for s in chosen])[whole]
            lower.errorbar(
                exposure[whole], 100.0 * (signal[whole] / line - 1.0), yerr=200.0 * std / line,
                fmt="o-", color=color, ms=3, lw=0.8, capsize=2,
            )  # fmt: skip
    upper.axhline(full_scale, color=INK, lw=0.8, ls="--")
    upper.set_ylim(0.0, 1.06 * full_scale)
    upper.set(
        title="Linearity (a cross: some columns clip, left out)", ylabel="mean DN − dark level"
    )
    figure.legend(loc="outside right upper")
    lower.axhline(0.0, color=INK, lw=0.8)
    lower.set(xlabel="exposure, µs", ylabel="residual ± 2σ, %", xlim=(0.0, None))
    return figure


def radiance_scale(calibration: Calibration) -> Figure:
    """Draw the certified radiance of each level against what the camera sees of it.

    Bars are two standard uncertainties: thick the camera's part, thin with the levels' own.
    """
    figure = new_figure(height_in=3.6)
    left, right = figure.subplots(1, 2)
    data, unit = calibration.figures, calibration.coefficients.radiance_unit
    left.errorbar(
        data.radiance, data.relative_level,
        yerr=2.0 * data.level_ratio_std * data.relative_level, fmt="o", color=BLUE, capsize=2,
    )  # fmt: skip
    known = np.isfinite(data.radiance) & np.isfinite(data.relative_level)
    if known.any():
        per_radiance = np.median(data.relative_level[known] / data.radiance[known])
        span = np.array([0.0, np.max(data.radiance[known])])
        left.plot(span, per_radiance * span, color=GREY, lw=0.9)
    left.set(
        title="Radiance scale",
        xlabel=f"certified radiance, {unit_text(unit)}",
        ylabel="signal relative to the reference",
    )
    percent = 100.0 * data.level_ratio
    for std, width, label in (
        (data.level_ratio_seen_std, 3.0, "seen: noise, unrest of the source"),
        (data.level_ratio_std, 0.9, "and each level's own"),
    ):
        right.errorbar(
            data.level, percent, yerr=200.0 * std, fmt="none", ecolor=BLUE, elinewidth=width,
            capsize=0 if width > 1 else 3, label=label,
        )  # fmt: skip
    right.plot(data.level, percent, "o", color=BLUE, ms=4)
    right.axhline(0.0, color=INK, lw=0.8)
    if (data.level % 1 == 0).all():
        right.xaxis.set_major_locator(MaxNLocator(integer=True))
    right.set(title="Certified over seen", xlabel="level", ylabel="difference ± 2σ, %")
    figure.legend(loc="outside lower right", ncols=2)
    return figure


def _signal(found: CoefficientSet, block: BlockStatistics) -> float:
    dark = found.dark_level_dn(block.block.exposure_us)
    return float(np.mean((block.mean_dn - dark)[found.valid]))


def _signal_std(found: CoefficientSet, block: BlockStatistics, common_dn: float) -> float:
    """Return the mean's standard uncertainty: noise, and what the columns' DN0 have in common."""
    own = np.maximum(found.dark_offset_dn_std**2 - common_dn**2, 0.0)
    total = (block.variance_dn2 / block.n_lines + own)[found.valid]
    return float(np.hypot(np.sqrt(np.sum(total)) / len(total), common_dn))


def _unclipped(found: CoefficientSet, block: BlockStatistics) -> bool:
    clipped = block.n_at_full_scale[found.valid] > 0.001 * block.n_lines
    return not bool(clipped.any())
