"""What noise-free lines say of means, of first lines, and of scatter within a block."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.sampled_lines import SampledLines
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.gather import CUT_SIGMA
from calib.diagnosis.statistics.peak import Peak
from calib.diagnosis.statistics.pooled import ONSET_LINES, places, pooled
from calib.diagnosis.statistics.rare import FAR_SIGMA, OFTEN, RARE, rare_trials
from calib.kernels.residual_products import LINE_LAGS, ResidualProducts, tap_sizes
from calib.kernels.scatter_products import scatter_products

Floats = NDArray[np.float64]

STEADY = 1e-3
"""Lines that differ by less than this part of the noise are alike."""
TOGETHER = 1 << 18
"""Blocks are looked at together up to so many samples: more leave the caches."""


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
    where, sigma = places(sensor), np.sqrt(variance)
    moved = np.zeros((len(sampled), max(s.stop for s in where.values())))
    rare = np.zeros((len(sampled), len(RARE)))
    some = [b for b, each in enumerate(sampled) if not _is_steady(each, sigma[b])]
    for which in _alike(some, sampled):
        n = len(sampled[which[0]].between)
        products, counted = _products([sampled[b] for b in which], sigma[which], sensor)
        moved[which] = pooled(products, n, variance[which], sensor, counts).vector()
        rare[which] = counted / rare_trials(n, sensor.n_pixels)
    moved[some, where["kurtosis"]] -= 1.0  # of no noise at all
    return moved, rare


def _alike(blocks: Sequence[int], sampled: Sequence[SampledLines]) -> list[list[int]]:
    """Return the blocks by how many lines they have, and not too many together."""
    found: dict[tuple[int, ...], list[list[int]]] = {}
    for b in blocks:
        groups = found.setdefault(sampled[b].between.shape, [[]])
        if (len(groups[-1]) + 1) * sampled[b].change.size > TOGETHER and groups[-1]:
            groups.append([])
        groups[-1].append(b)
    return [group for groups in found.values() for group in groups]


def _is_steady(each: SampledLines, sigma: Floats) -> bool:
    return bool(np.ptp(each.change, axis=0).max() < STEADY * sigma.min())


def _products(
    blocks: Sequence[SampledLines], sigma: Floats, sensor: Sensor
) -> tuple[ResidualProducts, Floats]:
    """Return sums of products over all lines of blocks that have as many lines as each other.

    Args:
        blocks: Lines of each.
        sigma: Noise of each pixel, DN, (n_blocks, n_rows, n_columns).
        sensor: The sensor.

    Returns:
        The sums, with a first axis of blocks, and what is counted, (n_blocks, n_rare).
    """
    between, weights = blocks[0].between, blocks[0].weights
    n, shape, noise = len(between), (sensor.n_rows, sensor.n_columns), sigma[:, None]
    r = np.stack([(x.change - x.weights @ x.change).reshape(-1, *shape) for x in blocks])
    means = np.zeros((*r.shape[:2], sensor.n_rows, sensor.n_taps))
    for tap in range(sensor.n_taps):
        of_tap = sensor.tap == tap
        size = np.maximum(tap_sizes(sensor.tap, sensor.n_taps)[:, tap], 1.0)
        means[..., tap] = np.where(of_tap, r, 0.0).sum(axis=-1) / size
    r = r - np.take_along_axis(means, np.broadcast_to(sensor.tap, r.shape), axis=3)
    out = np.abs(r) > CUT_SIGMA * noise + 1.0
    far = np.where(out, r, 0.0) / noise
    rare = np.stack([_counted(each, weights * n) for each in far])
    gram = np.stack([between[: n - k].T @ between[k:] for k in range(LINE_LAGS + 1)])
    squares, fourths, columns, lines, rows, partners = scatter_products(
        np.where(out, 0.0, r), gram, weights * n, sensor.partner
    )
    found = ResidualProducts(
        np.zeros_like(sigma), squares, 6.0 * sigma**2 * squares + fourths, columns, rows, lines,
        partners, np.tensordot(means, between, (1, 1)).transpose(0, 3, 1, 2),
        np.zeros(sigma.shape, np.int64),
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
