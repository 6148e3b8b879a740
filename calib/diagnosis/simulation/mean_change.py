"""What noise-free lines say of means, of first lines, and of scatter within a block."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.sampled_lines import SampledLines
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.gather import CUT_SIGMA
from calib.diagnosis.statistics.pooled import ONSET_LINES, places, pooled
from calib.diagnosis.statistics.rare import FAR_SIGMA, OFTEN, RARE, rare_trials
from calib.diagnosis.statistics.tones import Peak
from calib.kernels.residual_products import LINE_LAGS, ResidualProducts, tap_sizes
from calib.kernels.scatter_products import scatter_products

Floats = NDArray[np.float64]

STEADY = 1e-3
"""Lines that differ by less than this part of the noise are alike."""


def mean_change(sampled: Sequence[SampledLines]) -> tuple[Floats, Floats]:
    """Return the change of means, (n_blocks, n_pixels), and of first lines', (n_blocks, 3)."""
    onset = np.zeros((len(sampled), ONSET_LINES))
    for b, each in enumerate(sampled):
        onset[b, : len(each.first)] = each.first @ each.change.mean(axis=1)
    return np.stack([each.weights @ each.change for each in sampled]), onset


def peak_change(sampled: Sequence[SampledLines], variance: Floats, peaks: Sequence[Peak]) -> Floats:
    """Return squared amplitudes that slow changes have at the peaks, DN^2, (n_blocks, n_peaks).

    A block that begins otherwise than it ends has power at all low frequencies.
    """
    found = np.zeros((len(sampled), len(peaks)))
    for b, each in enumerate(sampled):
        if _is_steady(each, np.sqrt(variance[b])):
            continue
        moved = each.change - each.weights @ each.change
        found[b] = [peak.squared_amplitude(moved, each.between) for peak in peaks]
    return found


def scatter_change(
    sampled: Sequence[SampledLines], variance: Floats, sensor: Sensor, counts: Counts
) -> tuple[Floats, Floats]:
    """Return what lines that differ add to pooled statistics and to rates of what is counted.

    Noise and what changes from line to line without chance add up in second moments; in fourth
    ones, 6 v r^2 + r^4 is added for a residual r beside noise of variance v.

    Args:
        sampled: Lines of each block.
        variance: Noise of each pixel, DN^2, (n_blocks, n_rows, n_columns).
        sensor: The sensor.
        counts: Its counts.

    Returns:
        (n_blocks, n_pooled) and (n_blocks, n_rare).
    """
    where = places(sensor)
    moved = np.zeros((len(sampled), max(s.stop for s in where.values())))
    rare = np.zeros((len(sampled), len(RARE)))
    for b, each in enumerate(sampled):
        sigma = np.sqrt(variance[b])
        if _is_steady(each, sigma):
            continue
        n = len(each.between)
        products, rare[b] = _products(each, sigma, sensor)
        moved[b] = pooled(products, n, variance[b], sensor, counts).vector()
        moved[b, where["kurtosis"]] -= 1.0  # of no noise at all
        rare[b] /= rare_trials(n, sensor.n_pixels)
    return moved, rare


def _is_steady(each: SampledLines, sigma: Floats) -> bool:
    return bool(np.ptp(each.change, axis=0).max() < STEADY * sigma.min())


def _products(each: SampledLines, sigma: Floats, sensor: Sensor) -> tuple[ResidualProducts, Floats]:
    """Return sums of products over all lines of a block, and what is counted, (n_rare,)."""
    n, shape = len(each.between), (sensor.n_rows, sensor.n_columns)
    r = (each.change - each.weights @ each.change).reshape(-1, *shape)
    means = np.zeros((len(r), sensor.n_rows, sensor.n_taps))
    for tap in range(sensor.n_taps):
        of_tap = sensor.tap == tap
        size = np.maximum(tap_sizes(sensor.tap, sensor.n_taps)[:, tap], 1.0)
        means[..., tap] = np.where(of_tap, r, 0.0).sum(axis=-1) / size
    r = r - np.take_along_axis(means, np.broadcast_to(sensor.tap, r.shape), axis=2)
    out = np.abs(r) > CUT_SIGMA * sigma + 1.0
    rare = _counted(np.where(out, r, 0.0) / sigma, each.weights * n)
    r = np.where(out, 0.0, r)
    b = each.between
    gram = np.stack([b[: n - k].T @ b[k:] for k in range(LINE_LAGS + 1)])
    squares, fourths, columns, lines, rows, partners = scatter_products(
        r, gram, each.weights * n, sensor.partner
    )
    fourths = 6.0 * sigma**2 * squares + fourths
    found = ResidualProducts(
        np.zeros(shape), squares, fourths, columns, rows, lines, partners,
        np.tensordot(each.between, means, 1), np.zeros(shape, np.int64),
    )  # fmt: skip
    return found, rare


def _counted(far: Floats, lines: Floats) -> Floats:
    """Return how often each of `RARE` happens, (n_rare,); what differs in single lines is no track.

    Args:
        far: Samples beyond the cut, standard deviations, else 0, (k, n_rows, n_columns).
        lines: For how many lines each stands, (k,).
    """
    found = np.zeros(len(RARE))
    if not far.any():
        return found
    often = np.tensordot(lines, far != 0.0, 1) >= OFTEN
    single = np.where(often, 0.0, far)
    above, below = (np.tensordot(lines, each, 1).sum() for each in
                    (single > FAR_SIGMA, single < -FAR_SIGMA))  # fmt: skip
    for name, count in (("above", above), ("below", below), ("noisy_pixels", often.sum())):
        found[RARE.index(name)] = count
    return found
