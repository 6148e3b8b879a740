"""The photon-transfer curve: temporal variance against signal, column by column."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.recording.block_statistics import BlockStatistics
from calib.report.style import BLUE, ORANGE, new_figure
from calib.rounding import typical_variance

CLASSES = 160


def photon_transfer(found: CoefficientSet, blocks: Sequence[BlockStatistics]) -> Figure:
    """Draw the variance averaged over columns of like signal, and the line of gain and noise."""
    figure = new_figure(height_in=3.6)
    axes = figure.subplots()
    signal, variance = _samples(found, blocks)
    if len(signal):
        means, pooled = _by_signal(signal, variance)
        axes.plot(means, pooled, ".", color=BLUE, ms=4, label="variance, pooled by signal")
    gain, read = found.system_gain_dn_per_e, found.read_noise_e
    if np.isfinite(gain) and len(signal):
        span = np.linspace(0.0, float(np.max(signal)), 200)
        before_rounding = gain * span + (gain * read) ** 2
        axes.plot(
            span,
            typical_variance(np.sqrt(before_rounding)),
            color=ORANGE,
            label=f"K = {gain:.4g} DN/e⁻, read noise {read:.3g} e⁻",
        )
    axes.set(
        title="Photon transfer",
        xlabel="mean DN − dark level",
        ylabel="temporal variance, DN²",
        ylim=(0.0, None),
    )
    axes.legend(loc="upper left")
    return figure


def _samples(
    found: CoefficientSet, blocks: Sequence[BlockStatistics]
) -> tuple[np.ndarray, np.ndarray]:
    """Return signal and variance of the samples that do not clip."""
    signal, variance = [], []
    for block in blocks:
        use = found.valid & (block.n_at_full_scale == 0) & (block.n_at_zero == 0)
        use &= np.isfinite(block.variance_dn2)
        signal.append((block.mean_dn - found.dark_level_dn(block.block.exposure_us))[use])
        variance.append(block.variance_dn2[use])
    return np.concatenate(signal), np.concatenate(variance)


def _by_signal(signal: np.ndarray, variance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the means of both over classes of equal count."""
    order = np.argsort(signal)
    groups = np.array_split(order, min(CLASSES, len(order)))
    return (
        np.array([np.mean(signal[g]) for g in groups]),
        np.array([np.mean(variance[g]) for g in groups]),
    )
